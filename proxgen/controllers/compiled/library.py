"""Loads what `proxgen build` left: the extension, its description and its manifest."""

import json
from dataclasses import dataclass
from importlib.machinery import ExtensionFileLoader
from importlib.util import module_from_spec, spec_from_file_location
from pathlib import Path
from typing import Any

import numpy as np

from proxgen.errors import ControllerError


@dataclass(frozen=True)
class Library:
    """A robot's library in Python.

    Attributes:
        robot: name, and prefix of everything in `lib`.
        backend: QP solver behind it.
        path: file of the extension.
        manifest: `manifest.json` of the generated code.
        ffi: cffi's types and conversions.
        lib: the C functions.
    """

    robot: str
    backend: str
    path: Path
    manifest: dict[str, Any]
    ffi: Any
    lib: Any

    def function(self, name: str) -> Any:
        """The C function `<robot>_<name>`."""
        return getattr(self.lib, f"{self.robot}_{name}")

    def new(self, struct: str) -> Any:
        """A new C struct `<robot>_<struct>_t`, all zero."""
        return self.ffi.new(f"{self.robot}_{struct}_t *")

    def layout(self, struct: str) -> np.dtype[np.void]:
        """NumPy's description of a C struct of numbers: names, types and places of its fields."""
        ctype = self.ffi.typeof(f"{self.robot}_{struct}_t")
        fields = dict(ctype.fields)
        return np.dtype(
            {
                "names": list(fields),
                "formats": [_format(field.type) for field in fields.values()],
                "offsets": [field.offset for field in fields.values()],
                "itemsize": self.ffi.sizeof(ctype),
            }
        )


def load_library(directory: str | Path) -> Library:
    """Load the library in a build folder.

    Raises:
        ControllerError: there is none, or its parts are of different builds.
    """
    folder = Path(directory).absolute()
    try:
        description = json.loads((folder / "proxgen.json").read_text())
        manifest = json.loads((folder / description["manifest"]).read_text())
        path, name = folder / description["extension"], description["module"]
        loader = ExtensionFileLoader(name, str(path))
        spec = spec_from_file_location(name, path, loader=loader)
        module = module_from_spec(spec)  # type: ignore[arg-type]
        loader.exec_module(module)
    except FileNotFoundError as error:
        raise ControllerError(
            f"{folder} holds no controller; `proxgen build -o {folder}` makes one"
        ) from error
    except (OSError, ValueError, KeyError, ImportError) as error:
        raise ControllerError(f"the controller in {folder} cannot be loaded: {error}") from error
    robot, backend = description["robot"], description["backend"]
    library = Library(robot, backend, path, manifest, module.ffi, module.lib)
    _check_version(library, folder)
    return library


def _check_version(library: Library, folder: Path) -> None:
    """Refuse a library and a manifest that are not of the same build."""
    version = library.new("version")
    library.function("version")(version)
    found = library.ffi.string(version.config_hash).decode()
    if (found, version.abi) != (library.manifest["config_hash"], library.manifest["abi"]):
        raise ControllerError(
            f"library and manifest in {folder} are of different builds; run `proxgen build`"
        )


def _format(ctype: Any) -> Any:
    """NumPy's type of a C number, or of an array of them."""
    if ctype.kind == "array":
        return (_format(ctype.item), (ctype.length,))
    numbers = {"double": np.float64, "int": np.intc, "unsigned long long": np.ulonglong}
    return np.dtype(numbers[ctype.cname])
