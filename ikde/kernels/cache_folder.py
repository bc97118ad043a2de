"""The folder of compiled code, and whether it may be trusted: code is run from it, so no other user may write there.

Every folder and every symbolic link on the way to it is checked. Those above it may belong to root, and may be shared
if only owners can rename what lies in them (the sticky bit). It and all that lies in it is this user's alone.
"""

import hashlib
import os
import stat
import tempfile
import warnings
from collections.abc import Iterator
from contextlib import suppress
from pathlib import Path
from types import FunctionType

from ikde.errors import CacheWarning

MACHINE_CODE, ROBOTS = "machine_code", "robots"
MAX_LINKS = 40
HAS_OWNERS = hasattr(os, "geteuid")
USER = os.geteuid() if HAS_OWNERS else -1


def cache_folder() -> Path:
    """Folder of the compiled kernels: in `$IKDE_CACHE_DIR`, else the user's cache folder; one per kernel source."""
    root = os.environ.get("IKDE_CACHE_DIR")
    base = Path(root) if root else Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache") / "ikde"
    digest = hashlib.sha256()
    for source in sorted(Path(__file__).parent.glob("*.py")):
        digest.update(source.read_bytes())
    return base.absolute() / digest.hexdigest()[:12]


def find_usable(wanted: Path) -> tuple[Path, bool]:
    """The folder itself if it can be trusted, else one of this user's for temporary files, with one warning.

    Returns the folder, and whether it can be used: if not, every process compiles for itself.
    """
    fault = prepare(wanted)
    if fault is None:
        return wanted, True
    spare = Path(tempfile.gettempdir()).absolute() / f"ikde-{USER}" / wanted.name
    further = prepare(spare)
    instead = f"{spare.parent} is used instead" if further is None else f"{further}; every process compiles for itself"
    advice = "mend that, or name another folder by IKDE_CACHE_DIR"
    message = f"the cache folder {wanted.parent} is not used: {fault}; {advice}; {instead}"
    warnings.warn(message, CacheWarning, stacklevel=2)
    return spare, further is None


def prepare(folder: Path) -> str | None:
    """Make `folder`, all above it and its own folders, for this user alone; why it cannot be used, or None."""
    try:
        for level in _walk(folder.parent):
            if fault := _check_above(level):
                return fault
        for level in (folder.parent.resolve(), folder, folder / MACHINE_CODE, folder / ROBOTS):
            if fault := _check_own(level):
                return fault
    except OSError as error:
        return f"{error.filename} cannot be written: {error.strerror}"
    return None


def name_code(function: FunctionType) -> str:
    """What the files of a function's machine code begin with."""
    return f"{Path(function.__code__.co_filename).stem}.{function.__name__.strip('<>')}."


def is_kept(function: FunctionType) -> bool:
    """True if there is machine code of a function, for some types of arguments; what a file holds is checked later."""
    return CACHE_IS_WRITABLE and any((CACHE_FOLDER / MACHINE_CODE).glob(f"{name_code(function)}*"))


def find_fault(state: os.stat_result) -> str | None:
    """Why another user could have written to the cache, or None."""
    if HAS_OWNERS and state.st_uid != USER:
        return f"belongs to user {state.st_uid}"
    if HAS_OWNERS and state.st_mode & (stat.S_IWGRP | stat.S_IWOTH):
        return f"can be written by others (mode {stat.S_IMODE(state.st_mode):o})"
    return None


def _walk(path: Path, links: int = MAX_LINKS) -> Iterator[Path]:
    """Every folder and symbolic link that the system passes from the root to a path."""
    here = Path(path.anchor)
    yield here
    for part in path.parts[1:]:
        step = here.parent if part == ".." else here / part
        yield step
        if step.is_symlink():
            if not links:
                raise OSError(0, "too many symbolic links", str(path))
            yield from _walk(here / step.readlink(), links - 1)
        here = step.resolve()


def _check_above(level: Path) -> str | None:
    """Make a folder on the way to the cache if it is missing; why others could exchange what is in it, or None."""
    _make(level)
    state = level.lstat()
    if HAS_OWNERS and state.st_uid not in (USER, 0, Path("/").stat().st_uid):
        return f"{level} belongs to user {state.st_uid}"
    if stat.S_ISLNK(state.st_mode):
        return None
    if not stat.S_ISDIR(state.st_mode):
        return f"{level} is no folder"
    if not HAS_OWNERS or state.st_mode & stat.S_ISVTX:
        return None
    shared = state.st_mode & stat.S_IWOTH or (state.st_mode & stat.S_IWGRP and not _is_alone_in(state.st_gid))
    return f"{level} can be written by others (mode {stat.S_IMODE(state.st_mode):o})" if shared else None


def _check_own(level: Path) -> str | None:
    """Make a folder of the cache if it is missing or a file of this user's stands there; what is wrong, or None."""
    if level.is_file() and not level.is_symlink() and find_fault(level.lstat()) is None:
        level.unlink()
        warnings.warn(f"{level} is removed: it was a file, expected a folder", CacheWarning, stacklevel=2)
    _make(level)
    state = level.lstat()
    if not stat.S_ISDIR(state.st_mode):
        return f"{level} is no folder"
    fault = find_fault(state)
    if fault:
        return f"{level} {fault}"
    return None if os.access(level, os.W_OK | os.X_OK) else f"{level} cannot be written"


def _make(folder: Path) -> None:
    if not os.path.lexists(folder):
        with suppress(FileExistsError):  # another process may have been faster
            folder.mkdir(stat.S_IRWXU)


def _is_alone_in(group: int) -> bool:
    """True for a group of this user's own, as many systems give everybody one and let it write by default."""
    import grp
    import pwd

    try:
        name, entry = pwd.getpwuid(USER).pw_name, grp.getgrgid(group)
    except KeyError:
        return False
    return entry.gr_name == name and set(entry.gr_mem) <= {name}


CACHE_FOLDER, CACHE_IS_WRITABLE = find_usable(cache_folder())
