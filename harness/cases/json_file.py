"""JSON files that people may have damaged: read strictly, refused in one line."""

from __future__ import annotations

import json
import math
import re
from pathlib import Path
from typing import Any, TypeVar

import msgspec

from harness.errors import InputError

T = TypeVar("T")
_HALVES = re.compile(r"\\u[dD][89a-fA-F]")
# Control characters but tab, line feed and return, as they stand in a string and as they are escaped.
_RAW = re.compile("[\x7f-\x9f]")
_ESCAPED = re.compile(r"(?<!\\)((?:\\\\)*)\\(?:[bf]|u00(?:0[0-8bcefBCEF]|1[0-9a-fA-F]|7[fF]|[89][0-9a-fA-F]))")


def read_json(
    path: str | Path, *, missing: str = "there is no such file", mend: str, restore: str = "", finite: bool = True
) -> Any:
    """The document in a JSON file.

    missing, mend: what is said, and advised, where there is no file. restore: advised where it is damaged.
    finite: refuse numbers that are not finite.
    Control characters become �: what is read is printed, and a terminal takes some of them for commands.
    Raises InputError for a missing, unreadable or damaged file, and where an object has two members of one name: only
    the last would count, and hide the first.
    """
    path = Path(path)
    restore = restore or mend
    try:
        text = path.read_text(encoding="utf-8")
    except FileNotFoundError:
        raise InputError(missing, source=path, mend=mend) from None
    except OSError as error:
        raise InputError(f"cannot be read: {error.strerror}", source=path, mend=mend) from error
    except UnicodeDecodeError as error:
        line = error.object[: error.start].count(b"\n") + 1
        raise InputError("is not a text file", source=path, line=line, mend=restore) from error
    try:
        text = _ESCAPED.sub("\\1\ufffd", _RAW.sub("\ufffd", text))
        numbers: dict[str, Any] = {"parse_constant": _refused, "parse_float": _finite} if finite else {}
        document = json.loads(text, object_pairs_hook=_once, **numbers)
        if _HALVES.search(text):
            # Half of a pair of code units alone is no letter, and cannot be written anywhere.
            json.dumps(document, ensure_ascii=False).encode()
        return document
    except json.JSONDecodeError as error:
        raise InputError(
            f"is not JSON: {error.msg}", source=path, line=error.lineno, column=error.colno, mend=restore
        ) from error
    except RecursionError:
        raise InputError("is nested too deep", source=path, mend=restore) from None
    except UnicodeEncodeError:
        raise InputError("is damaged: it holds half a letter", source=path, mend=restore) from None
    except ValueError as error:  # two members of one name, no finite number, or one of thousands of digits
        raise InputError(f"is damaged: {error}", source=path, mend=restore) from error


def _refused(constant: str) -> Any:
    raise ValueError(f"{constant} is no finite number")


def _finite(digits: str) -> float:
    value = float(digits)
    if math.isinf(value):
        raise ValueError(f"{digits[:40]} is no finite number")
    return value


def _once(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    found = dict(pairs)
    if len(found) < len(pairs):
        names = [name for name, _ in pairs]
        twice = next(name for name in names if names.count(name) > 1)
        raise ValueError(f"{twice[:80]!r} stands twice in one object")
    return found


def shaped(document: Any, kind: type[T], *, source: str | Path | None, mend: str) -> T:
    """A document as a (nested) dataclass; InputError names the member that is missing or of the wrong kind."""
    try:
        return msgspec.convert(document, kind)
    except msgspec.ValidationError as error:
        what, _, place = str(error).partition(" - at `$")
        what = re.sub(r"^(Object m|M)issing required field", "lacks", what)
        where = place.rstrip("`").lstrip(".")
        raise InputError(
            f"is incomplete or damaged: {what}" + (f" at {where[:120]}" if where else ""), source=source, mend=mend
        ) from error
    except (OverflowError, RecursionError) as error:
        raise InputError(f"is damaged: {error}", source=source, mend=mend) from error
