"""A system from a file, whatever of the known formats it is in."""

from __future__ import annotations

import codecs
import tomllib
from collections.abc import Sequence
from pathlib import Path

from harness.errors import InputError
from harness.system.description import System
from harness.system.read_mjcf import read_mjcf
from harness.system.read_toml import read_toml
from harness.system.read_urdf import read_urdf
from harness.system.xml_source import parse_xml

XML = (".urdf", ".xml", ".mjcf", ".xacro")  # endings of files that are expected to hold it


def load(
    path: str | Path,
    *,
    tolerance: float | None = None,
    physical: bool = True,
    allow: Sequence[str | Path] = (),
    floating: bool = False,
) -> System:
    """Read a mechanism from URDF, MJCF or the project's TOML, told apart by content.

    tolerance: relative 1σ of nominal masses, lengths, inertias, stiffnesses; overrides what the file says.
    physical: refuse inertia that no body can have; with False it becomes a line in ``System.notes``, and only
        joints without positive inertia against them are refused.
    allow: folders beside the model's own that an MJCF may name includes and meshes in.
    floating: let the root link of a URDF float on a free joint, where it is fixed to the world otherwise; the other formats
        say themselves what floats, and refuse it.
    Raises InputError, one line that names file, line where known, what is wrong and the mend, and UnsupportedError
    for what is well formed but not modelled.
    """
    source = Path(path)
    data = _read(source)
    if tolerance is not None and not 0.0 <= tolerance < 1.0:
        raise InputError(f"tolerance {tolerance:g} is not a relative 1σ between 0 and 1", mend="0.01 is one per cent")
    root = parse_xml(data, source) if _is_xml(data) else None
    if floating and (root is None or root.tag != "robot"):
        raise InputError(
            "a floating root is asked for, and the file is no URDF",
            mend="give the root a joint of type free in the file",
            source=source,
        )
    if root is None:
        text = _text(data, source)
        if source.suffix.lower() in XML and not _is_toml(text):
            raise InputError(
                "holds no XML: it begins without '<'",
                mend="give a URDF or MJCF; a path or an error page may have been saved in its place",
                source=source,
                line=1,
            )
        return read_toml(text, source, tolerance=tolerance, physical=physical)
    if root.tag == "robot":
        return read_urdf(root, source, tolerance=tolerance, physical=physical, floating=floating)
    if root.tag == "mujoco":
        folders = [Path(folder) for folder in allow]
        return read_mjcf(data, root, source, tolerance=tolerance, physical=physical, allow=folders)
    raise InputError(
        f"the root element is <{root.tag}>",
        mend="URDF begins with <robot>, MJCF with <mujoco>",
        source=source,
        line=root.sourceline,
    )


def _is_toml(text: str) -> bool:
    try:
        tomllib.loads(text)
    except (tomllib.TOMLDecodeError, RecursionError):
        return False
    return True


def _is_xml(data: bytes) -> bool:
    if data.startswith((codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE)):
        return data[:64].decode("utf-16", "ignore").lstrip().startswith("<")
    return data[:64].removeprefix(codecs.BOM_UTF8).lstrip().startswith(b"<")


def _read(source: Path) -> bytes:
    try:
        data = source.read_bytes()
    except FileNotFoundError:
        raise InputError("there is no such file", mend="check the path", source=source) from None
    except IsADirectoryError:
        raise InputError(
            "is a folder, not a model file", mend="name a .urdf, .xml or .toml in it", source=source
        ) from None
    except OSError as error:
        raise InputError(f"cannot be read: {error.strerror}", mend="check its permissions", source=source) from None
    if not data.strip():
        raise InputError("is empty", mend="give a URDF, MJCF or TOML model", source=source)
    return data


def _text(data: bytes, source: Path) -> str:
    try:
        return data.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        line = data[: error.start].count(b"\n") + 1
        raise InputError(
            "is not UTF-8 text", mend="give a URDF, MJCF or TOML model saved as UTF-8", source=source, line=line
        ) from None
