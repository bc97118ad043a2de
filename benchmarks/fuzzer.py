"""Every kind of file that users give to ikde: sound ones, what changes them, and what reads them."""

import io
import json
import shutil
import zipfile
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa
import yaml
from mutations import (
    Rng,
    mutate_bytes,
    mutate_json,
    mutate_npz,
    mutate_parquet,
    mutate_words,
    mutate_yaml,
    pick,
    write_parquet,
)

import ikde
from ikde.batch.parts import serialize
from ikde.batch.summary import summarise
from ikde.io.joint_text import parse_joints
from ikde.io.scene_writers import format_curobo_scene, format_moveit_scene
from ikde.report.batch_page.answers import gather_answers
from ikde.report.batch_page.page import make_batch_page
from ikde.report.html import render_html
from ikde.report.markdown import render_markdown

ROOT = Path(__file__).parent.parent
Cases = dict[str, Callable[[Rng], bytes]]


class Fuzzer:
    """All kinds of files, what changes them and what reads them, in a folder of its own."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self.run = folder / "run"
        self.robot = ikde.load_robot("qiao2021")
        rng = np.random.default_rng(1)
        p, quat = rng.uniform(-1.0, 1.0, (12, 3)), rng.normal(size=(12, 4))
        names = [f"n{k}" for k in range(12)]
        columns = dict(zip("xyz", p.T, strict=True)) | dict(zip(("qw", "qx", "qy", "qz"), quat.T, strict=True))
        self.csv = pa.table({"n": names, **columns}).to_pandas().to_csv(index=False)
        self.parquet = write_parquet(pa.table({"n": names, **columns}))
        self.arrays = {name: _npy(array) for name, array in {"n": np.array(names), "p": p, "quat": quat}.items()}
        self.robots = [path.read_text() for path in sorted((ROOT / "ikde" / "robots").glob("*.yaml"))]
        self.runs = [path.read_text() for path in sorted((ROOT / "configs" / "runs").glob("*.yaml"))]
        tracks = [path.read_text() for path in sorted((ROOT / "configs" / "tracks").glob("*.yaml"))]
        self.tracks = [text.replace("../worlds/", f"{ROOT / 'configs' / 'worlds'}/") for text in tracks]
        self.worlds = [path.read_text() for path in sorted((ROOT / "configs" / "worlds").glob("*.yaml"))]
        self.scenes = [
            json.dumps(yaml.safe_load(text)) for text in write_scenes(ikde.load_world(yaml.safe_load(self.worlds[0])))
        ]
        self.ply = write_ply(p)
        self.pcd = write_pcd(p)
        shutil.copy(ROOT / "configs" / "runs" / "from_csv.csv", folder)
        (folder / "points.csv").write_text(self.csv)
        ikde.run_batch(ikde.load_batch(_small_run(folder)), self.run, threads=1)
        self.kept = {path: path.read_bytes() for path in sorted(self.run.glob("**/*")) if path.is_file()}

    def kinds(self) -> Cases:
        """What makes a mutated file, by kind."""
        q, listed = "q1: 0.1\nq2: 0\nq3: -0.2\nd_x: 1e-3\nq_z: .5\n", json.dumps([0.1] * 9)
        return {
            "robot, YAML": lambda rng: mutate_yaml(rng, pick(rng, self.robots)),
            "run, YAML": lambda rng: mutate_yaml(rng, pick(rng, self.runs)),
            "track, YAML": lambda rng: mutate_yaml(rng, pick(rng, self.tracks)),
            "q, YAML": lambda rng: mutate_yaml(rng, q),
            "q, JSON": lambda rng: mutate_json(rng, listed),
            "targets, CSV": lambda rng: (mutate_words if rng.random() < 0.5 else _mutate_text)(rng, self.csv),
            "targets, Parquet": lambda rng: mutate_parquet(rng, self.parquet, write_parquet),
            "targets, NPZ stored": lambda rng: mutate_npz(rng, self.arrays, zipfile.ZIP_STORED),
            "targets, NPZ compressed": lambda rng: mutate_npz(rng, self.arrays, zipfile.ZIP_DEFLATED),
            "world, YAML": lambda rng: mutate_yaml(rng, pick(rng, self.worlds)),
            "world, JSON": lambda rng: mutate_json(rng, pick(rng, self.scenes)),
            "cloud, PLY": lambda rng: (
                _mutate_text(rng, self.ply) if rng.random() < 0.5 else mutate_words(rng, self.ply)
            ),
            "cloud, PCD": lambda rng: (
                _mutate_text(rng, self.pcd) if rng.random() < 0.5 else mutate_words(rng, self.pcd)
            ),
            "run folder, manifest": lambda rng: mutate_json(rng, (self.kept[self.run / "manifest.json"]).decode()),
            "run folder, solutions": lambda rng: self._mutate_part(rng, "solutions"),
            "run folder, timing": lambda rng: self._mutate_part(rng, "timing"),
        }

    def make(self, seed: int, number: int) -> tuple[str, bytes]:
        """Kind and bytes of a case."""
        kinds = self.kinds()
        kind = list(kinds)[number % len(kinds)]
        return kind, kinds[kind](np.random.default_rng((seed, number)))

    def read(self, kind: str, data: bytes, *, draw: bool = False) -> None:
        """Give a file to what users call for its kind."""
        what, _, form = kind.partition(", ")
        if what == "run folder":
            self._read_run(form, data, draw)
            return
        if what == "cloud":
            name = f"case.{form.lower()}"
            (self.folder / name).write_bytes(data)
            world = self.folder / "cloud.yaml"
            world.write_text(f"obstacles: {{a: {{cloud: {{path: {name}, radius: 0.01}}}}}}")
            ikde.load_world(world)
            return
        endings = {"YAML": "yaml", "JSON": "json", "CSV": "csv", "Parquet": "parquet"}
        path = self.folder / f"case.{endings.get(form, 'npz')}"
        path.write_bytes(data)
        readers: dict[str, Callable[[], Any]] = {
            "robot": lambda: ikde.load_robot(path),
            "run": lambda: ikde.load_batch(path),
            "track": lambda: ikde.load_track(path),
            "world": lambda: ikde.write_world(ikde.load_world(path), self.folder / "written.yaml"),
            "q": lambda: parse_joints(self.robot, str(path), "m", "rad"),
            "targets": lambda: ikde.load_batch(_table_run(path)),
        }
        readers[what]()

    def _read_run(self, form: str, data: bytes, draw: bool) -> None:
        path = self._file_of(form)
        path.write_bytes(data)
        try:
            for read in (ikde.read_batch, lambda run: ikde.read_batch(run, timing=True), summarise, gather_answers):
                answers = read(self.run)
            if draw:
                page = make_batch_page(answers)
                render_html(page).encode()
                render_markdown(page).encode()
        finally:
            path.write_bytes(self.kept[path])

    def _file_of(self, form: str) -> Path:
        return self.run / "manifest.json" if form == "manifest" else self.run / form / "a-00001.parquet"

    def _mutate_part(self, rng: Rng, form: str) -> bytes:
        write = lambda table: serialize(table).to_pybytes()  # noqa: E731 - with a part's own choices
        return mutate_parquet(rng, self.kept[self._file_of(form)], write)


def _mutate_text(rng: Rng, text: str) -> bytes:
    return mutate_bytes(rng, text.encode())


def write_scenes(world: ikde.World) -> list[str]:
    """A world as scenes of MoveIt and cuRobo."""
    return [format_moveit_scene(world).text, format_curobo_scene(world).text]


def write_ply(p: np.ndarray) -> str:
    """Points as a PLY file of text."""
    head = f"ply\nformat ascii 1.0\nelement vertex {len(p)}\n"
    fields = "".join(f"property double {axis}\n" for axis in "xyz")
    return f"{head}{fields}end_header\n" + _lines(p)


def write_pcd(p: np.ndarray) -> str:
    """Points as a PCD file of text."""
    return f"FIELDS x y z\nSIZE 8 8 8\nTYPE F F F\nCOUNT 1 1 1\nPOINTS {len(p)}\nDATA ascii\n" + _lines(p)


def _lines(p: np.ndarray) -> str:
    return "".join(f"{x!r} {y!r} {z!r}\n" for x, y, z in p.tolist())


def _npy(array: np.ndarray) -> bytes:
    buffer = io.BytesIO()
    np.save(buffer, array)
    return buffer.getvalue()


def _table_run(path: Path) -> dict[str, Any]:
    """A run over a table: with quaternions, names and millimetres."""
    whole = path.suffix == ".npz"
    columns = {"position": "p" if whole else ["x", "y", "z"], "name": "n"}
    columns["quat_wxyz"] = "quat" if whole else ["qw", "qx", "qy", "qz"]
    return {
        "robot": "qiao2021",
        "targets": {"file": {"path": str(path), "columns": columns, "units": {"length": "mm"}}},
    }


def _small_run(folder: Path) -> dict[str, Any]:
    settings = {"restarts": 1, "de": {"population": 6, "generations": 1}}
    quick = {"method": "de", "settings": settings, "detector": "none"}
    run = _table_run(folder / "points.csv")
    return {**run, "arms": {"a": quick, "b": quick}, "grade": ["typical"], "repeats": 2, "chunk": 8, "explain": False}


KINDS = tuple(Fuzzer.kinds(Fuzzer.__new__(Fuzzer)))
