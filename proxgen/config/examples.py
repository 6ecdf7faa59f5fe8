"""The examples that come with proxgen: scenes that are found by name, and the robots they were made for."""

from pathlib import Path

_PACKAGE = Path(__file__).parents[1]


def examples_directory() -> Path:
    """The folder `examples/`: of the checkout, or as it is installed with the package."""
    checkout = _PACKAGE.parent / "examples"
    # An installed package lies beside others, of which one may be called examples.
    return checkout if (checkout / "scenes" / "gap.yaml").is_file() else _PACKAGE / "_examples"
