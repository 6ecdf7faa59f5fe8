"""`python -m proxgen` is the command `proxgen`."""

from proxgen.cli import main

raise SystemExit(main())
