"""Files that an MJCF document names: which may be opened, and which are needed for the motion at all.

Includes say what the model is; they may lie in the model's folder and in folders that the user allows. Meshes, height fields,
textures and skins are shapes: they are read only where a body takes its mass from them, so that a model whose folder of meshes
is elsewhere is read all the same.
"""

from __future__ import annotations

from collections.abc import Collection, Iterator, Sequence
from dataclasses import dataclass
from math import isfinite
from pathlib import Path
from typing import Any

from harness.errors import InputError
from harness.system.magnitudes import NUMBER
from harness.system.xml_source import parse_xml

_FOLDERS = ("meshdir", "texturedir", "assetdir")
# Elements whose file MuJoCo opens only when it compiles, so that they can be taken out before.
_SHAPES = ("mesh", "texture", "hfield", "skin")
_MOST_NAMED = 4
# Where things are and how they are turned: of numbers whose squares overflow MuJoCo makes no direction, and says nothing.
_FRAMES = ("pos", "axis", "quat", "axisangle", "xyaxes", "zaxis", "euler", "fromto", "ref")
# What masses and inertias are computed from.
_AMOUNTS = ("size", "mass", "density", "diaginertia", "fullinertia")


@dataclass(frozen=True)
class Places:
    """Folders that files may lie in, those that relative names may be meant from, and elements of the document and its includes."""

    allowed: tuple[Path, ...]
    meant_from: frozenset[Path]
    elements: frozenset[str] = frozenset()

    def may_open(self, target: Path) -> bool:
        return any(target.is_relative_to(folder) for folder in self.allowed)

    def readable(self, name: str) -> bool:
        """Whether the name is of an existing file, and cannot be of one outside the allowed folders."""
        targets = [(place / name).resolve() for place in self.meant_from]
        return all(self.may_open(target) for target in targets) and any(target.is_file() for target in targets)


def places(root: Any, source: Path | None, allow: Sequence[Path] = ()) -> Places:
    """Folders that matter to a document.

    Raises InputError for an include or model that lies outside those allowed, and for places and directions beyond any mechanism.
    """
    folder = (source.parent if source is not None else Path.cwd()).resolve()
    allowed = (folder, *(path.resolve() for path in allow))
    meant_from: set[Path] = set()
    elements: set[str] = set()
    _walk(root, source, folder, allowed, meant_from, elements, set())
    return Places(allowed, frozenset(meant_from), frozenset(elements))


def _walk(
    root: Any,
    source: Path | None,
    here: Path,
    allowed: tuple[Path, ...],
    meant_from: set[Path],
    elements: set[str],
    seen: set[Path],
) -> None:
    around = {here, allowed[0]}
    for compiler in root.iter("compiler"):
        for key in _FOLDERS:
            if compiler.get(key):
                around |= {(place / compiler.get(key)).resolve() for place in tuple(around)}
    meant_from |= around
    for element in root.iter():
        if not isinstance(element.tag, str):
            continue
        elements.add(element.tag)
        _refuse_boundless(element, source)
        if element.tag in _SHAPES:
            continue
        named = [value for key, value in element.attrib.items() if key.startswith("file") and value]
        for target in ((place / name).resolve() for name in named for place in around):
            if not any(target.is_relative_to(folder) for folder in allowed):
                raise InputError(
                    f"<{element.tag}> names {named[0]!r}, which lies outside the model's folder",
                    mend="move it under the folder of the model, or allow its folder with --allow-path",
                    source=source,
                    line=element.sourceline,
                )
            # Includes, and whole models attached as assets, may name files in their turn.
            if element.tag in ("include", "model") and target.is_file() and target not in seen:
                seen.add(target)
                _walk(
                    parse_xml(target.read_bytes(), target), target, target.parent, allowed, meant_from, elements, seen
                )


def _refuse_boundless(element: Any, source: Path | None) -> None:
    """Refuse a place, a direction or a mass of numbers beyond any mechanism, and of what is no number."""
    for key in (*_FRAMES, *_AMOUNTS):
        for word in element.get(key, "").split():
            try:
                number = float(word)
            except ValueError:  # MuJoCo says so
                continue
            if not abs(number) <= NUMBER:
                said = "is NaN or infinite" if not isfinite(number) else f"of {number:.3g} is beyond any mechanism"
                raise InputError(
                    f"<{element.tag}>: {key} {said}",
                    mend="check the number and its unit",
                    source=source,
                    line=element.sourceline,
                )


def take_out_shapes(mujoco: Any, spec: Any, known: Places, source: Path | None) -> list[str]:
    """Take shapes that cannot be read out of a specification before it is compiled; tells which.

    A geom whose mesh is taken out becomes a small sphere, so that what refers to it still finds it.
    Raises InputError where a moving body would take its mass from one of them.
    """
    meshes = {mesh.name: mesh for mesh in spec.meshes if mesh.file and not known.readable(mesh.file)}
    fields = {field.name: field for field in spec.hfields if field.file and not known.readable(field.file)}
    for geom in spec.geoms:
        gone = meshes.get(geom.meshname) if geom.meshname else fields.get(geom.hfieldname) if geom.hfieldname else None
        if gone is None:
            continue
        if _gives_mass(mujoco, spec, geom):
            name = geom.parent.name or "without name"
            raise InputError(
                f"body {name!r} takes its mass from the mesh {gone.file!r}, which "
                + _why_not(gone.file, known)
                + f" (folder {spec.meshdir!r})" * bool(spec.meshdir),
                mend="allow its folder with --allow-path DIR, or give the body an <inertial>",
                source=source,
            )
        geom.type = mujoco.mjtGeom.mjGEOM_SPHERE
        geom.meshname, geom.hfieldname, geom.size = "", "", [0.01, 0.0, 0.0]
    # Nothing moves otherwise for a texture; one that is painted takes the memory that its size asks for.
    textures = list(spec.textures)
    skins = [skin for skin in spec.skins if skin.file and not known.readable(skin.file)]
    for material in spec.materials:
        if textures:
            material.textures = [""] * len(list(material.textures))
    told = [Path(shape.file).name for shape in (*meshes.values(), *fields.values(), *skins)]
    for element in (*meshes.values(), *fields.values(), *textures, *skins):
        spec.delete(element)
    if not told:
        return []
    listed = ", ".join(told[:_MOST_NAMED]) + (f" and {len(told) - _MOST_NAMED} more" * (len(told) > _MOST_NAMED))
    return [
        f"{len(told)} shape(s) not read ({listed}): missing or outside the model's folder, and no body's mass is theirs"
    ]


def _why_not(name: str, known: Places) -> str:
    targets = [(place / name).resolve() for place in known.meant_from]
    return "is not there" if all(known.may_open(target) for target in targets) else "lies outside the model's folder"


def _gives_mass(mujoco: Any, spec: Any, geom: Any) -> bool:
    """Whether a geom's shape decides about the inertia of a body that can move."""
    rule = mujoco.mjtInertiaFromGeom(spec.compiler.inertiafromgeom)
    low, high = spec.compiler.inertiagrouprange
    if rule == mujoco.mjtInertiaFromGeom.mjINERTIAFROMGEOM_FALSE or not low <= geom.group <= high:
        return False
    if rule == mujoco.mjtInertiaFromGeom.mjINERTIAFROMGEOM_AUTO and geom.parent.explicitinertial:
        return False
    if geom.mass == 0.0 or (geom.mass != geom.mass and geom.density == 0.0):
        return False
    return any(body.joints for body in _up(geom.parent))


def _up(body: Any) -> Iterator[Any]:
    while body is not None and body.name != "world":
        yield body
        body = body.parent


def unique(name: str, taken: Collection[str]) -> str:
    """The name, with as many underscores behind it as set it apart from those taken."""
    while name in taken:
        name += "_"
    return name
