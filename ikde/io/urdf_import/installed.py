"""URDFs by name, out of packages of robot descriptions that are installed."""

from importlib.metadata import PackageNotFoundError, distribution
from pathlib import Path

from ikde.errors import InputError, nearest, quoted

PACKAGES = ("example-robot-data", "rtb-data")
MESHES_WITHIN = 8  # folders above a URDF in which the packages that it names may lie


def find_installed(name: str) -> tuple[Path, tuple[Path, ...]]:
    """The URDF that is called so, and the folders that its meshes may lie in.

    Raises:
        InputError: if there is none, with the nearest name; or if no such package is installed.
    """
    found: dict[str, Path] = {}
    for package in PACKAGES:
        for path in _list_urdfs(package):
            found.setdefault(path.stem, path)
    if name in found:
        path = found[name].resolve()
        return path, tuple(path.parents[1:MESHES_WITHIN])
    if not found:
        where = f"no file is called so, and neither {' nor '.join(PACKAGES)} is installed"
        raise InputError(f"no robot {quoted(name)}: {where}")
    known = nearest(name, found) or f"; they have {', '.join(sorted(found)[:8])} and others"
    raise InputError(f"no file, and no URDF of the installed descriptions, is called {quoted(name)}{known}")


def _list_urdfs(package: str) -> list[Path]:
    try:
        files = distribution(package).files or []
    except PackageNotFoundError:
        return []
    return sorted(Path(str(file.locate())) for file in files if file.suffix == ".urdf")
