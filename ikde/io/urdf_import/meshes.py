"""Where meshes are: in the URDF's folder and in folders that are named, once links and `..` are resolved."""

import os
from collections.abc import Sequence
from pathlib import Path
from urllib.parse import unquote

from ikde.errors import FileError, quoted, shorten

PACKAGE = ("package://", "model://")
LOCAL = "file://"
MAX_SHOWN = 50  # characters of a mesh's name, the last ones


def find_mesh(urdf: Path, name: str, package_paths: Sequence[Path], line: int | None = None) -> Path:
    """The file that a mesh's name stands for.

    `package://NAME/rest` is `NAME/rest` in one of the folders, or `rest` in a folder that is itself called NAME;
    anything else is a path beside the file.

    Raises:
        FileError: for a mesh that is missing, no regular file, or outside all folders.
    """
    folders = [urdf.parent, *package_paths]
    try:
        roots = [folder.resolve(strict=True) for folder in folders]
        outside = False
        for candidate in _list_candidates(name, folders):
            path = candidate.resolve()
            if not any(path.is_relative_to(root) for root in roots):
                outside = True
            elif path.is_file():
                return path
    except (OSError, ValueError, RuntimeError) as error:
        reason = getattr(error, "strerror", None) or "no path"
        raise FileError(urdf, f"the mesh {quoted(name)} cannot be looked for: {reason}", (), line) from None
    shown = quoted(shorten(name, MAX_SHOWN, keep_end=True))
    if "://" in name and not name.startswith((*PACKAGE, LOCAL)):
        raise FileError(urdf, f"the mesh {shown} is no file on this machine, and none is fetched", (), line)
    found = "lies outside this folder" if outside and not name.startswith(PACKAGE) else "is not in this folder"
    message = f"the mesh {shown} {found}; try --package-path {_suggest_folder(urdf, name)}, or --no-spheres"
    raise FileError(urdf, message, (), line)


def _list_candidates(name: str, folders: Sequence[Path]) -> list[Path]:
    for scheme in PACKAGE:
        if name.startswith(scheme):
            package, _, rest = unquote(name.removeprefix(scheme)).partition("/")
            own = [folder / rest for folder in folders if folder.resolve().name == package]
            return [*(folder / package / rest for folder in folders), *own]
    if name.startswith(LOCAL):
        return [Path(unquote(name.removeprefix(LOCAL)))]
    if "://" in name:
        return []
    return [folder / name for folder in folders]


def _suggest_folder(urdf: Path, name: str) -> str:
    """The folder above the URDF that holds the package, going by names alone, as short as it can be written."""
    package = next((name.removeprefix(s).partition("/")[0] for s in PACKAGE if name.startswith(s)), None)
    above = urdf.absolute().parents
    holder = next((str(folder.parent) for folder in above if folder.name == package), None)
    return "FOLDER" if holder is None else min(holder, os.path.relpath(holder), key=len)
