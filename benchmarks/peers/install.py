"""Make a virtual environment with ikde and all peers in it.

    python3.11 benchmarks/peers/install.py                       # .venv-peers in this repository
    .venv-peers/bin/python benchmarks/peers/run.py
    python3.11 benchmarks/peers/install.py --only EAIK RoboPlan  # ikde and these alone

They install together. What does not install is named and left out; `run.py` leaves it out as well. PyRoki and jaxls are
not on the package index: they come from their repositories, or from `--source FOLDER` with clones called `pyroki` and
`jaxls`. The C++ loop over Pinocchio needs g++ as well.
"""

import argparse
import subprocess
import sys
import venv
from pathlib import Path

ROOT = Path(__file__).parents[2]
PEERS = (
    ("Pinocchio", ("pin", "cmeel-eigen")),
    ("Robotics Toolbox", ("roboticstoolbox-python",)),
    ("TRAC-IK", ("pytracik",)),
    ("EAIK", ("eaik",)),
    ("RoboPlan", ("roboplan",)),
    ("Drake", ("drake",)),
    ("mink", ("mink", "mujoco", "daqp")),
    ("Pink", ("pin-pink", "daqp")),
    ("ikpy", ("ikpy",)),
    ("pymoo", ("pymoo",)),
    ("pygmo", ("pygmo",)),
    ("JAX", ("jax", "jaxlie", "jax_dataclasses", "jaxtyping", "loguru", "yourdfpy", "termcolor", "tyro", "viser")),
)
SOURCES = {
    "jaxls": "git+https://github.com/brentyi/jaxls.git",
    "pyroki": "git+https://github.com/chungmin99/pyroki.git",
}


def main() -> int:
    """Install one after the other; the number that failed."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--folder", type=Path, default=ROOT / ".venv-peers")
    parser.add_argument("--source", type=Path, default=None, metavar="FOLDER", help="clones of jaxls and pyroki")
    parser.add_argument("--only", nargs="+", default=None, metavar="NAME", help="peers by name")
    options = parser.parse_args()
    venv.create(options.folder, with_pip=True)
    python = options.folder / ("Scripts" if sys.platform == "win32" else "bin") / "python"
    jobs = list(PEERS)
    for name, place in SOURCES.items():
        jobs.append((name, ("--no-deps", str(options.source / name) if options.source else place)))
    jobs = [("ikde", ("-e", str(ROOT))), *(job for job in jobs if options.only is None or job[0] in options.only)]
    failed = []
    quiet = {"capture_output": True, "text": True}
    for name, packages in jobs:
        done = subprocess.run([str(python), "-m", "pip", "install", "-q", *packages], check=False, **quiet)
        print(f"{name}: {'ok' if done.returncode == 0 else 'not installed'}", flush=True)
        if done.returncode:
            failed.append(f"{name}: {done.stderr.strip().splitlines()[-1]}")
    print("\n".join(["", *failed]) if failed else f"\nall there; {python} benchmarks/peers/run.py")
    return len(failed)


if __name__ == "__main__":
    sys.exit(main())
