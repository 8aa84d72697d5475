"""The textbook matrices against the recursions, which share no code: link frames and beam nodes here, bodies and points there."""

from __future__ import annotations

import numpy as np
import pytest
from twisting import with_twist

from harness.denoc import Denoc
from harness.denoc.matrices import denoc_matrices
from harness.errors import InputError
from harness.system import System, random_chain, random_tree

SYSTEMS = [
    random_chain(7, 3, armature=True, fixed=0.4),
    random_tree(20, 1, fixed=0.3, armature=True),
    random_chain(1, 1, flexible=1.0, modes=1, prismatic=0.0),
    random_chain(1, 2, flexible=1.0, modes=3, bending2=True),
    random_chain(4, 3, flexible=0.6, bending2=True, fixed=0.2),
    random_tree(8, 4, flexible=0.5, armature=True, damping=True, fixed=0.3),
    random_tree(6, 5, flexible=0.5, prismatic=0.6, fixed=0.3),
    with_twist(random_chain(3, 6, flexible=0.8, bending2=True)),
]
IDS = [f"{k}_{system.name}" for k, system in enumerate(SYSTEMS)]


def configuration(model: Denoc) -> np.ndarray:
    rng = np.random.default_rng(0)
    elastic = np.array(["mode" in name for name in model.names])
    return np.where(elastic, 0.02 * rng.normal(size=model.n), rng.uniform(-3.0, 3.0, model.n))


def relative(found: np.ndarray, expected: np.ndarray) -> float:
    return float(np.abs(found - expected).max() / np.abs(expected).max())


@pytest.mark.parametrize("system", SYSTEMS, ids=IDS)
def test_natural_orthogonal_complement_gives_the_mass_matrix_of_the_recursion(system: System) -> None:
    model = Denoc(system)
    q = configuration(model)
    matrices = denoc_matrices(system, q)
    modes = sum(link.beam.coordinates for link in system.links if link.beam is not None)
    rows = 6 * len(system.links) + modes
    assert matrices.N_l.shape == (rows, rows)
    assert matrices.N_d.shape == (rows, model.n)
    assert relative(model.mass_matrix(q), matrices.inertia) < 1e-13


@pytest.mark.parametrize("system", SYSTEMS, ids=IDS)
def test_blocks_are_where_the_names_say(system: System) -> None:
    matrices = denoc_matrices(system, configuration(Denoc(system)))
    for r, c in zip(matrices.rows, matrices.columns, strict=True):
        assert not matrices.N_l[r, r.stop :].any()
        assert np.array_equal(matrices.N_l[r, r], np.eye(r.stop - r.start))
        outside = np.ones(matrices.N_d.shape, dtype=bool)
        outside[r, c] = False
        assert not matrices.N_d[r][outside[r]].any()


@pytest.mark.parametrize("system", SYSTEMS, ids=IDS)
def test_recursive_elements_make_up_the_generalized_inertia_matrix(system: System) -> None:
    matrices = denoc_matrices(system, configuration(Denoc(system)))
    bare = matrices.inertia - np.diag(matrices.armature)
    for i in range(len(matrices.rows)):
        for j in range(i + 1):
            block = bare[matrices.columns[i], matrices.columns[j]]
            assert np.abs(matrices.element(i, j) - block).max(initial=0.0) < 1e-13 * np.abs(bare).max()


@pytest.mark.parametrize("system", SYSTEMS, ids=IDS)
def test_articulated_bodies_give_the_factors_of_the_mass_matrix(system: System) -> None:
    model = Denoc(system)
    q = configuration(model)
    upper, diagonal = denoc_matrices(system, q).udu()
    assert np.array_equal(np.tril(upper), np.eye(model.n))
    assert (diagonal > 0.0).all()
    assert relative(upper * diagonal @ upper.T, model.mass_matrix(q)) < 1e-13
    # Solving with the factors is forward dynamics.
    qd, tau = np.random.default_rng(1).normal(size=(2, model.n))
    right = tau - model.bias(q, qd) + model.passive(q, qd)
    solved = np.linalg.solve(upper.T, np.linalg.solve(upper, right) / diagonal)
    assert relative(model.forward_dynamics(q, qd, tau), solved) < 1e-9


def test_wrong_size_is_refused() -> None:
    with pytest.raises(InputError, match=r"q has shape \(3,\)"):
        denoc_matrices(SYSTEMS[0], np.zeros(3))
