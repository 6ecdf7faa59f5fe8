"""Measures anew what README.md and docs/performance.md show, and writes it into them. `make measure` runs it.

The three benchmarks write `bench.json`, `peers.json` and `scaling.json` beside this file, and their plots
into docs/images. It takes a quarter of an hour, and wants a machine that has nothing else to do.

    python docs/measured/measure.py            # measures, and fills the pages
    python docs/measured/measure.py --fill     # fills the pages from the files that are there
"""

import json
import sys
from pathlib import Path

from proxgen.bench.markdown import fill
from proxgen.cli import main as proxgen

HERE = Path(__file__).resolve().parent
ROOT = HERE.parents[1]
PAGES = (ROOT / "README.md", ROOT / "docs" / "performance.md")
RUNS = {
    "bench": ["bench"],
    "peers": ["bench", "--peers", "--scene", "gap", "--scene", "moving", "--duration", "30"],
    "scaling": ["bench", "--scaling"],
}


def measured() -> dict[str, dict[str, object]]:
    """What the benchmarks wrote."""
    return {name: json.loads((HERE / f"{name}.json").read_text()) for name in RUNS}


def main() -> int:
    """Measure unless told otherwise, then fill the pages."""
    for name, words in RUNS.items() if "--fill" not in sys.argv[1:] else ():
        plot = ROOT / "docs" / "images" / f"{name}.png"
        if status := proxgen([*words, "--json", str(HERE / f"{name}.json"), "--plot", str(plot)]):
            return status
    for page in PAGES:
        page.write_text(fill(page.read_text(encoding="utf-8"), measured()), encoding="utf-8")
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
