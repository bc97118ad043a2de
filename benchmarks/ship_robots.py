"""Write what stands ready of the robots that ship with ikde: `ikde/robots/ready/*.json`, after an edit of their files.

python benchmarks/ship_robots.py
"""

from ikde.io.ready_robot import FOLDER as READY
from ikde.io.ready_robot import format_ready
from ikde.io.robots import FOLDER, parse_file


def main() -> None:
    """One file a robot."""
    for path in sorted(FOLDER.glob("*.yaml")):
        ready = FOLDER / READY / f"{path.stem}.json"
        ready.parent.mkdir(exist_ok=True)
        ready.write_text(format_ready(parse_file(path), path.read_bytes()), encoding="utf-8")


if __name__ == "__main__":
    main()
