"""Where meshes are: in the URDF's folder and in folders that are named, once links and `..` are resolved."""

import os
from collections.abc import Sequence
from pathlib import Path
from urllib.parse import unquote

from ikde.errors import FileError, quoted, shorten

PACKAGE = ("package://", "model://")
LOCAL = "file://"
MAX_SHOWN = 50  # characters of a mesh's name, the last ones
MAX_FOLDER = 120  # characters of a folder that is advised


def find_mesh(urdf: Path, name: str, package_paths: Sequence[Path], line: int | None = None) -> Path:
    """The file that a mesh's name stands for.

    `package://NAME/rest` is `NAME/rest` in one of the folders, or in a folder that is itself called NAME, or like one
    in rest, what follows that; anything else is a path beside the file.

    Raises:
        FileError: for a mesh that is missing, no regular file, or outside all folders; for a folder that is none.
    """
    folders = [urdf.parent, *package_paths]
    for folder in package_paths:
        if not _is_folder(folder):
            raise FileError(folder, "no such folder; expected one with meshes", ("package_path",))
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


def _is_folder(path: Path) -> bool:
    """Whether there is such a folder; False, too, for what can be no name of one."""
    try:
        return path.is_dir()
    except (OSError, ValueError):
        return False


def _list_candidates(name: str, folders: Sequence[Path]) -> list[Path]:
    if parts := _split_package(name):
        within = [(folder, k) for folder in folders for k in _find_all(folder.resolve().name, parts)]
        return [*(folder.joinpath(*parts) for folder in folders), *(f.joinpath(*parts[k + 1 :]) for f, k in within)]
    if name.startswith(LOCAL):
        return [Path(unquote(name.removeprefix(LOCAL)))]
    if "://" in name:
        return []
    return [folder / name for folder in folders]


def _suggest_folder(urdf: Path, name: str) -> str:
    """The folder above the URDF in which the mesh is found, written shortly."""
    above = urdf.absolute().parents[:-1] if _split_package(name) else ()  # never all of the disk
    candidates = [(folder, _list_candidates(name, [folder])) for folder in above]
    whole = [(folder, paths[0]) for folder, paths in candidates]
    for folder, path in [*whole, *((folder, path) for folder, paths in candidates for path in paths[1:])]:
        if path.is_file() and path.resolve().is_relative_to(folder.resolve()):
            shown = min(str(folder), os.path.relpath(folder), key=len)
            return shown if len(shown) <= MAX_FOLDER else "FOLDER"
    return "FOLDER"


def _split_package(name: str) -> list[str]:
    """The package and the folders below it, and the file; nothing for other names."""
    scheme = next((scheme for scheme in PACKAGE if name.startswith(scheme)), None)
    return [] if scheme is None else [part for part in unquote(name.removeprefix(scheme)).split("/") if part]


def _find_all(folder: str, parts: list[str]) -> list[int]:
    """Where a folder's name stands before the file."""
    return [k for k, part in enumerate(parts[:-1]) if folder and part == folder]
