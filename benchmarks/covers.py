"""Random meshes covered, and each cover judged by points, with geometry that shares nothing with what covers them.

    python -m benchmarks.covers                        # 210 meshes, 15 kinds of trouble
    python -m benchmarks.covers --first 17 --meshes 1  # one again; writes no record

`tests/random_meshes.py` draws the meshes, `tests/cover_judge.py` the points of their surfaces and of the spheres. Exit
code 1 if anything that is proved to be covered is not, or stands out further than is said. Writes
benchmarks/results/covers.json.
"""

import argparse
import json
import sys
from collections import Counter
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np

from ikde.errors import IkdeError
from ikde.spheres.cover_mesh import cover_mesh
from tests.cover_judge import judge
from tests.random_meshes import draw_mesh

RESULTS = Path(__file__).parent / "results" / "covers.json"
MESHES = 210
ROUNDING_M = 1e-9


def try_mesh(seed: int) -> dict[str, Any]:
    """One mesh: what is said of its cover, and what points show."""
    with TemporaryDirectory() as folder:
        mesh, path = draw_mesh(seed, Path(folder))
        row: dict[str, Any] = {"seed": seed, "kind": mesh.kind, "triangles": len(mesh.triangles)}
        try:
            cover = cover_mesh(path, mesh.scale, mesh.protrusion_m)
        except IkdeError as error:
            return row | {"refused": str(error).replace(folder, ""), "faults": []}
    rows, rng = cover.rows, np.random.default_rng(seed)
    found = judge(mesh.triangles, rows.centres, rows.radii, rng, of_hulls=cover.only_hulls)
    size_m = float(np.ptp(mesh.triangles.reshape(-1, 3), axis=0).max())
    by_chance = 4.0 * np.sqrt((1.0 - cover.covered) / found.points)
    faults = [
        *(["bare"] if found.bare > (1.0 - cover.covered) + by_chance else []),
        *(["stands out"] if found.out_m > rows.protrusion_m + ROUNDING_M * max(1.0, size_m) else []),
    ]
    return row | {
        "spheres": len(rows.radii),
        "covered": float(cover.covered),
        "only_hulls": cover.only_hulls,
        "asked_mm": mesh.protrusion_m * 1e3,
        "protrusion_mm": rows.protrusion_m * 1e3,
        "seen_out_mm": found.out_m * 1e3,
        "points": found.points,
        "bare": float(found.bare),
        "faults": faults,
    }


def main() -> int:
    """A line a mesh, and the record."""
    parser = argparse.ArgumentParser()
    parser.add_argument("--meshes", type=int, default=MESHES)
    parser.add_argument("--first", type=int, default=0)
    asked = parser.parse_args()
    rows = []
    for seed in range(asked.first, asked.first + asked.meshes):
        rows.append(try_mesh(seed))
        print(" ".join(f"{key}={value}" for key, value in rows[-1].items()), flush=True)
    faults = [row for row in rows if row["faults"]]
    made = [row for row in rows if "spheres" in row]
    total = {
        "meshes": len(rows),
        "refused": Counter(row["refused"] for row in rows if "refused" in row),
        "kinds": Counter(row["kind"] for row in made),
        "covered_whole": sum(row["covered"] == 1.0 for row in made),
        "least_covered": min((row["covered"] for row in made), default=None),
        "only_hulls": sum(row["only_hulls"] for row in made),
        "points": sum(row["points"] for row in made),
        "faults": faults,
    }
    print(json.dumps(total))
    if (asked.first, asked.meshes) == (0, MESHES):
        RESULTS.write_text(json.dumps(total, indent=1) + "\n", encoding="utf-8")
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
