"""What a URDF says that would act in another tool and is not part of a system, one line each.

Sources: the URDF specification (http://wiki.ros.org/urdf/XML); Gazebo's extensions (SDFormat, "URDF in Gazebo"); Drake's
("Parsing model files": drake:rotor_inertia, drake:gear_ratio); MuJoCo's ("URDF extensions").
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from typing import Any

from harness.system.xml_source import prefix_and_name

_READ_OF_DYNAMICS = ("damping", "friction")
# Of Gazebo's blocks, what changes how joints or links move without any contact.
_GAZEBO_JOINT = {
    "springStiffness": "spring",
    "springReference": "rest position of its spring",
    "cfmDamping": "damping by CFM",
    "fudgeFactor": "fudge factor",
}
_GAZEBO_LINK = {
    "dampingFactor": "damping of its velocity",
    "velocityDecay": "damping of its velocity",
    "turnGravityOff": "gravity switched off",
    "gravity": "gravity switched off",
}
_ONCE = (
    "inertial", "mass", "inertia", "origin", "parent", "child", "axis", "limit", "dynamics", "mimic", "safety_controller",
)  # fmt: skip
_MOST_NAMED = 4


def rotor(actuator: Any) -> tuple[float, float]:
    """Gear ratio and rotor inertia [kg·m²] of a transmission's actuator as Drake writes them; 1 and 0 where absent."""
    gear, inertia = 1.0, 0.0
    for element in actuator:
        prefix, name = prefix_and_name(element)
        if prefix != "drake" or name not in ("gear_ratio", "rotor_inertia"):
            continue
        value = number(element.get("value"))
        gear, inertia = (value, inertia) if name == "gear_ratio" else (gear, value)
    return gear, inertia


def rotors(root: Any) -> Iterator[tuple[str, float, float]]:
    """Joint, gear ratio and rotor inertia [kg·m²] of every transmission with a rotor that has inertia."""
    for transmission in root.findall("transmission"):
        joints = [joint.get("name") or "" for joint in transmission.findall("joint")]
        for actuator in transmission.findall("actuator"):
            gear, inertia = rotor(actuator)
            if inertia != 0.0:
                yield from ((joint, gear, inertia) for joint in joints)


def springs(root: Any) -> Iterator[tuple[str, float, float]]:
    """Joint, stiffness and rest position of springs that Gazebo's blocks state; units of the joint."""
    for block in root.findall("gazebo"):
        stiffness = number(block.findtext("springStiffness"))
        if stiffness != 0.0:
            yield block.get("reference") or "", stiffness, number(block.findtext("springReference"))


def number(text: str | None) -> float:
    """A number, or zero for what is none: these fields are told, not relied upon."""
    try:
        return float(text or "")
    except ValueError:
        return 0.0


def left_out(root: Any, base: str) -> tuple[str, ...]:
    """What would act in Gazebo, Drake or MuJoCo, by joint and link."""
    return (*_twice(root), *_joints(root), *_rotors(root), *_gazebo(root), *_massless(root, base), *_foreign(root))


def _twice(root: Any) -> Iterator[str]:
    """Elements of which there may be one: here, as in urdfdom, the first counts; MuJoCo refuses such a file."""
    for owner in root:
        if owner.tag not in ("link", "joint"):
            continue
        for element in (owner, *owner.findall("inertial")):
            tags = [child.tag for child in element if child.tag in _ONCE]
            for tag in dict.fromkeys(tag for tag in tags if tags.count(tag) > 1):
                yield f"{owner.tag} {owner.get('name')!r}: of {tags.count(tag)} <{tag}> the first counts"


def _joints(root: Any) -> Iterator[str]:
    for joint in root.findall("joint"):
        dynamics = joint.find("dynamics")
        if dynamics is None:
            continue
        beyond = [f'{key}="{value}"' for key, value in dynamics.attrib.items() if key not in _READ_OF_DYNAMICS]
        if beyond:
            yield f"joint {joint.get('name')!r}: <dynamics {' '.join(beyond)}> is left out: not of URDF"


def _rotors(root: Any) -> Iterator[str]:
    for joint, gear, inertia in rotors(root):
        yield (
            f"joint {joint!r}: drake:rotor_inertia {inertia:g} kg·m² behind a gear of {gear:g} is left out: in Drake an "
            f"armature of {inertia * gear**2:g} kg·m²"
        )


def _gazebo(root: Any) -> Iterator[str]:
    joints = {joint.get("name") for joint in root.findall("joint")}
    for block in root.findall("gazebo"):
        of = block.get("reference")
        kind, known = ("joint", _GAZEBO_JOINT) if of in joints else ("link", _GAZEBO_LINK)
        said = []
        for element in block:
            name = prefix_and_name(element)[1]
            text = " ".join((element.text or "").split())
            if name not in known:
                continue
            if name in ("turnGravityOff", "gravity") and (text.lower() in ("true", "1")) != (name == "turnGravityOff"):
                continue
            said.append(f"{known[name]} (<{name}> {text})")
        if said:
            yield f"{kind} {of!r}: Gazebo's {', '.join(said)} left out"
        plugins = [element.get("name") or element.get("filename") or "" for element in block.iter("plugin")]
        if plugins:
            yield f"Gazebo's plugin(s) {_some(plugins)} left out"


def _massless(root: Any, base: str) -> Iterator[str]:
    shaped = [
        str(link.get("name"))
        for link in root.findall("link")
        if link.find("inertial") is None and link.find("collision") is not None and link.get("name") != base
    ]
    if shaped:
        yield (
            f"link(s) {_some(shaped)}: geometry without <inertial>, massless here as in Pinocchio; MuJoCo takes mass from "
            "the collision geometry"
        )


def _foreign(root: Any) -> Iterator[str]:
    if root.find("mujoco") is not None:
        yield "the <mujoco> block is left out: it changes how MuJoCo alone reads the file"
    found: dict[str, int] = {}
    for element in (child for top in root if _tells(top) for child in (top, *top)):
        prefix, name = prefix_and_name(element)
        if prefix and name not in ("gear_ratio", "rotor_inertia"):
            found[f"{prefix}:{name}"] = found.get(f"{prefix}:{name}", 0) + 1
    for name, count in found.items():
        yield f"<{name}> left out" + (f", {count} times" if count > 1 else "")


def _tells(element: Any) -> bool:
    """Whether an element below <robot> can hold something that acts; materials cannot."""
    return isinstance(element.tag, str) and element.tag not in ("material", "sensor")


def _some(names: Iterable[str]) -> str:
    listed = list(names)
    text = ", ".join(repr(name) for name in listed[:_MOST_NAMED])
    return text + (f" and {len(listed) - _MOST_NAMED} more" if len(listed) > _MOST_NAMED else "")
