"""`python -m proxgen` is the command `proxgen`."""

import sys

from proxgen.cli import main

sys.exit(main())
