"""Bytes of ROS messages read by ``rosbags``, by the definition that comes with them or that every ROS has."""

from __future__ import annotations

import json
from typing import Any, NamedTuple

from rosbags.typesys import Stores, TypesysError, get_types_from_idl, get_types_from_msg, get_typestore

IDL_MARK = "=" * 80 + "\n"


class RawMessage(NamedTuple):
    """Bytes as recorded. kind: name of the type; form of its definition: ``msg``, ``idl`` or "". time: logged at [ns]."""

    topic: str
    encoding: str
    kind: str
    form: str
    definition: str
    time: int
    data: bytes


class UnknownMessageError(ValueError):
    """No message of the topic can be read; the text says why, with the topic as its subject."""


def _once(members: list[tuple[str, Any]]) -> dict[str, Any]:
    """An object of JSON; ValueError where it has two members of one name, of which the last would hide the first."""
    found = dict(members)
    if len(found) < len(members):
        raise ValueError("two members of one name")
    return found


class Decoder:
    """Reads messages; keeps one store of types for ROS 1 and one for ROS 2, and which definitions it has looked at."""

    def __init__(self) -> None:
        self.stores: dict[str, Any] = {}
        self.known: set[tuple[str, str]] = set()

    def message(self, raw: RawMessage) -> Any:
        """A message as a dataclass, or a JSON value.

        Raises UnknownMessageError for encodings other than ``cdr``, ``ros1`` and ``json`` and for unknown types, ValueError for
        bytes that are none of that type.
        """
        if raw.encoding == "json":
            return json.loads(raw.data, object_pairs_hook=_once)
        if raw.encoding not in ("cdr", "ros1"):
            raise UnknownMessageError(f"is encoded as {raw.encoding!r}")
        kind = raw.kind if raw.kind.count("/") > 1 else raw.kind.replace("/", "/msg/", 1)
        store = self._store(raw.encoding)
        if (raw.encoding, kind) not in self.known:
            self._learn(store, kind, raw.form, raw.definition)
            self.known.add((raw.encoding, kind))
        if kind not in store.types:
            what = raw.kind or "messages without a type"
            raise UnknownMessageError(f"holds {what}, whose definition is not in the file")
        try:
            read = store.deserialize_cdr if raw.encoding == "cdr" else store.deserialize_ros1
            return read(raw.data, kind)
        except Exception as failure:  # of damaged bytes: the library's own, of struct, of indices, of memory
            raise ValueError(f"{type(failure).__name__}: {failure}") from None

    def _store(self, encoding: str) -> Any:
        if encoding not in self.stores:
            self.stores[encoding] = get_typestore(Stores.LATEST if encoding == "cdr" else Stores.ROS1_NOETIC)
        return self.stores[encoding]

    def _learn(self, store: Any, kind: str, form: str, definition: str) -> None:
        """What the file says of a type goes before what every ROS has, unless it says nothing that can be read."""
        types: dict[str, Any] = {}
        try:
            if form == "msg" and definition.strip():
                types = dict(get_types_from_msg(definition, kind))
            elif form == "idl" and definition.strip():
                parts = definition.split(IDL_MARK)[1:] if definition.startswith(f"{IDL_MARK}IDL: ") else [definition]
                for part in parts:
                    text = part.split("\n", 1)[1] if part.startswith("IDL: ") else part
                    types |= get_types_from_idl(text)
        except (TypesysError, SyntaxError, ValueError, IndexError):
            types = {}
        for name, fields in types.items():
            if name in store.types and name != kind:
                continue
            if name in store.fielddefs and store.fielddefs[name] == fields:
                continue
            store.types.pop(name, None)
            store.fielddefs.pop(name, None)
            store.cache.pop(name, None)
            try:
                store.register({name: fields})
            except TypesysError:
                continue
