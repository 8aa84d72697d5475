"""Which units a folder holds, and which recordings each of them has."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from harness.errors import InputError

# Formats are told by content; which files of a folder are recordings at all, by their endings.
RECORDINGS = (
    "csv", "tsv", "txt", "dat", "parquet", "pq", "h5", "hdf5", "hdf", "mat", "nc", "cdf", "npz", "npy", "mcap", "db3", "bag",
)  # fmt: skip
PACKED = ("gz", "bz2", "xz")
ABOUT = ("readme", "license", "licence", "notes", "changelog")  # of what else a text file is called
MODELS = ("model.toml", "model.urdf", "model.xml")


@dataclass(frozen=True)
class Unit:
    """One unit. name: of its file or folder; recordings: the one held out last; model: its own, if it has one."""

    name: str
    recordings: tuple[str, ...]
    model: str | None = None

    def files(self) -> list[list[str | int]]:
        """Name, size [byte] and time of the last change [ns] of everything that its answer is made from."""
        paths = [Path(p) for p in (*self.recordings, *((self.model,) if self.model else ()))]
        every = [file for path in paths for file in (sorted(path.iterdir()) if path.is_dir() else [path])]
        return [[file.name, (stat := file.stat()).st_size, stat.st_mtime_ns] for file in every]


def units_in(folder: str | Path, *, but: str | Path | None = None) -> tuple[list[Unit], list[str]]:
    """The units of a fleet's folder by name, and the names of what else lies there.

    A subfolder is a unit with the recordings in it, in the order of their names, and its own model if it holds ``model.toml``,
    ``model.urdf`` or ``model.xml``; a recording in the folder itself is a unit of one recording. but: a path that is none.
    Raises InputError where there is no such folder, or no unit in it.
    """
    home = Path(folder)
    if not home.is_dir():
        what = "is a file, not a folder" if home.exists() else "no such folder"
        raise InputError(what, source=home, mend="give the folder that holds one file or folder for each unit")
    units, others = [], []
    apart = None if but is None else Path(but).resolve()
    for path in sorted(home.iterdir()):
        if path.name.startswith(".") or path.resolve() == apart:
            continue
        if path.is_dir():
            units.append(_of_folder(path.resolve()))
        elif is_recording(path):
            units.append(Unit(path.name, (str(path.resolve()),)))
        else:
            others.append(path.name)
    if not units:
        raise InputError(
            "holds no unit", source=home, mend="put one recording, or one folder of recordings, for each unit there"
        )
    return units, others


def _of_folder(folder: Path) -> Unit:
    if (folder / "metadata.yaml").is_file():
        # A ROS 2 bag is a folder.
        return Unit(folder.name, (str(folder),))
    found = [
        path
        for path in sorted(folder.iterdir())
        if not path.name.startswith(".")
        and ((path / "metadata.yaml").is_file() if path.is_dir() else is_recording(path))
    ]
    own = next((str(folder / name) for name in MODELS if (folder / name).is_file()), None)
    return Unit(folder.name, tuple(map(str, found)), own)


def is_recording(path: Path) -> bool:
    """Whether a file is a recording, by the endings of its name."""
    stem, *endings = path.name.lower().split(".")
    if endings and endings[-1] in PACKED:
        endings.pop()
    return bool(endings) and endings[-1] in RECORDINGS and stem not in ABOUT
