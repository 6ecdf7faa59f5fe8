import subprocess
import sys
from pathlib import Path

import pytest

from proxgen.emit.layout import tidy

ROOT = Path(__file__).resolve().parents[2]

SAMPLE = """
#define {X}_JOINTS 7
#define {X}_TASK_ROWS 3
#define {X}_NAME(name) {x}_##name

/* A comment of {x} that says so much about so little that it must be wrapped, or runs off the page. */
typedef struct {{
  double q[{X}_JOINTS]; /* short */
  const double *{x}_pointer; /* as short */
}} {x}_short_t;

typedef struct {{
  double q; /* so long that there is no room for it behind the code: it goes above the code, {x} */
  double xdot[{X}_JOINTS]; /* short */
}} {x}_long_t;

/* Several lines:
 *   an item of the list that is long, longer than a line, for a robot whose name is as long as {x}
 * and the end. */
int {x}_step({x}_short_t *controller, const double q[{X}_JOINTS], const double x[3], const {x}_long_t *seen);

int {x}_broken_by_hand({x}_short_t *controller,
                       const double q[7]);
"""


@pytest.mark.parametrize("name", ["a", "iiwa7", "a_robot_with_a_long_name"])
def test_tidy_text_is_what_clang_format_wants(name: str, tmp_path: Path) -> None:
    path = tmp_path / "sample.h"
    path.write_text(tidy(SAMPLE.format(x=name, X=name.upper())))
    clang_format = Path(sys.executable).parent / "clang-format"
    style = f"--style=file:{ROOT / '.clang-format'}"
    subprocess.run([clang_format, style, "--dry-run", "-Werror", path], check=True)


def test_tidy_is_idempotent() -> None:
    once = tidy(SAMPLE.format(x="iiwa7", X="IIWA7"))
    assert tidy(once) == once


def test_declarations_are_wrapped_under_their_first_argument() -> None:
    line = "int f(" + ", ".join(f"const double argument_{i}[3]" for i in range(6)) + ");"
    wrapped = tidy(line).splitlines()
    assert len(wrapped) == 2
    assert wrapped[1].startswith("      const double argument_")
    assert " ".join(part.strip() for part in wrapped) == line


def test_macros_of_several_lines_stay_apart() -> None:
    lines = tidy("#define A \\\n  1\n#define B   \\\n  (2 + \\\n   3)\nint x;\n").splitlines()
    assert [line.rstrip(" \\") for line in lines] == [
        "/* clang-format off */",
        "#define A",
        "  1",
        "#define B",
        "  (2 +",
        "   3)",
        "/* clang-format on */",
        "int x;",
    ]
    assert [line.endswith("\\") for line in lines] == [False, True, False, True, True, False, False, False]


def test_text_that_is_switched_off_keeps_its_breaks() -> None:
    block = "/* clang-format off */\nint f(int a,\n  int b);\n" + "x" * 200 + "\n/* clang-format on */\n"
    assert tidy(block) == block
