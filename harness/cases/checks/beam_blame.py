"""What of a beam is to blame where its frequencies or its motion leave the line."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from typing import Any

import numpy as np

from harness.cases.case import NATIVE, Array, Bench
from harness.compare import linearization
from harness.compare.beam_numbers import explain, place_of, sentence, squares
from harness.compare.spectrum import match_modes
from harness.denoc import Denoc
from harness.system import System
from harness.system.description import constant

Blame = tuple[str, dict[str, object] | None]


def by_frequencies(
    system: System,
    other: str,
    true: Array,
    ratios: Mapping[int, float],
    *,
    mode: int | None = None,
    at: Array | None = None,
    weightless: Mapping[float, float] | None = None,
) -> Blame:
    """The number that the ratios of found to true frequencies, by mode, would come of.

    other: who found them; mode: the worst one, counted from 0; at: the state they are about, zero if None. weightless: ratios
    without gravity, by the native frequency [Hz]; they part what stiffens under weight from what is stiff or heavy. With one
    frequency alone anything explains it, and nothing is named.
    """
    place: dict[str, object] = {} if mode is None else {"mode": mode + 1}
    chosen = sorted(ratios)
    start = np.zeros(len(system.coordinate_names)) if at is None else at
    if other == NATIVE and (told := by_linearization(system, start)):
        return told, place | {"term": "linearization"}
    own = _frequencies(system, start)
    pairs = dict(match_modes(np.asarray(true), own))
    chosen = [k for k in chosen if k in pairs]
    also = weightless or {}
    if len(chosen) + len(also) < 2:
        return "", place or None
    where = [pairs[k] for k in chosen]
    floating = _frequencies(afloat(system), start) if also else np.zeros(0)
    there = [int(np.abs(floating - frequency).argmin()) for frequency in also]

    def answer(of: System) -> Array:
        values = _frequencies(of, start)[where]
        return np.log(np.append(values, _frequencies(afloat(of), start)[there] if there else ()))

    apart = np.log([*(ratios[k] for k in chosen), *also.values()])
    # Our own beams differ from a truth by what is wrong alone, finite elements by what they leave out too.
    found = explain(system, answer, apart, squares, left=1e-2 if other == NATIVE else 1e-1)
    if not found:
        bent = [link.name for link in system.links if link.flexible]
        place |= {"term": "shapes"} | ({"link": bent[0]} if len(bent) == 1 else {})
        return "no one number of the description explains all modes: shapes, stiffening or how it is mounted", place
    return sentence(found, other), place | place_of(found)


def by_linearization(system: System, q: Array, qd: Array | None = None) -> str:
    """Said where the native frequencies are of other derivatives than the native forces have; empty where they are of these."""
    model = Denoc(system)
    if not linearization.astray(model, np.asarray(q, dtype=np.float64), np.zeros(model.n) if qd is None else qd):
        return ""
    return "its forces are linearized wrongly: small motion is of another derivative than theirs"


def afloat(system: System) -> System:
    """The system without gravity."""
    return replace(system, gravity=constant(np.zeros(3)))


def _frequencies(system: System, start: Array) -> Array:
    """Of the native dynamics [Hz]."""
    return np.asarray(Denoc(system).frequencies(start))


def by_forces(bench: Bench, name: str, q: Array, qd: Array) -> tuple[str, dict[str, object]]:
    """The number that forces of an engine at some states, (B, n), would come of."""
    rng = np.random.default_rng(bench.seed)
    qdd = rng.standard_normal(qd.shape)
    ours, theirs = bench.models[NATIVE], bench.models[name]
    # In the norm of the masses, so that forces on joints and on modes count alike.
    scale = np.array([1.0 / np.sqrt(np.diagonal(theirs.mass_matrix(x))) for x in q])

    def forces(model: Any) -> Array:
        found = [np.asarray(model.inverse_dynamics(*state)) for state in zip(q, qd, qdd, strict=True)]
        return np.asarray(np.array(found) * scale).ravel()

    found = explain(bench.system, lambda of: forces(Denoc(of)), forces(theirs) - forces(ours))
    return (sentence(found, name), place_of(found)) if found else ("", {})


def by_motion(system: System, other: str, answer: Callable[[System], Array], apart: Array) -> Blame:
    """The number that a difference of two motions would come of."""
    found = explain(system, answer, apart)
    if not found:
        return "no one number of the description explains it: what is read, a torque or a law of motion", None
    return sentence(found, other), place_of(found)
