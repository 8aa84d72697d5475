"""ROS bags: those of ROS 1, the SQLite files of ROS 2, and the folders that ROS 2 records to. No ROS is needed."""

from __future__ import annotations

import tempfile
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import rosbags.rosbag1
import rosbags.rosbag2
from rosbags.interfaces import MessageDefinitionFormat

from harness.errors import InputError
from harness.recording.formats.ros_types import RawMessage
from harness.recording.formats.table import Table
from harness.recording.formats.topics import read_messages

FORMS = {MessageDefinitionFormat.MSG: "msg", MessageDefinitionFormat.IDL: "idl"}


def read_ros1_bag(path: Path, file: Path) -> Table:
    """Columns ``/topic/joint/position``, … of a ROS 1 bag; raises InputError for a damaged one."""
    return _read(path, rosbags.rosbag1.Reader(file), "ros1")


def read_ros2_bag(path: Path, file: Path) -> Table:
    """Columns ``/topic/joint/position``, … of an SQLite file of ROS 2; raises InputError for a damaged or another one."""
    if file.suffix == ".db3":
        return _read(path, rosbags.rosbag2.Reader(file), "cdr")
    # The library tells the storage by the ending, we by the content.
    with tempfile.TemporaryDirectory() as folder:
        named = Path(folder) / "bag.db3"
        named.symlink_to(file.resolve())
        return _read(path, rosbags.rosbag2.Reader(named), "cdr")


def read_ros2_folder(path: Path, file: Path) -> Table:
    """The same for a folder with ``metadata.yaml``, whose files may be several, and packed."""
    return _read(path, rosbags.rosbag2.Reader(file), "cdr")


def _read(path: Path, reader: Any, encoding: str) -> Table:
    try:
        with reader:
            return read_messages(path, _messages(reader, encoding))
    except InputError:
        raise
    except Exception as failure:  # errors of the reader, of SQLite and of what unpacks
        raise InputError(
            f"damaged or unknown bag: {failure or type(failure).__name__}",
            mend="record or convert it again",
            source=path,
        ) from None


def _messages(reader: Any, encoding: str) -> Iterator[RawMessage]:
    for connection, time, data in reader.messages():
        definition = connection.msgdef
        form = FORMS.get(definition.format, "")
        kept = getattr(connection.ext, "serialization_format", encoding)
        yield RawMessage(connection.topic, kept, connection.msgtype, form, definition.data, time, bytes(data))
