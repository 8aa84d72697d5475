"""Valid files of every format that is read, and what may happen to them; nothing here reads them."""

from __future__ import annotations

import gzip
import json
import random
import re
import struct
from collections.abc import Callable
from pathlib import Path

import h5py
import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import scipy.io
from mcap.writer import Writer as McapWriter
from rosbags.rosbag1 import Writer as Bag
from rosbags.typesys import Stores, get_typestore

MODELS = Path(__file__).resolve().parents[2] / "models"
TIME = np.arange(120) * 0.01
ANGLE = 0.7 * np.cos(3.0 * TIME) * np.exp(-0.1 * TIME)
STRANGE = (
    "nan", "-1", "0", "1e999", "inf", "-inf", "", '"', "<", "]", "true", "[[]]", "{}", "é", "\x00", "1 2", "base",
    "99999999999999999999", "1" + 400 * "0", "1" + 5000 * "0", "1e300", "-1e300", "1e-300", "1e101", "1e24", "1e12",
    "10**10**10", "[deg]", "[10**10**10 rad]", "[9**9**9**9]", 300 * "[", 2000 * "(", "\x1b[31m", 3000 * "a", "time",
    "pivot.position", ",", ";", "\t", "\n", "null", "1_000", "0x10", "2026-02-30", "25:61:61", "NaT", "&lol;", "<!--",
)  # fmt: skip


def _csv(path: Path) -> None:
    rows = "".join(f"{t:.3f},{57.3 * q:.6f}\n" for t, q in zip(TIME, ANGLE, strict=True))
    path.write_text("time [s],pivot.position [deg]\n" + rows)


def _csv_gz(path: Path) -> None:
    rows = "".join(f"{t:.3f};{q:.6f}\n" for t, q in zip(TIME, ANGLE, strict=True))
    path.write_bytes(gzip.compress(b"# a swing\ntime;pivot.position\n" + rows.encode(), mtime=0))


def _mat(path: Path) -> None:
    scipy.io.savemat(path, {"time": TIME, "pivot": {"position": ANGLE, "velocity": -ANGLE}}, do_compression=True)


def _mat_plain(path: Path) -> None:
    scipy.io.savemat(path, {"time": TIME, "pivot": {"position": ANGLE}, "note": "a swing"})


def _hdf5(path: Path) -> None:
    with h5py.File(path, "w") as file:
        file["time"] = TIME
        set_ = file.create_dataset("pivot/position", data=ANGLE, compression="gzip")
        set_.attrs["units"] = "rad"
        file.create_dataset("table", data=np.zeros(120, dtype=[("a", "f8"), ("b", "i4")]))


def _parquet(path: Path) -> None:
    pq.write_table(pa.table({"time": TIME, "pivot.position": ANGLE, "note": ["swing"] * len(TIME)}), path)


def _npz(path: Path) -> None:
    np.savez_compressed(path, **{"time": TIME, "pivot.position": ANGLE})


def _netcdf(path: Path) -> None:
    with scipy.io.netcdf_file(path, "w") as file:
        file.createDimension("n", len(TIME))
        for name, values in (("time", TIME), ("pivot.position", ANGLE)):
            variable = file.createVariable(name, "d", ("n",))
            variable[:] = values
            variable.units = "s" if name == "time" else "rad"


def _mcap(path: Path) -> None:
    with path.open("wb") as stream:
        writer = McapWriter(stream)
        writer.start()
        schema = writer.register_schema("state", "jsonschema", b"{}")
        channel = writer.register_channel("/state", "json", schema)
        for t, q in zip(TIME, ANGLE, strict=True):
            data = json.dumps({"name": ["pivot"], "position": [q]}).encode()
            writer.add_message(channel, round(t * 1e9), data, round(t * 1e9))
        writer.finish()


def _bag(path: Path) -> None:
    store = get_typestore(Stores.ROS1_NOETIC)
    with Bag(path) as bag:
        kind, types, empty = "sensor_msgs/msg/JointState", store.types, np.empty(0)
        connection = bag.add_connection("/joint_states", kind, typestore=store)
        for k, (t, q) in enumerate(zip(TIME, ANGLE, strict=True)):
            stamp = types["builtin_interfaces/msg/Time"](10**9 + int(t), round((t - int(t)) * 1e9))
            header = types["std_msgs/msg/Header"](k, stamp, "")
            message = types[kind](header, ["pivot"], np.array([q]), empty, empty)
            bag.write(connection, 10**18 + round(t * 1e9), store.serialize_ros1(message, kind))


RECORDINGS: dict[str, Callable[[Path], None]] = {
    "csv": _csv, "csv.gz": _csv_gz, "mat": _mat, "plain.mat": _mat_plain, "h5": _hdf5, "parquet": _parquet, "npz": _npz,
    "nc": _netcdf, "mcap": _mcap, "bag": _bag,
}  # fmt: skip
ROW = {
    "case": "pendulum", "quantity": "trajectory", "engines": ["denoc", "mujoco"], "difference": 3e-10, "allowed": 1e-8,
    "unit": "rad", "why_allowed": "RK4 at 1e-4 s", "verdict": "pass", "note": "", "first_divergence": None,
}  # fmt: skip


def _results(path: Path) -> None:
    rows = [{**ROW, "case": f"pendulum_{k}"} for k in range(5)]
    path.write_text(json.dumps({"schema": "denoc.results/1", "versions": {"denoc": "1"}, "rows": rows}, indent=1))


def _accepted(path: Path) -> None:
    whole = json.loads((MODELS.parent / "reference" / "accepted.json").read_text())
    whole["rows"] = dict(list(whole["rows"].items())[:8])
    path.write_text(json.dumps(whole, indent=1))


def _unit(path: Path) -> None:
    path.write_text("2*pi/4096 * deg**2 / mil")


def _mapping(path: Path) -> None:
    path.write_text('[columns]\n"theta" = "pivot.position [deg]"\n"clock" = "time [ms]"\n')


# What is read beside models and recordings.
OTHERS: dict[str, Callable[[Path], None]] = {
    "results.json": _results, "accepted.json": _accepted, "unit": _unit, "columns.toml": _mapping,
}  # fmt: skip
MODEL_FILES = {
    f"{path.stem}{path.suffix}": path
    for path in sorted(MODELS.rglob("*"))
    if path.stem in ("cart_pendulum", "flexible_pendulum", "two_link_flexible", "triple_pendulum")
}


def damaged_bytes(data: bytes, rng: random.Random) -> bytes:
    """One to three things that disks, networks and other programs do to a file."""
    content = bytearray(data)
    for _ in range(rng.choice((1, 1, 1, 2, 3))):
        if not content:
            break
        at = rng.randrange(len(content))
        kind = rng.randrange(8)
        if kind == 0:
            content[at] = rng.randrange(256)
        elif kind == 1:
            content[at] ^= 1 << rng.randrange(8)
        elif kind == 2:
            del content[at:]
        elif kind == 3:
            del content[at : at + rng.randint(1, 200)]
        elif kind == 4:
            content[at:at] = content[at : at + rng.randint(1, 200)]
        elif kind == 5:
            content[at:at] = rng.randbytes(rng.randint(1, 50))
        elif kind == 6:
            number = rng.choice((0, 1, 0x7F, 0xFF, 0x7FFFFFFF, 0xFFFFFFFF, 0x80000000, 10**6, 10**9))
            size = rng.choice(("<I", ">I", "<Q", ">Q"))
            content[at : at + struct.calcsize(size)] = struct.pack(size, number)
        else:
            content[at : at + rng.randint(1, 64)] = rng.randbytes(rng.randint(1, 64))
    return bytes(content)


def damaged_text(text: str, rng: random.Random) -> str:
    """A few words of a text taken out, doubled, swapped or replaced by strange ones."""
    words = re.split(r"(\s+|[=\[\]{},;<>\"/])", text)
    for _ in range(rng.choice((1, 1, 1, 2, 4))):
        k = rng.randrange(len(words))
        kind = rng.randrange(5)
        if kind == 0:
            words[k] = ""
        elif kind == 1:
            words[k] = words[k] * 2
        elif kind == 2:
            other = rng.randrange(len(words))
            words[k], words[other] = words[other], words[k]
        else:
            words[k] = rng.choice(STRANGE)
    return "".join(words)


def hostile(kind: str, valid: bytes, seed: int) -> bytes:
    """A damaged copy of a valid file of a kind: of the same seed the same bytes, on any machine."""
    rng = random.Random(f"{kind} {seed}")
    textual = kind in MODEL_FILES or kind in OTHERS or kind == "csv"
    if kind == "csv.gz" and rng.random() < 0.3:
        text = gzip.decompress(valid).decode()
        return gzip.compress(damaged_text(text, rng).encode("utf-8", "surrogatepass"), mtime=0)
    if textual and rng.random() < 0.8:
        return damaged_text(valid.decode(), rng).encode("utf-8", "surrogatepass")
    return damaged_bytes(valid, rng)
