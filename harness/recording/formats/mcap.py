"""MCAP logs: messages in JSON, in CDR (ROS 2) and of ROS 1."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

from mcap.exceptions import McapError
from mcap.reader import make_reader

from harness.errors import InputError
from harness.recording.formats.ros_types import RawMessage
from harness.recording.formats.table import Table
from harness.recording.formats.topics import read_messages

SCHEMAS = {"ros2msg": "msg", "ros1msg": "msg", "ros2idl": "idl", "omgidl": "idl"}


def read_mcap(path: Path, file: Path) -> Table:
    """Columns ``/topic/joint/position``, … over the time the messages were stamped with, or logged at.

    Raises InputError for a damaged file and, naming topic and encoding, if no message can be read.
    """
    try:
        return read_messages(path, _messages(file))
    except InputError:
        raise
    except (McapError, OSError, EOFError, ValueError) as failure:
        raise InputError(
            f"damaged MCAP file: {failure or type(failure).__name__}", mend="record or convert it again", source=path
        ) from None


def _messages(file: Path) -> Iterator[RawMessage]:
    with file.open("rb") as stream:
        for schema, channel, message in make_reader(stream).iter_messages():
            name, form, text = "", "", ""
            if schema is not None:
                name, form = schema.name, SCHEMAS.get(schema.encoding, "")
                text = schema.data.decode("utf-8", "replace") if form else ""
            encoding = channel.message_encoding
            yield RawMessage(channel.topic, encoding, name, form, text, message.log_time, message.data)
