from pathlib import Path

import cffi
import pytest

from proxgen.builder.extension import declarations, write_extension
from proxgen.errors import BuildError

HEADER = """
#ifndef ROBOT_H
#define ROBOT_H
#include <stddef.h>
#define ROBOT_JOINTS 3
#ifdef __cplusplus
extern "C" {
#endif
#pragma GCC visibility push(default)
typedef enum { ROBOT_FINE = 0, ROBOT_WRONG = -1 } robot_status_t; /* a comment; with a semicolon { */
typedef struct { double q[ROBOT_JOINTS * 2]; } robot_state_t;
extern const robot_state_t robot_default;
robot_status_t robot_make(robot_state_t **state, size_t size);
robot_status_t robot_hidden(void);
static inline robot_status_t robot_create(robot_state_t **state) {
  if (!state) { return ROBOT_WRONG; }
  return robot_make(state, sizeof(robot_state_t));
}
#pragma GCC visibility pop
#ifdef __cplusplus
}
#endif
#endif
"""


@pytest.fixture
def header(tmp_path: Path) -> Path:
    (tmp_path / "robot.h").write_text(HEADER)
    (tmp_path / "system").mkdir()
    return tmp_path / "robot.h"


def test_the_header_is_the_only_description_of_the_interface(header: Path) -> None:
    text = declarations(
        header, [header.parent], ["cc"], ["robot_make", "robot_create"], header.parent / "system"
    )
    ffi = cffi.FFI()
    ffi.cdef(text)
    assert ffi.sizeof("robot_state_t") == 6 * 8
    assert "robot_status_t robot_create(robot_state_t **state);" in text
    assert "robot_hidden" not in text and "robot_default" not in text


def test_a_function_that_the_header_lacks_is_an_error(header: Path) -> None:
    with pytest.raises(BuildError, match=r"robot.h does not declare robot_fly"):
        declarations(header, [header.parent], ["cc"], ["robot_fly"], header.parent / "system")


def test_declarations_that_cffi_does_not_understand_are_an_error(tmp_path: Path) -> None:
    with pytest.raises(BuildError, match="cffi refuses the interface"):
        write_extension("_robot", "int f(struct {;", tmp_path / "glue.c")
