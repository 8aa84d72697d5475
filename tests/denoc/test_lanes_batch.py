"""Many states at once against Pinocchio, against the calls state by state, and against themselves."""

from __future__ import annotations

import numpy as np
import pytest
from pinocchio_tree import pinocchio_tree

from harness.denoc import Denoc
from harness.denoc.batch.chain_mass import FAR
from harness.denoc.batch.model import BatchModel
from harness.denoc.batch.tree_mass import LONG
from harness.denoc.matrices import denoc_matrices
from harness.denoc.simd.vector import exponential, load, sine_cosine, store
from harness.errors import InputError, UnsupportedError
from harness.system import Joint, JointType, Link, System, random_chain, random_tree


@pytest.mark.parametrize(
    "system",
    [
        random_chain(1, seed=1, prismatic=0.0),
        random_chain(7, seed=2, armature=True),
        random_tree(15, seed=3, prismatic=0.4, fixed=0.3),
        random_chain(60, seed=4, prismatic=0.1),
        random_tree(40, seed=5),
    ],
    ids=lambda system: f"{system.name}-{len(system.joint_names)}",
)
@pytest.mark.parametrize("count", [3, 8, 29])
def test_against_pinocchio(system, count):
    import pinocchio as pin

    model, _ = pinocchio_tree(system)
    data = model.createData()
    ours = BatchModel(system)
    rng = np.random.default_rng(count)
    q, v, a = (rng.uniform(-2, 2, (count, ours.n)) for _ in range(3))
    forward, inverse, mass = ours.forward_dynamics(q, v, a), ours.inverse_dynamics(q, v, a), ours.mass_matrix(q)
    for k in range(count):
        reference = pin.aba(model, data, q[k], v[k], a[k])
        # The condition of the mass matrix is what a long chain leaves of sixteen digits.
        assert np.abs(forward[k] - reference).max() < 1e-9 * np.abs(reference).max()
        reference = pin.rnea(model, data, q[k], v[k], a[k])
        assert np.abs(inverse[k] - reference).max() < 1e-12 * np.abs(reference).max()
        reference = by_columns(model, data, q[k])
        assert np.abs(mass[k] - reference).max() < 1e-12 * np.abs(reference).max()


def by_columns(model, data, q):
    """Pinocchio's mass matrix column by column: its composite-body algorithm wants joints in depth-first order."""
    import pinocchio as pin

    rest = np.zeros(len(q))
    gravity = pin.rnea(model, data, q, rest, rest)
    return np.array([pin.rnea(model, data, q, rest, e) - gravity for e in np.eye(len(q))])


def relative_to_diagonal(found, wanted):
    """Largest difference of two inertia matrices, each element relative to the roots of those on the diagonal."""
    size = np.sqrt(np.diag(wanted))
    return np.abs((found - wanted) / np.outer(size, size)).max()


# Tiles of eight joints, with and without joints left over; 64 share an origin.
@pytest.mark.parametrize("n", [15, 16, 17, 23, 24, 50, 64, 73, 200])
@pytest.mark.parametrize("prismatic", [0.0, 0.3])
def test_mass_matrices_of_chains_are_those_of_pinocchio_and_of_the_textbook(n, prismatic):
    import pinocchio as pin

    system = random_chain(n, seed=n, prismatic=prismatic, armature=True)
    (model, _), count = pinocchio_tree(system), 11 if n < 100 else 9
    data = model.createData()
    q = np.random.default_rng(n).uniform(-4, 4, (count, n))
    q[1] = np.where([joint.prismatic for joint in system.movable_joints], q[1], 2500 * q[1])
    found = BatchModel(system).mass_matrix(q)
    assert np.array_equal(found, found.transpose(0, 2, 1))
    for state, mass in zip(q, found, strict=True):
        assert relative_to_diagonal(mass, pin.crba(model, data, state)) < 1e-13
    for k in (0, 1, count - 1):
        assert relative_to_diagonal(found[k], denoc_matrices(system, q[k]).inertia) < 1e-13


@pytest.mark.parametrize("n", [LONG - 1, LONG, 17, 19, 33, 100])
@pytest.mark.parametrize("prismatic", [0.0, 0.4])
def test_mass_matrices_of_trees_are_those_of_pinocchio_and_zero_between_branches(n, prismatic):
    """Into room that holds no numbers yet, so that what is not written is seen; fixed joints leave a size of any remainder."""
    system = random_tree(n, seed=n, prismatic=prismatic, armature=True)
    ours = BatchModel(system)
    assert not ours.serial
    model, _ = pinocchio_tree(system)
    data = model.createData()
    q = np.random.default_rng(n).uniform(-3, 3, (11, n))
    mass = ours.mass_matrix(q, out=np.full((11, n, n), np.nan))
    carriers = [set(model.supports[k].tolist()) - {0} for k in range(1, n + 1)]
    apart = np.array([[i + 1 not in carriers[j] and j + 1 not in carriers[i] for j in range(n)] for i in range(n)])
    assert apart.any()
    for own, at in zip(mass, q, strict=True):
        assert relative_to_diagonal(own, by_columns(model, data, at)) < 1e-12
        assert (own[apart] == 0.0).all()


@pytest.mark.parametrize("n", [16, 50, 200])
def test_a_stretched_chain_loses_no_digits_of_its_last_links(n):
    # Rods in line, joints parallel: I_ij is the sum over links k ≥ i of inertia and m (k - i + ½)(k - j + ½) l².
    joints, links = [], []
    for k in range(n):
        place = np.array([1.0 if k else 0.0, 0.0, 0.0])
        above = links[-1].name if links else "base"
        axis = np.array([0.0, 1.0, 0.0])
        joints.append(Joint(f"joint{k}", JointType.REVOLUTE, above, f"rod{k}", axis=axis, xyz=place))
        links.append(Link(f"rod{k}", 1.0, np.array([0.5, 0.0, 0.0]), np.diag([0.0, 1.0, 1.0]) / 12))
    arms = np.clip(np.arange(n) - np.arange(n)[:, None], -0.5, None) + 0.5
    carried = arms > 0
    wanted = arms @ arms.T + (carried[:, None] & carried[None]).sum(axis=2) / 12
    found = BatchModel(System("rods", tuple(joints), tuple(links))).mass_matrix(np.zeros((8, n)))
    for mass in found:
        assert relative_to_diagonal(mass, wanted) < 5e-15


@pytest.mark.parametrize("n", [7, 16, 50])
def test_mass_matrices_by_threads_and_in_any_order_are_the_same(n):
    system = random_chain(n, seed=3, armature=True)
    q = np.random.default_rng(n).normal(size=(93, n))
    order = np.random.default_rng(1).permutation(93)
    one = BatchModel(system).mass_matrix(q)
    assert np.array_equal(BatchModel(system, threads=2).mass_matrix(q), one)
    assert np.array_equal(BatchModel(system).mass_matrix(q[order]), one[order])
    # Fewer states than a vector has lanes.
    assert np.array_equal(BatchModel(system).mass_matrix(q[:3]), one[:3])


@pytest.mark.parametrize("n", [19, 56])
@pytest.mark.parametrize("threads", [1, 2])
@pytest.mark.parametrize("shift", [0, 3])
def test_results_that_no_cache_holds_are_the_same(n, threads, shift):
    # Written past the caches, whether or not they begin where a cache line does.
    system = random_chain(n, seed=3, armature=True)
    count = FAR // (n * n) + 11
    q = np.random.default_rng(n).normal(size=(count, n))
    room = np.full(count * n * n + 16 + shift, 7.0)
    out = room[8 + shift : -8].reshape(count, n, n)
    BatchModel(system, threads=threads).mass_matrix(q, out=out)
    few = BatchModel(system)
    assert all(np.array_equal(out[k : k + 500], few.mass_matrix(q[k : k + 500])) for k in range(0, count, 500))
    assert (room[: 8 + shift] == 7.0).all() and (room[-8:] == 7.0).all()


def calls(model):
    """The three methods over many states of BatchModel or Denoc, by the shape of one result."""
    of = (
        (lambda name: getattr(model, name)) if isinstance(model, BatchModel) else lambda n: getattr(model, f"{n}_batch")
    )
    return {
        "forward": (3, of("forward_dynamics"), 1),
        "inverse": (3, of("inverse_dynamics"), 1),
        "mass": (1, of("mass_matrix"), 2),
    }


@pytest.mark.parametrize("make", [BatchModel, Denoc])
@pytest.mark.parametrize(
    "system",
    [random_chain(6, seed=2), random_chain(19, seed=2), random_tree(9, seed=7), random_tree(130, seed=7)],
    ids=["short", "long", "tree", "large"],
)
@pytest.mark.parametrize("count", [0, 3, 8, 21])
def test_results_are_written_where_the_caller_says(make, system, count):
    model = make(system)
    n = model.n
    q, v, a = (np.random.default_rng(k).normal(size=(count, n)) for k in range(3))
    for taken, call, power in calls(model).values():
        arguments = (q, v, a)[:taken]
        wanted = call(*arguments)
        # What lies before and behind belongs to others.
        size = count * n**power
        room = np.full(size + 16, 7.0)
        out = room[8 : 8 + size].reshape(count, *[n] * power)
        assert call(*arguments, out=out) is out
        assert np.array_equal(out, wanted)
        assert (room[:8] == 7.0).all() and (room[8 + size :] == 7.0).all()


@pytest.mark.parametrize("make", [BatchModel, Denoc])
@pytest.mark.parametrize("count", [3, 21])
def test_results_may_be_written_over_the_arguments(make, count):
    model = make(random_chain(5, seed=2))
    q, v, a = (np.random.default_rng(k).normal(size=(count, 5)) for k in range(3))
    for taken, call, power in calls(model).values():
        if power == 1:
            wanted = call(q, v, a)
            for k in range(taken):
                arguments = [q.copy(), v.copy(), a.copy()]
                assert np.array_equal(call(*arguments, out=arguments[k]), wanted)


@pytest.mark.parametrize("make", [BatchModel, Denoc])
def test_room_that_does_not_fit_the_results_is_refused(make, tmp_path):
    model = make(random_chain(3, seed=1))
    q = np.zeros((9, 3))
    for taken, call, power in calls(model).values():
        shape = (9, *[3] * power)
        frozen = np.zeros(shape)
        frozen.setflags(write=False)
        for out, message in (
            (np.zeros((8, *shape[1:])), r"out has shape \(8, 3"),
            (np.zeros(np.prod(shape)), r"out has shape \("),
            (np.zeros(shape, dtype=np.float32), "out holds float32"),
            (np.zeros(shape, dtype=">f8"), "out holds >f8"),
            (np.zeros(shape, order="F"), "out is not C-contiguous"),
            (np.zeros((9, 2 * 3, *shape[2:]))[:, ::2], "out is not C-contiguous"),
            (frozen, "out is read-only"),
            (np.zeros(shape).tolist(), "out is no array but list"),
            (np.frombuffer(bytearray(8 * 9 * 3**power + 1), np.uint8)[1:].view(float).reshape(shape), "not aligned"),
        ):
            with pytest.raises(InputError, match=message) as caught:
                call(*[q] * taken, out=out)
            assert "\n" not in str(caught.value)
        mapped = np.memmap(tmp_path / f"results{power}{taken}", dtype=float, mode="w+", shape=shape)
        assert call(*[q] * taken, out=mapped) is mapped
        assert np.array_equal(mapped, call(*[q] * taken))


def test_passive_forces_act_as_in_the_single_calls():
    system = random_chain(6, seed=9, armature=True, damping=True)
    for joint in system.movable_joints[::2]:
        from dataclasses import replace

        system = system.replace_joint(replace(joint, stiffness=3.0, rest_position=0.2))
    one, many = Denoc(system), BatchModel(system)
    rng = np.random.default_rng(0)
    q, v, a = (rng.normal(size=(17, 6)) for _ in range(3))
    for k in range(17):
        assert many.forward_dynamics(q, v, a)[k] == pytest.approx(one.forward_dynamics(q[k], v[k], a[k]), rel=1e-10)
        assert many.inverse_dynamics(q, v, a)[k] == pytest.approx(one.inverse_dynamics(q[k], v[k], a[k]), rel=1e-10)


def test_forward_and_inverse_dynamics_undo_each_other_many_turns_away():
    system = random_chain(7, seed=12, prismatic=0.0)
    many = BatchModel(system)
    rng = np.random.default_rng(2)
    q, v, tau = rng.uniform(-1e4, 1e4, (64, 7)), rng.normal(size=(64, 7)), rng.normal(size=(64, 7))
    qdd = many.forward_dynamics(q, v, tau)
    assert np.abs(many.inverse_dynamics(q, v, qdd) - tau).max() < 1e-10
    bias = many.inverse_dynamics(q, v, np.zeros_like(q))
    assert np.einsum("bij,bj->bi", many.mass_matrix(q), qdd) + bias == pytest.approx(tau, abs=1e-10)
    # The same states with whole turns taken off; the angle itself is only good to its own rounding, 2e-12.
    near = np.remainder(q + np.pi, 2 * np.pi) - np.pi
    assert np.abs(many.forward_dynamics(near, v, tau) - qdd).max() < 1e-8 * np.abs(qdd).max()


def test_threads_and_order_change_nothing():
    system = random_tree(9, seed=7)
    one, two = BatchModel(system), BatchModel(system, threads=2)
    rng = np.random.default_rng(3)
    q, v, tau = (rng.normal(size=(101, 9)) for _ in range(3))
    order = rng.permutation(101)
    for a, b, c in (
        (one.forward_dynamics(q, v, tau), two.forward_dynamics(q, v, tau), one.forward_dynamics(q[order], v[order], tau[order])),
        (one.inverse_dynamics(q, v, tau), two.inverse_dynamics(q, v, tau), one.inverse_dynamics(q[order], v[order], tau[order])),
        (one.mass_matrix(q), two.mass_matrix(q), one.mass_matrix(q[order])),
    ):  # fmt: skip
        assert np.array_equal(a, b)
        assert np.array_equal(a[order], c)


def test_the_public_batches_are_these():
    system = random_tree(9, seed=7)
    denoc, many = Denoc(system), BatchModel(system)
    rng = np.random.default_rng(3)
    q, v, tau = (rng.normal(size=(20, 9)) for _ in range(3))
    assert denoc.forward_dynamics_batch(q, v, tau) == pytest.approx(many.forward_dynamics(q, v, tau), rel=1e-10)
    assert denoc.inverse_dynamics_batch(q, v, tau) == pytest.approx(
        many.inverse_dynamics(q, v, tau), rel=1e-9, abs=1e-12
    )
    assert denoc.mass_matrix_batch(q) == pytest.approx(many.mass_matrix(q), rel=1e-9, abs=1e-12)


def test_read_only_and_strided_arrays_and_no_rows():
    many = BatchModel(random_chain(3, seed=1))
    q = np.random.default_rng(0).normal(size=(3, 24)).T
    frozen = np.ascontiguousarray(q)
    frozen.setflags(write=False)
    assert np.array_equal(many.forward_dynamics(q, q, q), many.forward_dynamics(frozen, frozen, frozen))
    assert many.forward_dynamics(np.zeros((0, 3)), np.zeros((0, 3))).shape == (0, 3)
    assert many.mass_matrix(np.zeros((0, 3))).shape == (0, 3, 3)


def test_what_does_not_fit_is_named():
    many = BatchModel(random_chain(3, seed=1))
    with pytest.raises(InputError, match=r"Q has shape \(3, 2\)"):
        many.mass_matrix(np.zeros((3, 2)))
    with pytest.raises(InputError, match="rows"):
        many.forward_dynamics(np.zeros((3, 3)), np.zeros((4, 3)))
    with pytest.raises(UnsupportedError, match="flexible"):
        BatchModel(random_chain(2, flexible=1.0))


def test_functions_of_lanes_reach_full_accuracy():
    # Sine and cosine to 4e-16 absolute up to 1e4 rad, the exponential of −x to 4e-16 relative: numpy's own are good to 1 ulp.
    from numba import njit

    @njit
    def evaluate(x, out):
        for k in range(0, len(x), 8):
            v = load(x, k)
            s, c = sine_cosine(v)
            store(out, 3 * k, s)
            store(out, 3 * k + 8, c)
            store(out, 3 * k + 16, exponential(-v))

    rng = np.random.default_rng(8)
    x = np.concatenate([rng.uniform(0, 1e4, 4000), rng.uniform(0, 7, 4000), np.arange(0, 8000) * np.pi / 2])
    out = np.zeros(3 * len(x))
    evaluate(x, out)
    s, c, e = out.reshape(-1, 3, 8).transpose(1, 0, 2).reshape(3, -1)
    assert np.abs(s - np.sin(x)).max() < 4e-16
    assert np.abs(c - np.cos(x)).max() < 4e-16
    small = x < 700
    assert np.abs(e[small] / np.exp(-x[small]) - 1.0).max() < 5e-16
    code = next(iter(evaluate.inspect_llvm().values()))
    assert "fmul contract <8 x double>" in code  # it is vector code, not eight scalar ones
