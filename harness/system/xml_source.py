"""XML read without entities, document types or the network; lines kept for messages."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any, NoReturn

from lxml import etree

from harness.errors import InputError, UnsupportedError

_XACRO = ("http://www.ros.org/wiki/xacro", "http://ros.org/wiki/xacro", "http://wiki.ros.org/xacro")


_COMMENT = re.compile(rb"<!--.*?-->", re.DOTALL)


def _blank(comment: re.Match[bytes]) -> bytes:
    return b"\n" * comment[0].count(b"\n")


def _refuse_declaration(source: Path | None, line: int) -> NoReturn:
    raise InputError(
        "has a document type declaration (DTD or entities)", mend="take <!DOCTYPE …> out", source=source, line=line
    )


def parse_xml(data: bytes, source: Path | None = None) -> Any:
    """Root element of an XML document (``lxml``).

    Raises InputError with line and column for broken XML, and for document types and entities, which could read
    other files or swell without bound.
    """
    # Before parsing, so that the refusal does not depend on what the entity does; after it, for other encodings.
    bare = _COMMENT.sub(_blank, data)
    if declaration := re.search(rb"<!(DOCTYPE|ENTITY)", bare):
        _refuse_declaration(source, bare.count(b"\n", 0, declaration.start()) + 1)
    parser = etree.XMLParser(
        resolve_entities=False, no_network=True, load_dtd=False, dtd_validation=False, huge_tree=False, remove_pis=True
    )
    try:
        root = etree.fromstring(data, parser)
    except etree.XMLSyntaxError as error:
        line, column = error.position
        if "Excessive depth" in (error.msg or ""):
            raise InputError(
                "elements are nested more than 256 deep", mend="write long chains as URDF or TOML", source=source
            ) from None
        what = (error.msg or "cannot be parsed").partition(", line ")[0]
        raise InputError(
            f"broken XML: {what}", mend="mend the syntax", source=source, line=line or None, column=column or None
        ) from None
    info = root.getroottree().docinfo
    if info.doctype or info.internalDTD is not None:
        _refuse_declaration(source, 1)
    for element in root.iter():
        if isinstance(element.tag, str) and any(element.tag.startswith(f"{{{uri}}}") for uri in _XACRO):
            raise UnsupportedError(
                f"<xacro:{etree.QName(element).localname}> is not expanded",
                mend="run `xacro file.xacro > file.urdf` first",
                source=source,
                line=element.sourceline,
            )
    return root
