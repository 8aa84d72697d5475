"""Closed mechanisms, balls and bodies in space of random sizes, each with one thing concealed or nothing, as MuJoCo moves them.

A family is a model in MuJoCo's own XML with a place for all that may be concealed, at nothing in what the diagnosis is given.
Dry friction and loops are stiff constraints there: with the usual time constants they give way by several times the noise.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import mujoco
import numpy as np
from numpy.typing import NDArray
from scipy.optimize import least_squares

from harness.recording import Channel, Recording
from harness.recording.recording import SPATIAL_UNITS
from harness.system.description import constant

Array = NDArray[np.float64]
Numbers = dict[str, float]

RATE, GRAVITY = 100.0, 9.81  # Hz, m/s²
NOISE = 5e-4  # rad or m; one for a quaternion's numbers
QUATERNION = ("qw", "qx", "qy", "qz")
HARD = 'solreffriction="0.0002 1" solimpfriction="0.9999 0.9999 0.001"'
CLOSED = 'solref="0.001 1" solimp="0.9999 0.9999 0.001"'
HEAD = (
    '<mujoco><option timestep="{step}" integrator="RK4" gravity="{gravity}"><flag contact="disable"/></option>'
    '<compiler angle="radian"/><worldbody>'
)
ROD = '<geom type="capsule" fromto="0 0 0 {end}" size="0.008" mass="{mass}"/>'


@dataclass(frozen=True)
class Concealed:
    """What a family may conceal: the effect and where, the place in its XML, and the number from a draw in 1 … 4."""

    effect: str
    site: str
    parameter: str
    place: str
    size: Callable[[Numbers, float], float]


@dataclass(frozen=True)
class Family:
    """Mechanisms of one kind.

    text: XML with places in braces. drawn: sizes by name from a generator. leading: joints whose angles are drawn, between what in
    each recording, with a guess of the others; none for bodies in space. seen: which joints are recorded. seconds: of a recording.
    """

    name: str
    text: str
    drawn: Callable[[np.random.Generator], Numbers]
    concealed: tuple[Concealed, ...]
    seen: tuple[str, ...]
    leading: Mapping[str, tuple[tuple[float, float], ...]]
    guess: Mapping[str, float]
    seconds: float
    recordings: int = 2


def joint(name: str, place: str, *, kind: str = "hinge", axis: str = "0 0 1") -> str:
    """A joint with a damping of its own, and dry friction."""
    return f'<joint name="{name}" type="{kind}" axis="{axis}" damping="{{{place}}}" frictionloss="{{{place}_dry}}" {HARD}/>'


def _weight(numbers: Numbers, reach: float) -> float:
    return numbers["mass"] * GRAVITY * reach


def damped(site: str, place: str, reach: str) -> Concealed:
    """Damping that takes one to four hundredths of the weight's torque at a natural speed."""
    return Concealed(
        "viscous_damping", site, "coefficient", place,
        lambda n, d: 0.01 * d * _weight(n, n[reach]) * np.sqrt(n[reach] / GRAVITY),
    )  # fmt: skip


def rubbing(site: str, place: str, reach: str) -> Concealed:
    """Dry friction of one to four hundredths of the weight's torque."""
    return Concealed("coulomb_friction", site, "torque", f"{place}_dry", lambda n, d: 0.01 * d * _weight(n, n[reach]))


def _four_bar(random: np.random.Generator) -> Numbers:
    crank = random.uniform(0.1, 0.3)
    base, coupler, rocker = crank * random.uniform(1.5, 1.8), crank * random.uniform(1.7, 2.1), crank * 1.4
    return {"mass": random.uniform(0.2, 1.0), "crank": crank, "base": base, "coupler": coupler, "rocker": rocker}


def _slider(random: np.random.Generator) -> Numbers:
    crank = random.uniform(0.08, 0.25)
    return {
        "mass": random.uniform(0.2, 1.0), "crank": crank, "rod": crank * random.uniform(2.2, 3.5), "height": 0.1 * crank,
    }  # fmt: skip


def _five_bar(random: np.random.Generator) -> Numbers:
    crank = random.uniform(0.12, 0.25)
    return {
        "mass": random.uniform(0.2, 0.6), "crank": crank, "base": crank * random.uniform(1.7, 2.1),
        "rod": crank * random.uniform(1.5, 1.8),
    }  # fmt: skip


def _trammel(random: np.random.Generator) -> Numbers:
    return {"mass": random.uniform(0.1, 0.4), "rod": random.uniform(0.2, 0.5)}


def _bob(random: np.random.Generator) -> Numbers:
    reach = random.uniform(0.2, 0.6)
    return {"mass": random.uniform(0.3, 1.5), "reach": reach, "beside": 0.1 * reach}


def _body(random: np.random.Generator) -> Numbers:
    size = random.uniform(0.08, 0.2)
    return {"mass": random.uniform(1.0, 4.0), "long": size, "wide": 0.7 * size, "high": 0.5 * size}


PLANE = HEAD.format(step="0.0001", gravity=f"0 -{GRAVITY} 0")
SPACE = HEAD.format(step="0.0005", gravity=f"0 0 -{GRAVITY}")


def _meeting(name: str) -> str:
    return f'<equality><connect name="{name}" site1="a" site2="b" {CLOSED}/></equality></mujoco>'


FAMILIES = (
    Family(
        "four-bar",
        PLANE
        + f'<body name="short">{joint("crank", "crank_joint")}{ROD.format(end="{crank} 0 0", mass="{mass}")}'
        + f'<body name="coupler" pos="{{crank}} 0 0">{joint("pin", "pin")}{ROD.format(end="{coupler} 0 0", mass="{mass}")}'
        + '<site name="a" pos="{coupler} 0 0"/></body></body>'
        + f'<body name="long" pos="{{base}} 0 0">{joint("rocker", "rocker_joint")}'
        + ROD.format(end="0 -{rocker} 0", mass="{mass}")
        + '<site name="b" pos="0 -{rocker} 0"/></body></worldbody>'
        + _meeting("knee"),
        _four_bar,
        (
            damped("crank", "crank_joint", "crank"), damped("pin", "pin", "crank"),
            damped("rocker", "rocker_joint", "rocker"), rubbing("rocker", "rocker_joint", "rocker"),
        ),
        ("crank",), {"crank": ((-2.6, -2.1), (-0.9, -0.4))}, {"pin": -1.0, "rocker": 0.3}, 4.0,
    ),
    Family(
        "slider-crank",
        HEAD.format(step="0.0001", gravity=f"0 0 -{GRAVITY}")
        + f'<body name="short">{joint("crank", "crank_joint", axis="0 1 0")}{ROD.format(end="{crank} 0 0", mass="{mass}")}'
        + f'<body name="rod" pos="{{crank}} 0 0">{joint("pin", "pin", axis="0 1 0")}'
        + ROD.format(end="{rod} 0 0", mass="{mass}")
        + '<site name="a" pos="{rod} 0 0"/></body></body>'
        + f'<body name="piston" pos="0 0 {{height}}">{joint("slide", "slide", kind="slide", axis="1 0 0")}'
        + '<geom type="box" size="0.02 0.02 0.02" mass="{mass}"/><site name="b"/></body></worldbody>'
        + _meeting("wrist"),
        _slider,
        (
            damped("crank", "crank_joint", "crank"), damped("pin", "pin", "crank"),
            Concealed("coulomb_friction", "slide", "torque", "slide_dry", lambda n, d: 0.01 * d * _weight(n, 1.0)),
        ),
        ("crank",), {"crank": ((0.6, 1.1), (2.1, 2.6))}, {"pin": -1.3, "slide": 0.3}, 4.0,
    ),
    Family(
        "five-bar",
        PLANE
        + f'<body name="one">{joint("left", "left")}{ROD.format(end="{crank} 0 0", mass="{mass}")}'
        + f'<body name="two" pos="{{crank}} 0 0">{joint("elbow", "elbow")}{ROD.format(end="{rod} 0 0", mass="{mass}")}'
        + '<site name="a" pos="{rod} 0 0"/></body></body>'
        + f'<body name="three" pos="{{base}} 0 0">{joint("right", "right")}{ROD.format(end="{crank} 0 0", mass="{mass}")}'
        + f'<body name="four" pos="{{crank}} 0 0">{joint("other", "other")}{ROD.format(end="{rod} 0 0", mass="{mass}")}'
        + '<site name="b" pos="{rod} 0 0"/></body></body></worldbody>'
        + _meeting("tip"),
        _five_bar,
        (
            damped("elbow", "elbow", "crank"), damped("other", "other", "crank"), damped("right", "right", "crank"),
            rubbing("elbow", "elbow", "crank"),
        ),
        ("left", "right"),
        {"left": ((-2.2, -1.9), (-1.4, -1.1), (-2.0, -1.7)), "right": ((-1.9, -1.6), (-1.0, -0.7), (-1.4, -1.1))},
        {"elbow": 0.9, "other": -0.9}, 3.0, 3,
    ),
    Family(
        "trammel",
        PLANE
        + f'<body name="cart">{joint("across", "across", kind="slide", axis="1 0 0")}'
        + '<geom type="box" size="0.02 0.02 0.02" mass="{mass}"/>'
        + f'<body name="rod">{joint("hinge", "hinge")}{ROD.format(end="{rod} 0 0", mass="{mass}")}'
        + '<site name="a" pos="{rod} 0 0"/></body></body>'
        + f'<body name="lift">{joint("upward", "upward", kind="slide", axis="0 1 0")}'
        + '<geom type="box" size="0.02 0.02 0.02" mass="{mass}"/><site name="b"/></body></worldbody>'
        + _meeting("pinch"),
        _trammel,
        (
            damped("hinge", "hinge", "rod"),
            Concealed(
                "viscous_damping", "upward", "coefficient", "upward",
                lambda n, d: 0.01 * d * _weight(n, 1.0) / np.sqrt(GRAVITY * n["rod"]),
            ),
        ),
        ("across", "upward"), {"hinge": ((-2.5, -2.1), (-1.1, -0.7))}, {"across": 0.1, "upward": -0.3}, 4.0,
    ),
    Family(
        "ball pendulum",
        SPACE
        + '<body name="bob" pos="0 0 1"><joint name="ball" type="ball" damping="{ball}"/>'
        + ROD.format(end="0 {beside} -{reach}", mass="{mass}")
        + '<geom type="box" pos="{beside} 0 -{reach}" size="0.05 0.02 0.03" mass="{mass}"/></body></worldbody></mujoco>',
        _bob,
        (damped("ball", "ball", "reach"),),
        ("ball",), {}, {}, 5.0,
    ),
    Family(
        "thrown body",
        SPACE
        + '<body name="body" pos="0 0 1"><joint name="root" type="free" damping="{root}"/>'
        + '<geom type="box" pos="{off} 0 0" size="{long} {wide} {high}" mass="{mass}"/></body></worldbody></mujoco>',
        _body,
        (
            Concealed("com_displacement", "body", "x", "off", lambda n, d: 0.02 * d * n["long"]),
            Concealed("viscous_damping", "root.shift", "coefficient", "root", lambda n, d: 0.01 * d * n["mass"]),
        ),
        ("root",), {}, {}, 1.5, 3,
    ),
)  # fmt: skip


def written(family: Family, numbers: Numbers, hidden: Mapping[str, float]) -> str:
    """The XML of a member of the family with something concealed, or nothing."""
    text = family.text
    for name, value in {**numbers, **hidden}.items():
        text = text.replace(f"{{{name}}}", f"{value:.12g}")
    while "{" in text:
        place = text[text.index("{") : text.index("}") + 1]
        text = text.replace(place, "0")
    return text


def recorded(family: Family, text: str, random: np.random.Generator) -> list[Recording]:
    """Recordings of the family's joints or poses, let go or thrown."""
    model = mujoco.MjModel.from_xml_string(text)
    names = [model.joint(k).name for k in range(model.njnt)]
    out = []
    for k in range(family.recordings):
        data = mujoco.MjData(model)
        if family.leading:
            angles = {name: random.uniform(*between[k]) for name, between in family.leading.items()}
            data.qpos[:] = _assembled(model, data, names, angles, family.guess)
        elif model.nq == 7:
            data.qvel[:] = [*random.uniform(-1.0, 1.0, 2), random.uniform(5.0, 7.0), *random.normal(size=3) * 3.0]
        else:
            turned = np.array([1.0, *random.uniform(-0.6, 0.6, 3)])
            data.qpos[:], data.qvel[:] = turned / np.linalg.norm(turned), random.normal(size=3) * 2.0
        found = _run(model, data, family.seconds)
        time = np.arange(len(found)) / RATE
        channels = []
        for site, quantity, column in _columns(family, names, model.nq):
            values = found[:, column] + NOISE * random.normal(size=len(time))
            unit = SPATIAL_UNITS.get(quantity) or ("m" if _slides(model, site) else "rad")
            channels.append(Channel(f"{site}.{quantity}", site, quantity, unit, constant(values)))
        out.append(Recording(f"run{k}", f"run{k}", constant(time), tuple(channels)))
    return out


def _slides(model: mujoco.MjModel, name: str) -> bool:
    return int(model.joint(name).type[0]) == int(mujoco.mjtJoint.mjJNT_SLIDE)


def _columns(family: Family, names: Sequence[str], nq: int) -> list[tuple[str, str, int]]:
    """What is recorded: site, quantity, place among the positions."""
    if family.leading:
        return [(name, "position", names.index(name)) for name in family.seen]
    kind, axes = ("pose", ("x", "y", "z", *QUATERNION)) if nq == 7 else ("position", QUATERNION)
    return [(family.seen[0], f"{kind}.{axis}", column) for column, axis in enumerate(axes)]


def _assembled(
    model: mujoco.MjModel,
    data: mujoco.MjData,
    names: Sequence[str],
    angles: Mapping[str, float],
    guess: Mapping[str, float],
) -> Array:
    """Positions at which the two sites of the loop meet, from a guess of the joints that do not lead."""
    free = [k for k, name in enumerate(names) if name not in angles]

    def apart(z: Array) -> Array:
        for name, angle in angles.items():
            data.qpos[names.index(name)] = angle
        data.qpos[free] = z
        mujoco.mj_kinematics(model, data)
        return np.asarray(data.site("a").xpos - data.site("b").xpos)

    found = least_squares(apart, [guess[names[k]] for k in free], xtol=1e-15, ftol=1e-15, gtol=1e-15)
    if found.cost > 1e-18:
        raise ValueError(f"the mechanism does not close at {dict(angles)}")
    apart(found.x)
    return np.array(data.qpos)


def _run(model: mujoco.MjModel, data: mujoco.MjData, seconds: float) -> Array:
    steps, found = round(1.0 / RATE / model.opt.timestep), np.empty((round(seconds * RATE), model.nq))
    for row in found:
        row[:] = data.qpos
        mujoco.mj_step(model, data, nstep=steps)
    return found
