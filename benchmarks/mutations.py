"""Changes to files: as bytes, as words, and as what they mean; a generator that is seeded decides all."""

import io
import json
import zipfile
from collections.abc import Callable
from copy import deepcopy
from typing import Any

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import yaml

WORDS = (
    *(
        "",
        "null",
        "~",
        "true",
        ".nan",
        ".inf",
        "-.inf",
        "0",
        "-0.0",
        "-1",
        "1e308",
        "-1e308",
        "1e-308",
        "1e5",
        "9" * 400,
    ),
    *(
        "0x10",
        "1_000",
        "[]",
        "{}",
        "[[[[",
        "*a",
        "&a [*a]",
        "!!python/object/apply:os.system [x]",
        "!!int x",
        "? a",
        "- ",
        ": ",
    ),
    *(
        "../../../etc/passwd",
        "/dev/zero",
        "x" * 10_000,
        "\x1b[31m",
        "\u202e",
        "\x00",
        "[red]",
        "<script>",
        "$x$",
        "\\",
        "'",
        '"',
    ),
    *(
        "k**k**k",
        "9**9**9**9",
        "(" * 200,
        "sin(" * 200,
        "1/0",
        "k if k else k",
        "none",
        "tool",
        "world",
        "qiao2021",
        "mm",
        "deg",
    ),
)
VALUES = (
    *(None, True, False, 0, -1, 1, 2**63, 10**30, 1e-300, 1e300, 1e5, 1e9, -1e9, float("nan"), float("inf")),
    *("", "x", "x" * 2000, "\x1b[31m", "../../etc/passwd", "none", "world", "tool", "[red]", "9**9**9", "sin(k)"),
    *([], {}, [None], [0.0], [0.0, 0.0, 0.0], [1e9] * 3, [float("nan")] * 3, {"a": {"b": {}}}, [[]] * 50, ["a", "a"]),
)
HEADERS = (
    *(
        "{'descr': '<f8', 'fortran_order': False, 'shape': (10000000000, 3), }",
        "{'descr': '|O', 'shape': (2,)}",
        "{",
        "(" * 500,
    ),
    *(
        "{'descr': '<f8', 'fortran_order': True, 'shape': (3, 12), }",
        "{'descr': [('a', '<f8')], 'fortran_order': 0, 'shape': (1,)}",
    ),
    *(
        "{'descr': '<U1000', 'fortran_order': False, 'shape': (-1,), }",
        "-" * 5000 + "1",
        "{'descr': '<f8', 'shape': 3L}",
    ),
)

Rng = np.random.Generator


def pick(rng: Rng, choices: Any) -> Any:
    """One of them."""
    return choices[int(rng.integers(len(choices)))]


def few(rng: Rng) -> range:
    """So many changes: mostly one, so that what is wrong is deep inside."""
    return range(min(4, int(rng.geometric(0.6))))


def mutate_bytes(rng: Rng, data: bytes) -> bytes:
    """One to four changes to bytes, of which some are words that mean something."""
    for _ in few(rng):
        most = max(1, len(data) // 4) if rng.random() < 0.2 else 8
        at, length = int(rng.integers(len(data) + 1)), int(rng.integers(1, 1 + most))
        change = int(rng.integers(8))
        if change == 0 and at < len(data):
            data = data[:at] + bytes([data[at] ^ (1 << int(rng.integers(8)))]) + data[at + 1 :]
        elif change == 1:
            data = data[:at] + bytes([int(rng.integers(256))]) + data[at + 1 :]
        elif change == 2:
            data = data[:at] + data[at + length :]
        elif change == 3:
            data = data[: at + length] + data[at : at + length] * int(rng.integers(1, 4)) + data[at + length :]
        elif change == 4:
            data = data[:at] if rng.random() < 0.3 else data
        elif change == 5:
            other = int(rng.integers(len(data) + 1))
            data = data[:at] + data[other : other + length] + data[at + length :]
        elif change == 6:
            data = data[:at] + pick(rng, WORDS).encode("utf-8", "surrogatepass") + data[at:]
        else:
            data = data[:at] + bytes(rng.integers(256, size=int(rng.integers(1, 9)), dtype=np.uint8)) + data[at + 8 :]
    return data


def mutate_words(rng: Rng, text: str) -> bytes:
    """Words and lines of a text exchanged, repeated, left out."""
    lines = text.splitlines(keepends=True)
    for _ in few(rng):
        at = int(rng.integers(len(lines)))
        words = lines[at].split(" ")
        change = int(rng.integers(5))
        if change == 0:
            words[int(rng.integers(len(words)))] = pick(rng, WORDS)
            lines[at] = " ".join(words)
        elif change == 1:
            lines.insert(at, pick(rng, lines))
        elif change == 2 and len(lines) > 1:
            del lines[at]
        elif change == 3:
            lines[at] = pick(rng, ("  ", "", "- ", "\t", "&a ", "*a\n")) + lines[at]
        else:
            lines[at] = lines[at].replace(pick(rng, list(",:[]{}#-0123456789")), pick(rng, WORDS), 1)
    return "".join(lines).encode("utf-8", "surrogatepass")


def mutate_value(rng: Rng, data: Any) -> Any:
    """Plain data with one to three values, keys or entries exchanged."""
    data = json.loads(json.dumps(data))
    for _ in few(rng):
        place = data
        while isinstance(place, dict | list) and place:
            keys = list(place) if isinstance(place, dict) else range(len(place))
            key, change = pick(rng, keys), int(rng.integers(12))
            if isinstance(place[key], dict | list) and place[key] and change > 2:
                place = place[key]
                continue
            if change == 0:
                del place[key]
            elif change == 1 and isinstance(place, dict):
                place[pick(rng, ("x", "", "\x1b[31m", "tool", "x" * 500))] = place.pop(key)
            elif change == 2 and isinstance(place, list):
                place += [place[key]] * int(rng.integers(1, 20))
            else:
                place[key] = deepcopy(pick(rng, VALUES))
            break
    return data


def mutate_yaml(rng: Rng, text: str) -> bytes:
    """A YAML file changed as bytes, as words or as what it means."""
    change = rng.random()
    if change < 0.25:
        return mutate_bytes(rng, text.encode())
    if change < 0.5:
        return mutate_words(rng, text)
    return yaml.safe_dump(mutate_value(rng, yaml.safe_load(text)), sort_keys=False, allow_unicode=True).encode()


def mutate_json(rng: Rng, text: str) -> bytes:
    """The same of a JSON file."""
    if rng.random() < 0.4:
        return mutate_bytes(rng, text.encode())
    return json.dumps(mutate_value(rng, json.loads(text))).encode()


def odd_column(rng: Rng, rows: int) -> Any:
    """A column that nobody expects."""
    return pick(
        rng,
        (
            pa.nulls(rows),
            pa.nulls(rows, pa.float64()),
            [float("nan")] * rows,
            [1e300] * rows,
            [-1] * rows,
            [2**62] * rows,
            ["x"] * rows,
            ["1"] * rows,
            pa.array([None, *["\x1b[31m" * 500] * (rows - 1)], pa.string()).dictionary_encode(),
            [[1.0, 2.0]] * rows,
            [{"a": 1}] * rows,
            [b"\xff"] * rows,
            [True] * rows,
            pa.array(np.arange(rows), pa.timestamp("s")),
            pa.array(np.arange(rows, dtype=np.float16)),
            pa.array([1] * rows, pa.decimal128(10)),
        ),
    )


def mutate_parquet(rng: Rng, data: bytes, write: Callable[[pa.Table], bytes]) -> bytes:
    """A Parquet file changed as bytes or as a table: columns exchanged, left out, repeated; rows cut."""
    if rng.random() < 0.5:
        return mutate_bytes(rng, data)
    table = pq.read_table(pa.BufferReader(data))
    for _ in few(rng):
        at, change = int(rng.integers(table.num_columns)), int(rng.integers(5))
        if change == 0 and table.num_columns > 1:
            table = table.remove_column(at)
        elif change == 1:
            table = table.slice(int(rng.integers(len(table))))
        elif change == 2:
            table = table.append_column(table.column_names[at], table[at])
        elif len(table):
            table = table.set_column(
                at, table.column_names[at], pa.chunked_array([pa.array(odd_column(rng, len(table)))])
            )
    return write(table)


def write_parquet(table: pa.Table) -> bytes:
    """A table as the bytes of a file."""
    sink = io.BytesIO()
    pq.write_table(table, sink)
    return sink.getvalue()


def mutate_npz(rng: Rng, arrays: dict[str, bytes], packing: int) -> bytes:
    """An archive changed as bytes, or a sound one of arrays that are not."""
    members, inside = dict(arrays), rng.random() < 0.5
    if inside:
        name = pick(rng, list(members))
        if rng.random() < 0.4:
            header = pick(rng, HEADERS).encode()
            members[name] = b"\x93NUMPY\1\0" + len(header).to_bytes(2, "little") + header + bytes(288)
        else:
            members[name] = mutate_bytes(rng, members[name])
    buffer = io.BytesIO()
    with zipfile.ZipFile(buffer, "w", packing) as archive:
        for name, contents in members.items():
            archive.writestr(zipfile.ZipInfo(f"{name}.npy"), contents, packing)
    return buffer.getvalue() if inside else mutate_bytes(rng, buffer.getvalue())
