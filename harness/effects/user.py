"""A user's own effect: a Python file with a name, parameters and a torque, used like any of the catalogue."""

from __future__ import annotations

import importlib.util
import inspect
import re
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from types import ModuleType
from typing import Any

import numpy as np

from harness.effects.catalogue import catalogue, register
from harness.effects.effect import Effect, Family, Parameter, SiteKind, UserLaw
from harness.effects.lanes import USER_PARAMETERS
from harness.effects.scale import Scale
from harness.errors import InputError

ARGUMENTS = ("position", "velocity", "time", "p")
KEYS = ("unit", "what", "lower", "upper", "scale", "starts", "neutral")


def load_user_effects(path: str | Path) -> tuple[Effect, ...]:
    """Effects that a Python file defines.

    The file states ``name``, ``parameters`` (by name: ``unit``, and optionally ``what``, ``lower``, ``upper``, ``scale``,
    ``starts``, ``neutral``, all SI) and ``def torque(position, velocity, time, p)``, which returns the torque [N·m or N]
    on the joint; ``p`` holds the parameters in the order given. Optional: ``title``, ``signature``, ``source``,
    ``confusable_with``. Several effects in one file are classes with these members. The torque is compiled by numba:
    arithmetic and the ``math`` module. From then on a model that has such an effect attached can be simulated.
    Raises InputError, naming file and line, for what is missing or cannot be compiled.
    """
    file = Path(path)
    module = _run(file)
    holders: list[Any] = [module] if hasattr(module, "torque") else []
    holders += [
        value for value in vars(module).values() if inspect.isclass(value) and value.__module__ == module.__name__
    ]
    if not holders:
        raise InputError(
            "defines no effect", mend="state name, parameters and def torque(position, velocity, time, p)", source=file
        )
    effects = tuple(_effect(holder, file) for holder in holders)
    names = [effect.name for effect in effects]
    for name in names:
        if names.count(name) > 1:
            raise InputError(f"defines two effects named {name!r}", mend="rename one", source=file)
    register(effects)
    return effects


def _run(file: Path) -> ModuleType:
    if not file.is_file():
        raise InputError("no such file", mend="check the path", source=file)
    spec = importlib.util.spec_from_file_location("denoc_user_" + re.sub(r"\W", "_", file.stem), file)
    if spec is None or spec.loader is None:
        raise InputError("is no Python file", mend="its name must end in .py", source=file)
    module = importlib.util.module_from_spec(spec)
    try:
        spec.loader.exec_module(module)
    except SyntaxError as failure:
        raise InputError(f"is not valid Python: {failure.msg}", source=file, line=failure.lineno) from None
    except Exception as failure:  # whatever the user's file does when it runs
        line = _line_in(failure, file)
        raise InputError(f"{type(failure).__name__}: {failure}", mend="mend the file", source=file, line=line) from None
    return module


def _line_in(failure: BaseException, file: Path) -> int | None:
    line = None
    trace = failure.__traceback__
    while trace is not None:
        if trace.tb_frame.f_code.co_filename == str(file):
            line = trace.tb_lineno
        trace = trace.tb_next
    return line


def _effect(holder: Any, file: Path) -> Effect:
    name = getattr(holder, "name", None)
    if not isinstance(name, str) or not re.fullmatch(r"[a-z][a-z0-9_]*", name):
        raise InputError(
            "an effect needs a name", mend='name = "magnet", lower-case letters, digits and underscores', source=file
        )
    if name in catalogue():
        raise InputError(f"{name!r} is an effect of the catalogue already", mend="choose another name", source=file)
    torque = inspect.getattr_static(holder, "torque", None)
    torque = torque.__func__ if isinstance(torque, staticmethod) else torque
    if not inspect.isfunction(torque):
        raise InputError(f"{name!r} has no torque", mend="def torque(position, velocity, time, p): …", source=file)
    given = getattr(holder, "parameters", None)
    if not isinstance(given, Mapping) or not given:
        raise InputError(
            f"{name!r} states no parameters", mend='parameters = {"strength": {"unit": "N*m"}}', source=file
        )
    if len(given) > USER_PARAMETERS:
        raise InputError(f"{name!r} has {len(given)} parameters", mend=f"at most {USER_PARAMETERS}", source=file)
    parameters = tuple(_parameter(name, key, facts, file) for key, facts in given.items())
    _check_torque(name, torque, parameters, file)
    confusable: Sequence[str] = getattr(holder, "confusable_with", ())
    return Effect(
        name=name,
        title=str(getattr(holder, "title", name.replace("_", " "))),
        family=Family.STIFFNESS,
        site=SiteKind.JOINT,
        parameters=parameters,
        signature=str(getattr(holder, "signature", f"stated by the user in {file.name}")),
        shows_in=str(getattr(holder, "shows_in", "motion on which its torque acts")),
        source=str(getattr(holder, "source", file.name)),
        expressed_by={"denoc": "the user's own joint law"},
        needs=("motion",),
        confusable_with=tuple(confusable),
        user=UserLaw(torque),
    )


def _parameter(effect: str, name: Any, facts: Any, file: Path) -> Parameter:
    place = f"{effect!r}, parameter {name!r}"
    if not isinstance(name, str) or not name.isidentifier():
        raise InputError(f"{place}: is no name", mend="letters, digits and underscores", source=file)
    if not isinstance(facts, Mapping) or not isinstance(facts.get("unit"), str):
        raise InputError(f"{place}: states no unit", mend='{"unit": "N*m"}; "1" if it has none', source=file)
    for key in facts:
        if key not in KEYS:
            raise InputError(f"{place}: {key!r} is unknown", mend=f"known: {', '.join(KEYS)}", source=file)
    lower, upper = float(facts.get("lower", -np.inf)), float(facts.get("upper", np.inf))
    if not lower < upper:
        raise InputError(f"{place}: lower {lower:g} is not below upper {upper:g}", mend="exchange them", source=file)
    scale = float(facts.get("scale", 1.0))
    if not (np.isfinite(scale) and scale > 0.0):
        raise InputError(f"{place}: scale {scale:g} is no size", mend="give a typical positive value", source=file)
    neutral = float(facts.get("neutral", 0.0))
    starts = tuple(float(s) for s in facts.get("starts", (neutral + scale,)))
    for start in starts:
        if not lower <= start <= upper:
            raise InputError(f"{place}: start {start:g} lies outside its bounds", mend="move it inside", source=file)
    return Parameter(
        name,
        facts["unit"],
        str(facts.get("what", "")),
        lower=lower,
        upper=upper,
        scale=Scale(scale),
        starts=tuple((start - neutral) / scale for start in starts),
        neutral=neutral,
    )


def _check_torque(name: str, torque: Callable[..., float], parameters: Sequence[Parameter], file: Path) -> None:
    """Refuse a torque of other arguments, one that does not compile, and one that gives no finite number."""
    line = torque.__code__.co_firstlineno
    if len(inspect.signature(torque).parameters) != len(ARGUMENTS):
        raise InputError(
            f"torque of {name!r} takes {', '.join(inspect.signature(torque).parameters) or 'nothing'}",
            mend=f"it must take {', '.join(ARGUMENTS)}",
            source=file,
            line=line,
        )
    from numba import njit
    from numba.core.errors import NumbaError

    start = np.zeros(USER_PARAMETERS)
    for k, parameter in enumerate(parameters):
        start[k] = np.clip(
            parameter.neutral + parameter.starts[0] * parameter.scale.factor, parameter.lower, parameter.upper
        )
    try:
        value = njit(torque)(0.1, -0.2, 0.3, start)
    except NumbaError as failure:
        reason = next((row.strip() for row in str(failure).splitlines() if row.strip()), "")
        for row in str(failure).splitlines():
            if any(word in row for word in ("NameError", "not defined", "Unknown attribute", "Invalid use", "cannot")):
                reason = row.strip()
                break
        raise InputError(
            f"torque of {name!r} cannot be compiled: {reason[:160]}",
            mend="use arithmetic, if, and the math module only",
            source=file,
            line=line,
        ) from None
    except Exception as failure:  # what the user's own formula does, division by zero for one
        raise InputError(
            f"torque of {name!r}: {type(failure).__name__}: {failure}", mend="mend the formula", source=file, line=line
        ) from None
    if isinstance(value, bool) or not isinstance(value, int | float) or not np.isfinite(value):
        raise InputError(
            f"torque of {name!r} gives {value!r} at position 0.1, velocity −0.2, time 0.3",
            mend="it must give a finite number",
            source=file,
            line=line,
        )
