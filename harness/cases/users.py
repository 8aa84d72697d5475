"""A user's own model as a case: the quantities of the suite at random states."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from harness.cases.case import Case, Check, Doubt
from harness.cases.checks import StateAgreement
from harness.cases.checks.as_read import AsRead
from harness.cases.tolerances import acceleration_allowed
from harness.cases.user_beams import beam_checks, comparable, straight_checks
from harness.engines.attached import check_attached
from harness.engines.expressed import realised
from harness.errors import InputError
from harness.system import System, load
from harness.system.audit import audit


def read(path: Path, *, physical: bool = True, allow: Sequence[Path] = (), floating: bool = False) -> System:
    """The model; InputError if it cannot be read, has no joint that moves, or an effect attached that cannot act.

    physical: refuse inertia that no body can have. allow: folders beside its own that it may name files in.
    floating: let the root link of a URDF float.
    """
    system = load(path, physical=physical, allow=allow, floating=floating)
    if not system.coordinate_names:
        raise InputError("no joint moves", source=path, mend="give a mechanism with a revolute or prismatic joint")
    check_attached(system)
    return system


def names_of(paths: Sequence[Path]) -> dict[str, Path]:
    """One name a model: the file's stem, with as many folders before it as make it unique."""
    names: dict[str, Path] = {}
    unique = list(dict.fromkeys(path.resolve() for path in paths))
    for path in unique:
        depth = 1
        parts = path.with_suffix("").parts
        while depth < len(parts) and any(
            other != path and other.with_suffix("").parts[-depth:] == parts[-depth:] for other in unique
        ):
            depth += 1
        name = "/".join(parts[-depth:])
        # The same stem with another ending (robot.urdf, robot.xml): the ending tells them apart.
        names[name if name not in names else name + path.suffix] = path
    return names


def case_of(
    name: str, path: Path, *, physical: bool = True, allow: tuple[Path, ...] = (), floating: bool = False
) -> Case:
    """The case of one model file."""
    system, left_out = comparable(realised(read(path, physical=physical, allow=allow, floating=floating)))
    checks = (*beam_checks(system, left_out), *straight_checks(system)) or state_checks(len(system.coordinate_names))
    return Case(
        name=name,
        title=f"{system.name} ({path.name})" + (f", {left_out}" if left_out else ""),
        source=str(path),
        system=lambda: system,
        checks=(*checks, AsRead(path, allow)),
        group="models",
    )


def doubts(name: str, path: Path, *, allow: Sequence[Path] = (), floating: bool = False) -> tuple[Doubt, ...]:
    """What an audit finds impossible or implausible in a model: engines agree on such numbers as on any."""
    found = audit(read(path, physical=False, allow=allow, floating=floating)).findings
    return tuple(Doubt(name, f.severity, f.site, f.what) for f in found if f.severity != "note")


def state_checks(n: int, states: int = 8) -> tuple[Check, ...]:
    """Acceleration, inverse dynamics, mass matrix, bias, gravity and energy of a mechanism with n coordinates."""
    allowed, why = acceleration_allowed(n)
    exact = "one pass over the links without division: rounding of double precision, twenty times over"
    return (
        StateAgreement("acceleration", allowed, why, states, conditioned=True),
        StateAgreement("inverse_dynamics", 1e-12 if n <= 50 else 1e-11, exact, states),
        StateAgreement("mass_matrix", 1e-12 if n <= 50 else 1e-11, exact, states, conditioned=True),
        StateAgreement("bias", 1e-12 if n <= 50 else 1e-11, exact, states),
        StateAgreement("gravity", 1e-12 if n <= 50 else 1e-11, exact, states),
        StateAgreement("energy", 1e-12 if n <= 50 else 1e-11, exact, states),
    )
