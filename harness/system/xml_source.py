"""XML read without entities, document types or the network; lines kept for messages.

As tolerant as the tools that models come from (urdfdom, MuJoCo and Gazebo read with TinyXML, which knows neither namespaces nor
encodings): a default namespace counts for nothing, a prefix need not be declared, and a comment may be in any encoding.
"""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any, NoReturn

from lxml import etree

from harness.errors import InputError, UnsupportedError

# What of a URDF says how it moves; paths of meshes may hold what another tool expands.
_MOVING = (
    "link", "joint", "parent", "child", "origin", "axis", "mass", "inertia", "limit", "dynamics", "mimic",
)  # fmt: skip
_XACRO = ("http://www.ros.org/wiki/xacro", "http://ros.org/wiki/xacro", "http://wiki.ros.org/xacro")


_COMMENT = re.compile(rb"<!--.*?-->", re.DOTALL)
_NOT_ASCII = re.compile(rb"[^\x00-\x7f]")


def _blank(comment: re.Match[bytes]) -> bytes:
    return b"\n" * comment[0].count(b"\n")


def _readable(comment: re.Match[bytes]) -> bytes:
    """The comment with a question mark for every byte that needs an encoding: columns and lines stay."""
    return _NOT_ASCII.sub(b"?", comment[0])


def without_foreign_comments(data: bytes) -> bytes:
    """The document, its comments in ASCII where the whole is not UTF-8 text; unchanged where it is, or is in UTF-16."""
    if b"\x00" in data[:4]:
        return data
    try:
        data.decode("utf-8")
    except UnicodeDecodeError:
        return _COMMENT.sub(_readable, data)
    return data


def _refuse_declaration(source: Path | None, line: int) -> NoReturn:
    raise InputError(
        "has a document type declaration (DTD or entities)", mend="take <!DOCTYPE …> out", source=source, line=line
    )


def namespace_and_name(element: Any) -> tuple[str, str]:
    """Namespace of an element (empty if none is declared), and its name with an undeclared prefix."""
    if not isinstance(element.tag, str):
        return "", ""
    # Not by `QName`, which refuses the colon of an undeclared prefix.
    uri, _, name = element.tag.rpartition("}")
    return uri.removeprefix("{"), name


def prefix_and_name(element: Any) -> tuple[str, str]:
    """Namespace prefix (empty if there is none), declared or not, and the name after it."""
    prefix, colon, name = namespace_and_name(element)[1].rpartition(":")
    return (prefix, name) if colon else (element.prefix or "", name)


def parse_xml(data: bytes, source: Path | None = None) -> Any:
    """Root element of an XML document (``lxml``); elements of the root's default namespace have none.

    Raises InputError with line and column for broken XML, and for document types and entities, which could read
    other files or swell without bound.
    """
    data = without_foreign_comments(data)
    # Before parsing, so that the refusal does not depend on what the entity does; after it, for other encodings.
    bare = _COMMENT.sub(_blank, data)
    if declaration := re.search(rb"<!(DOCTYPE|ENTITY)", bare):
        _refuse_declaration(source, bare.count(b"\n", 0, declaration.start()) + 1)
    parser = _parser()
    try:
        root = etree.fromstring(data, parser)
    except etree.XMLSyntaxError as error:
        if not _only_namespaces(parser):
            raise _broken(error, source) from None
        # What is said with an undeclared prefix keeps it as part of its name; all else about the document is sound.
        root = etree.fromstring(data, _parser(recover=True))
    info = root.getroottree().docinfo
    if info.doctype or info.internalDTD is not None:
        _refuse_declaration(source, 1)
    _without_default_namespace(root)
    for element in root.iter():
        prefix, name = prefix_and_name(element)
        uri = namespace_and_name(element)[0]
        if uri in _XACRO or (prefix == "xacro" and not uri):
            raise UnsupportedError(
                f"<xacro:{name}> is not expanded",
                mend="run `xacro file.xacro > file.urdf` first",
                source=source,
                line=element.sourceline,
            )
        if root.tag == "robot" and name in _MOVING:
            for key, value in element.attrib.items():
                if "${" in value or "$(" in value:
                    raise UnsupportedError(
                        f"{key}={value!r} of <{name}> is not expanded",
                        mend="run `xacro file.xacro > file.urdf` first",
                        source=source,
                        line=element.sourceline,
                    )
    return root


def _parser(*, recover: bool = False) -> Any:
    return etree.XMLParser(
        resolve_entities=False,
        no_network=True,
        load_dtd=False,
        dtd_validation=False,
        huge_tree=False,
        remove_pis=True,
        recover=recover,
    )


def _only_namespaces(parser: Any) -> bool:
    """Whether undeclared prefixes are all that is wrong with what a parser read last."""
    # Of the parser: the log of the exception itself goes back to earlier documents.
    entries = [entry for entry in parser.error_log if entry.level_name != "WARNING"]
    return bool(entries) and all(entry.type_name == "NS_ERR_UNDEFINED_NAMESPACE" for entry in entries)


def _broken(error: Any, source: Path | None) -> InputError:
    line, column = error.position
    if "Excessive depth" in (error.msg or ""):
        return InputError(
            "elements are nested more than 256 deep", mend="write long chains as URDF or TOML", source=source
        )
    what = (error.msg or "cannot be parsed").partition(", line ")[0]
    mend = "save the file as UTF-8" if "encoding" in what else "mend the syntax"
    return InputError(f"broken XML: {what}", mend=mend, source=source, line=line or None, column=column or None)


def _without_default_namespace(root: Any) -> None:
    """Take the root's namespace, where it is the default one, off every element that is in it."""
    uri, _ = namespace_and_name(root)
    if not uri or root.prefix is not None:
        return
    for element in root.iter():
        its, name = namespace_and_name(element)
        if its == uri and element.prefix is None:
            element.tag = name
