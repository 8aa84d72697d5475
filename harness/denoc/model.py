"""A mechanism compiled for computing: the public face of the native dynamics."""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial
from typing import TYPE_CHECKING, Any, Literal

import numpy as np
from markupsafe import escape
from numpy import empty
from numpy.typing import ArrayLike, NDArray

from harness.denoc.batch.results import apart, finite, place_for
from harness.denoc.recursion import rigid, rigid_chain
from harness.denoc.recursion.addresses import addresses
from harness.denoc.recursion.binding import (
    BARE,
    CHAIN,
    FORWARD,
    INVERSE,
    NOT_FINITE,
    NOT_PLAIN,
    RECURSION,
    entry,
    make_header,
)
from harness.denoc.recursion.dynamics_call import call_rows, forward_entry, inverse_entry
from harness.denoc.recursion.elastic import pack_beams
from harness.denoc.recursion.rows import ARMATURE, EXTERNAL, FIRST, POSITION, TURN
from harness.denoc.recursion.tree import Tree, compile_tree
from harness.errors import InputError, UnsupportedError
from harness.system import System, Trajectory
from harness.system.lowering import lower, neutral_position

if TYPE_CHECKING:
    from harness.denoc.batch.in_space import SpaceBatch
    from harness.denoc.batch.model import BatchModel
    from harness.denoc.chart.chart import Chart
    from harness.denoc.motion.integrate import Event

Array = NDArray[np.float64]

# From this number of coordinates on, mass matrices of trees with branches are faster one by one: eight at once no longer fit
# the nearest caches.
_LARGE = 128


class Denoc:
    """Equations of motion M(q) q̈ + C(q, q̇) q̇ + g(q) = τ + passive forces of a tree of rigid and flexible links.

    system: the mechanism. Velocities, accelerations and forces (n = nv of them) are in the order of
    ``system.coordinate_names``, positions (nq) in that of ``system.position_names``; SI units throughout. The two are the
    same where every joint has one degree of freedom. A rotation in space is a quaternion of any length but zero.
    Raises InputError naming joint or link where a number is unusable.

    An object holds a workspace that its methods write to: use one object a thread (making one is cheap).
    """

    __slots__ = (
        "_arguments",
        "_bare",
        "_chain",
        "_chart",
        "_elastic",
        "_forward",
        "_header",
        "_inverse",
        "_kernels",
        "_many",
        "_mass",
        "_model",
        "_space",
        "_zero",
        "beams",
        "n",
        "names",
        "nq",
        "position_names",
        "system",
        "tree",
    )

    # Whether forces act that the compiled equations do not hold, so that integrators have to call ``forward_dynamics``.
    by_calls = False

    # The class of systems part of whose weight is carried, which ``harness.denoc.compensated`` puts here.
    of_carried_weight: type[Denoc] | None = None

    # The class of systems that loops close, which ``harness.denoc.loops.closed`` puts here.
    of_loops: type[Denoc] | None = None

    def __new__(cls, system: System) -> Denoc:
        """An object of the class that holds what the system has."""
        kind = cls
        if not isinstance(system, System):
            what = f"Denoc is of a System, not of a {type(system).__name__}"
            raise InputError(what, mend="read a file by harness.load(path)")
        if cls is Denoc and Denoc.of_carried_weight and any(link.gravcomp for link in system.links):
            kind = Denoc.of_carried_weight
        if cls is Denoc and Denoc.of_loops and system.loops:
            kind = Denoc.of_loops
        return object.__new__(kind)

    def __init__(self, system: System) -> None:
        lowered = None if system.simple else lower(system)
        tree = compile_tree(system if lowered is None else lowered.system)
        if tree.n == 0:
            raise InputError(
                f"system {system.name!r} has no movable joint and no flexible link",
                mend="give it a joint that is not fixed",
            )
        self.system = system
        self.names = system.coordinate_names
        self.position_names = system.position_names
        self.n = len(self.names)
        self.nq = len(self.position_names)
        self.tree: Tree = tree
        self._elastic, self.beams = pack_beams(tree)
        # Flexible recursions are compiled only where a link bends: a rigid robot does not wait for them.
        flexible = bool(self.beams)
        self._header = make_header(
            tree.bodies,
            tree.n,
            tree.rows,
            tree.topology,
            self._elastic,
            *addresses(flexible),
        )
        self._chain: Array | None = None
        if lowered is None and rigid_chain.fits(tree):
            from harness.denoc.recursion.rigid_address import chain_address

            self._chain = rigid_chain.pack(tree)
            self._header[FORWARD], self._header[CHAIN] = chain_address(), self._chain.ctypes.data
        # The same model, whose inverse dynamics leave passive forces out.
        self._bare = self._header.copy()
        self._bare[BARE] = 1
        self._chart: Chart | None = None
        self._zero = np.zeros(self.n)
        if lowered is None:
            self._forward, self._inverse = entry(forward_entry, 4), entry(inverse_entry, 4)
        else:
            from harness.denoc.chart.chart import make_chart

            self._chart, self._header, self._bare = make_chart(system, lowered, tree, self._header)
            # Positions are to be looked at first.
            self._forward = self._inverse = _declined
        self._model = int(self._header.ctypes.data)
        self._many: BatchModel | None = None
        self._space: SpaceBatch | Literal[False] | None = None
        self._mass: Any = None
        self._kernels: Any = rigid
        self._arguments: tuple[Any, ...] = (tree.bodies, tree.rows, tree.topology)
        if flexible:
            from harness.denoc.recursion import flexible as kernels

            self._kernels = kernels
            self._arguments = (*self._arguments, self._elastic)

    def __reduce__(self) -> tuple[type[Denoc], tuple[System]]:
        # Addresses of arrays do not survive a trip to another process.
        return Denoc, (self.system,)

    def __repr__(self) -> str:
        many = "" if self.n == 1 else "s"
        return f"<Denoc {self.system.name!r}: {self.n} coordinate{many} ({', '.join(self.names)})>"

    def _repr_html_(self) -> str:
        """Coordinates and the joints and links of the system, for notebooks."""
        return f"<p>{escape(repr(self))}</p>{self.system._repr_html_()}"

    # `wrenches` is not keyword-only here and below: that alone would cost a tenth of a call at one joint.
    def forward_dynamics(
        self, q: Array, qd: Array, tau: Array | None = None, wrenches: ArrayLike | None = None
    ) -> Array:
        """Accelerations q̈ from forces; joint damping and springs, beam stiffness and damping act, dry friction does not.

        q [rad or m], shape (nq,); qd, tau [N·m or N], each shape (n,); tau None is zero. wrenches: external (moment, force) on each
        link at its link-frame origin, in base axes, shape (links, 6). Returns shape (n,).
        Raises InputError for wrong sizes, for what is not finite, and for a joint that moves no inertia.
        """
        if wrenches is not None:
            return self._under_wrenches(self.forward_dynamics, q, wrenches, qd, tau)
        if tau is None:
            tau = self._zero
        qdd = empty(self.n)
        status = self._forward(self._model, q, qd, tau, qdd)
        if status:
            return self._again(status, self._forward, FORWARD, q=q, qd=qd, tau=tau)
        return qdd

    def inverse_dynamics(self, q: Array, qd: Array, qdd: Array, wrenches: ArrayLike | None = None) -> Array:
        """Generalized forces τ that make the accelerations, passive forces counted as in ``forward_dynamics``.

        q: shape (nq,); qd, qdd: shape (n,). wrenches as in ``forward_dynamics``. Returns shape (n,).
        Raises InputError for wrong sizes and for what is not finite.
        """
        if wrenches is not None:
            return self._under_wrenches(self.inverse_dynamics, q, wrenches, qd, qdd)
        tau = empty(self.n)
        status = self._inverse(self._model, q, qd, qdd, tau)
        if status:
            return self._again(status, self._inverse, INVERSE, q=q, qd=qd, qdd=qdd)
        return tau

    def mass_matrix(self, q: ArrayLike) -> Array:
        """Generalized inertia matrix M(q), armature included, shape (n, n)."""
        mass = empty((self.n, self.n))
        if self._mass is None:
            self._mass = self._short_mass_matrix()
        if self._mass(self._model, q, mass):
            # Converted and checked, or a line that says what is wrong.
            self._mass_rows(self.position("q", q)[None], mass[None])
        return mass

    def _mass_rows(self, Q: Array, out: Array) -> None:
        """Generalized inertia matrices of arrays known to be sound."""
        if self._chart is None:
            self._lowered_mass_rows(Q, out)
            return
        lowered = np.empty((1, self.tree.n, self.tree.n))
        for k, q in enumerate(Q):
            self._lowered_mass_rows(self._chart.local(self._model, q)[None], lowered)
            out[k] = self._chart.both_sides(lowered[0])

    def _lowered_mass_rows(self, Q: Array, out: Array) -> None:
        """The same in the coordinates of ``tree``."""
        kernels = self._kernels
        if not self.beams:
            from harness.denoc.recursion import rigid_mass as kernels
        kernels.mass_matrix_rows(*self._arguments, Q, out)

    def _short_mass_matrix(self) -> Any:
        """The short way to the mass matrix; where links bend there is none, and it declines."""
        if self.beams or self._chart is not None:
            return _declined
        from harness.denoc.recursion.rigid_address import mass_entry

        return entry(mass_entry, 2)

    def bias(self, q: ArrayLike, qd: ArrayLike) -> Array:
        """C(q, q̇) q̇ + g(q), without passive forces, shape (n,)."""
        out = np.empty(self.n)
        q, qd = self.position("q", q), self.vector("qd", qd)
        call_rows(int(self._bare[INVERSE]), int(self._bare.ctypes.data), q[None], qd[None], self._zero[None], out[None])
        return out

    def gravity(self, q: ArrayLike) -> Array:
        """Gravity forces g(q), on the left-hand side as in M q̈ + C q̇ + g = τ, shape (n,)."""
        return self.bias(q, self._zero)

    def coriolis_matrix(self, q: ArrayLike, qd: ArrayLike) -> Array:
        """A matrix C(q, q̇) with C q̇ the velocity forces and Ṁ - 2C skew-symmetric, shape (n, n)."""
        m = self.tree.n
        out = np.empty((m, m))
        local, rates = self._lowered(q, qd)
        if self.beams:
            from harness.denoc.motion.coriolis import christoffel_matrix

            if self._chart is not None:
                raise UnsupportedError(
                    "the Coriolis matrix of flexible links beside joints of several degrees of freedom",
                    mend="use bias, whose velocity forces are the same",
                )
            return christoffel_matrix(self, local, rates)
        self._kernels.coriolis_matrix(*self._arguments, local, rates, out)
        if self._chart is None:
            return out
        mass = np.empty((1, m, m))
        self._lowered_mass_rows(local[None], mass)
        # Rates of angles are spins here and now alone; armature is none of a body's inertia.
        armature = np.diag(self.tree.rows[1:, ARMATURE])
        return self._chart.both_sides(out - (mass[0] - armature) @ self._chart.product_matrix(rates))

    def passive(self, q: ArrayLike, qd: ArrayLike) -> Array:
        """Passive forces on the right-hand side: -damping q̇ - stiffness (q - rest), beams included, shape (n,)."""
        q, qd = self._lowered(q, qd)
        out = np.zeros(self.tree.n)
        self._kernels.subtract_passive(*self._arguments, q, qd, out)
        return -out if self._chart is None else -self._chart.gathered(out)

    def energy(self, q: ArrayLike, qd: ArrayLike) -> tuple[float, float]:
        """Kinetic and potential energy [J]; springs and beams count as potential, zero height is the base's origin."""
        kinetic, potential = self.energies(self.position("q", q)[None], self.vector("qd", qd)[None])[0]
        return float(kinetic), float(potential)

    def momentum(self, q: ArrayLike, qd: ArrayLike) -> Array:
        """Angular momentum about the base's origin [kg·m²/s] and linear momentum [kg·m/s], base axes, shape (6,).

        Armature is inertia of a coordinate, not of a body in space, and has no share in it.
        """
        out = np.empty(6)
        self._kernels.momentum(*self._arguments, *self._lowered(q, qd), out)
        return out

    def link_pose(self, q: ArrayLike, link: str) -> tuple[Array, Array]:
        """Rotation (link axes to base axes, (3, 3)) and position (3,) [m] of a link's frame in base coordinates.

        Raises InputError if there is no such link.
        """
        seat = self.tree.seats.get(link)
        if seat is None:
            raise InputError(f"no link {link!r}", mend=f"links are {', '.join(list(self.tree.seats)[:8])} …")
        self._kernels.locate(*self._arguments, *self._lowered(q, self._zero))
        row = self.tree.rows[seat.body]
        turn = row[TURN : TURN + 9].reshape(3, 3)
        return turn @ seat.rotation, row[POSITION : POSITION + 3] + turn @ seat.origin

    def forward_dynamics_batch(
        self, Q: ArrayLike, Qd: ArrayLike, Tau: ArrayLike | None = None, *, out: Array | None = None
    ) -> Array:
        """``forward_dynamics`` for many states at once: Q has shape (B, nq), Qd, Tau and the result (B, n).

        out: where to write the result, here and below: a writeable, C-contiguous array of float64 of its shape, which is
        returned. Raises InputError where it is not.
        """
        Q, Qd = self._table("Q", Q), self._table("Qd", Qd)
        Tau = np.zeros_like(Qd) if Tau is None else self._table("Tau", Tau)
        self._same_length(Q=Q, Qd=Qd, Tau=Tau)
        result = place_for(Qd.shape, out)
        Q, Qd, Tau = apart(Q, out), apart(Qd, out), apart(Tau, out)
        space = self._in_space(Q)
        if space is not None:
            space.forward_dynamics(Q, Qd, Tau, result, self.accelerations)
            if finite(result):
                return result
        many = self._eight_at_a_time(Q)
        if many is not None and finite(np.asarray(many.forward_dynamics(Q, Qd, Tau, out=result))):
            return result
        # Row by row, which also says what makes a result that is not finite.
        return self.accelerations(Q, Qd, Tau, result)

    def inverse_dynamics_batch(self, Q: ArrayLike, Qd: ArrayLike, Qdd: ArrayLike, *, out: Array | None = None) -> Array:
        """``inverse_dynamics`` for many states at once: Q (B, nq), Qd, Qdd and the result (B, n); out as above."""
        Q, Qd, Qdd = self._table("Q", Q), self._table("Qd", Qd), self._table("Qdd", Qdd)
        self._same_length(Q=Q, Qd=Qd, Qdd=Qdd)
        many = self._eight_at_a_time(Q)
        if many is not None:
            return many.inverse_dynamics(Q, Qd, Qdd, out=out)
        result = place_for(Qd.shape, out)
        Q, Qd, Qdd = apart(Q, out), apart(Qd, out), apart(Qdd, out)
        by_row = partial(call_rows, int(self._header[INVERSE]), self._model)
        space = self._in_space(Q)
        if space is not None:
            return space.inverse_dynamics(Q, Qd, Qdd, result, by_row)
        by_row(Q, Qd, Qdd, result)
        return result

    def mass_matrix_batch(self, Q: ArrayLike, *, out: Array | None = None) -> Array:
        """``mass_matrix`` for many positions at once: Q (B, nq), result (B, n, n); out as above.

        A new result of many states costs more to make room for than to compute: give one that is there already.
        """
        Q = self._table("Q", Q)
        many = self._eight_at_a_time(Q)
        if many is not None and (many.serial or self.n < _LARGE):
            return many.mass_matrix(Q, out=out)
        result = place_for((len(Q), self.n, self.n), out)
        Q = apart(Q, out)
        space = self._in_space(Q)
        if space is not None and (space.serial or self.n < _LARGE):
            return space.mass_matrix(Q, result, self._mass_rows)
        self._mass_rows(Q, result)
        return result

    def _eight_at_a_time(self, Q: Array) -> BatchModel | None:
        """The kernels over eight states at once, for rigid systems and enough rows to be worth it."""
        if self.beams or len(Q) < 8 or self._chart is not None:
            return None
        if self._many is None:
            from harness.denoc.batch.model import BatchModel

            self._many = BatchModel(self.system)
        return self._many

    def _in_space(self, Q: Array) -> SpaceBatch | None:
        """The same for rigid systems whose joints turn in space, where ``SpaceBatch`` takes them."""
        if self._chart is None or len(Q) < 8:
            return None
        if self._space is None:
            from harness.denoc.batch.in_space import SpaceBatch

            lowered = self._chart.lowered
            self._space = SpaceBatch(self.system, lowered) if SpaceBatch.takes(self.system, lowered) else False
        return self._space or None

    def accelerations(self, Q: Array, Qd: Array, Tau: Array, out: Array | None = None) -> Array:
        """``forward_dynamics`` row by row, for arrays known to be sound; Tau may have no rows, for no forces."""
        if out is None:
            out = np.empty_like(Qd)
        forces = Tau if len(Tau) else np.zeros_like(Qd)
        status = call_rows(int(self._header[FORWARD]), self._model, Q, Qd, forces, out)
        if status > 0:
            raise self.singular(status)
        return out

    def energies(self, Q: Array, Qd: Array) -> Array:
        """Kinetic and potential energy [J] of every row, (B, 2), for arrays known to be sound."""
        out = np.empty((len(Q), 2))
        if self._chart is None:
            self._kernels.energy_rows(*self._arguments, Q, Qd, out)
            return out
        for k in range(len(Q)):
            local, rates = self._chart.local(self._model, Q[k]), self._chart.rates(Qd[k])
            self._kernels.energy_rows(*self._arguments, local[None], rates[None], out[k : k + 1])
        return out

    def hub_motion(self, body: int, Q: Array, Qd: Array, Qdd: Array) -> Array:
        """Rotation (9), spin (3), acceleration less gravity (6) of a body in every row, (B, 18); flexible systems only."""
        out = np.empty((len(Q), 18))
        self._kernels.hub_rows(
            int(self._bare[INVERSE]),
            int(self._bare.ctypes.data),
            self.tree.rows,
            body,
            Q,
            Qd,
            Qdd,
            np.empty(self.n),
            out,
        )
        return out

    def simulate(
        self,
        q0: ArrayLike,
        qd0: ArrayLike,
        time: ArrayLike,
        *,
        tau: ArrayLike | None = None,
        hold: str = "zero",
        method: str | None = None,
        step: float | None = None,
        rtol: float = 1e-10,
        atol: float = 1e-12,
        events: Sequence[Event] = (),
    ) -> Trajectory:
        """Motion from (q0, qd0) at time[0], sampled at ``time`` (T,), which may be uneven.

        tau: forces at the samples, (T, n), or one row for all; ``hold`` "zero" keeps each until the next sample,
        "linear" joins them. Dry friction of joints acts, and sticks.
        method: "dop853" adaptive, with rtol and atol; "rk4" and "gauss" with fixed ``step`` [s] (1 ms unless given),
        the latter for stiff modes and long undamped runs; None picks one, and the trajectory says which.
        events: functions (t, q, qd) whose zeros are located, with attributes ``terminal`` and ``direction`` as in
        SciPy's ``solve_ivp``; times of events are in the trajectory by function name.
        Channels of flexible links are in the trajectory: see ``harness.denoc.motion.channels``.
        Raises InputError for unusable input, and where an integrator does not get through.
        """
        from harness.denoc.motion.integrate import simulate

        return simulate(
            self,
            q0,
            qd0,
            time,
            tau=tau,
            hold=hold,
            method=method,
            step=step,
            rtol=rtol,
            atol=atol,
            events=events,
        )

    def frequencies(self, q: ArrayLike | None = None, *, qd: ArrayLike | None = None) -> Array:
        """Undamped natural frequencies [Hz] of small motion about a state, ascending; see ``harness.denoc.motion.frequencies``.

        q: positions, zero unless given. qd: velocities of a steady rotation, if the motion is about one.
        """
        from harness.denoc.motion.frequencies import frequencies

        return frequencies(self, self.neutral if q is None else q, qd)

    def linear_passive(self) -> tuple[Array, Array]:
        """Stiffness and damping matrices of joints and beams, (n, n) each: passive = -K (q - rest) - C q̇."""
        m = self.tree.n
        stiffness, damping = np.zeros((m, m)), np.zeros((m, m))
        for body, joint in enumerate(self.tree.joints, start=1):
            own = int(self.tree.topology[body, FIRST])
            if joint.movable:
                stiffness[own, own], damping[own, own] = joint.stiffness, joint.damping
                own += 1
            if body in self.beams:
                data = self.beams[body]
                part = slice(own, own + data.coordinates)
                stiffness[part, part], damping[part, part] = data.K, data.C
        if self._chart is None:
            return stiffness, damping
        return self._chart.both_sides(stiffness), self._chart.both_sides(damping)

    @property
    def forward_address(self) -> int:
        """Address of forward dynamics, to be called with ``header_address`` first: see ``recursion.dynamics_call``."""
        return int(self._header[FORWARD])

    @property
    def recursion_address(self) -> int:
        """The same, of what reads the bodies' rows at every call: for whoever changes them under way."""
        return int(self._header[RECURSION])

    @property
    def header_address(self) -> int:
        """Address of the header that stands for this model in kernels; valid while the model lives."""
        return self._model

    @property
    def packed_beams(self) -> Array:
        """Constants and workspace of the beams, as ``harness.denoc.recursion.elastic`` lays them out."""
        return self._elastic

    def singular(self, row: int) -> InputError:
        """The refusal for a body whose joint or modes move no inertia."""
        joint = self.tree.joints[row - 1]
        return InputError(
            f"joint {joint.name!r} moves no inertia", mend="give the links it carries mass, or the joint armature"
        )

    @property
    def neutral(self) -> Array:
        """Positions with every coordinate zero and every rotation the identity, shape (nq,)."""
        return neutral_position(self.system)

    def integrate(self, q: ArrayLike, step: ArrayLike) -> Array:
        """Positions (nq,) reached from q (nq,) by a step (n,) of velocities held for a second; a sum where nq = nv."""
        from harness.system.manifold import integrate

        return integrate(self.system, self.position("q", q), self.vector("step", step))

    def difference(self, q0: ArrayLike, q1: ArrayLike) -> Array:
        """The step (n,) that ``integrate`` takes from q0 to q1, each (nq,)."""
        from harness.system.manifold import difference

        return difference(self.system, self.position("q0", q0), self.position("q1", q1))

    def position_place(self, coordinate: int) -> int:
        """Where among the positions a coordinate of ``tree`` stands that is no angle of a ball."""
        return coordinate if self._chart is None else int(self._chart.lowered.take[coordinate])

    def velocity_share(self, coordinate: int) -> tuple[int, float]:
        """Of which velocity the rate of a coordinate of ``tree`` is a multiple, and what multiple."""
        if self._chart is None:
            return coordinate, 1.0
        row = self._chart.lowered.rates[coordinate]
        place = int(np.flatnonzero(row)[0])
        return place, float(row[place])

    def position_rates(self, q: ArrayLike, qd: ArrayLike) -> Array:
        """Rates q̇ (nq,) of the positions q (nq,) at velocities qd (n,), which they are where nq = nv."""
        if self.nq == self.n:
            return self.vector("qd", qd)
        from harness.system.manifold import position_rates

        return position_rates(self.system, self.position("q", q), self.vector("qd", qd))

    def _lowered(self, q: ArrayLike, qd: ArrayLike) -> tuple[Array, Array]:
        """Positions and rates of the coordinates of ``tree``, which is recentred there."""
        q, qd = self.position("q", q), self.vector("qd", qd)
        if self._chart is None:
            return q, qd
        return self._chart.local(self._model, q), self._chart.rates(qd)

    def position(self, name: str, value: ArrayLike) -> Array:
        """Value as a contiguous float64 vector of nq finite numbers, no quaternion in it zero."""
        if self._chart is None:
            return self.vector(name, value)
        found = self._checked(name, value, self.position_names, "position")
        self._chart.refuse_zero(found[None])
        return found

    def vector(self, name: str, value: ArrayLike) -> Array:
        """Value as a contiguous float64 vector of n finite numbers."""
        return self._checked(name, value, self.names, "coordinate" if self.n == self.nq else "velocity")

    def _checked(self, name: str, value: ArrayLike, names: tuple[str, ...], kind: str) -> Array:
        n = len(names)
        try:
            vector = np.ascontiguousarray(value, dtype=np.float64)
        except (TypeError, ValueError):
            raise InputError(f"{name} is not a vector of numbers", mend=f"give {n} numbers") from None
        if vector.shape != (n,):
            kinds = kind + "s" * (n > 1) if kind != "velocity" else "velocities"
            mixed = "" if self.n == self.nq else f" (nq = {self.nq} positions, nv = {self.n} velocities)"
            raise InputError(
                f"{name} has shape {vector.shape}, the system has {n} {kinds}{mixed}",
                mend=f"give shape ({n},): {_some(names)}",
            )
        bad = np.flatnonzero(~np.isfinite(vector))
        if len(bad):
            raise InputError(f"{name}[{bad[0]}] ({names[bad[0]]}) is {vector[bad[0]]}", mend="give finite numbers")
        return vector

    def _table(self, name: str, value: ArrayLike) -> Array:
        """Value as a contiguous float64 array (B, n) of finite numbers, (B, nq) of positions."""
        n = self.nq if name == "Q" else self.n
        try:
            table = np.ascontiguousarray(value, dtype=np.float64)
        except (TypeError, ValueError):
            raise InputError(f"{name} is not an array of numbers", mend=f"give shape (B, {n})") from None
        if table.ndim != 2 or table.shape[1] != n:
            raise InputError(f"{name} has shape {table.shape}", mend=f"give shape (B, {n}), one state a row")
        if not finite(table):
            row, column = np.argwhere(~np.isfinite(table))[0]
            raise InputError(f"{name}[{row}, {column}] is {table[row, column]}", mend="give finite numbers")
        if name == "Q" and self._chart is not None:
            self._chart.refuse_zero(table)
        return table

    def _same_length(self, **tables: Array) -> None:
        lengths = {name: len(table) for name, table in tables.items()}
        if len(set(lengths.values())) > 1:
            said = ", ".join(f"{name} {length}" for name, length in lengths.items())
            raise InputError(f"numbers of states differ: {said}", mend="give one row a state in each")

    def _again(self, status: int, short: Any, which: int, **vectors: ArrayLike) -> Array:
        """What the short way refused: convert and check, then compute or say why not."""
        checked = [
            self.position(name, value) if name == "q" else self.vector(name, value) for name, value in vectors.items()
        ]
        out = np.empty(self.n)
        if status == NOT_PLAIN:
            status = short(self._model, *checked, out)
        if status == NOT_PLAIN:
            # No short way in this process.
            q, qd, third = checked
            status = call_rows(int(self._header[which]), self._model, q[None], qd[None], third[None], out[None])
        if status > 0:
            raise self.singular(status)
        if status == NOT_FINITE or not np.isfinite(out).all():
            raise InputError("the result is not finite", mend="the state or the parameters are far too large")
        return out

    def _under_wrenches(self, method: Any, q: ArrayLike, wrenches: ArrayLike, *arguments: Any) -> Array:
        """Call a method while external wrenches act."""
        external = np.asarray(wrenches, dtype=np.float64)
        links = self.system.links
        if external.shape != (len(links), 6) or not np.isfinite(external).all():
            raise InputError(
                f"wrenches of shape {external.shape}, or not finite",
                mend=f"give finite moment and force for each of the {len(links)} links, shape ({len(links)}, 6)",
            )
        self._kernels.locate(*self._arguments, *self._lowered(q, self._zero))
        rows = self.tree.rows
        for link, wrench in zip(links, external, strict=True):
            seat = self.tree.seats[link.name]
            if seat.body > 0 and wrench.any():
                arm = rows[seat.body, TURN : TURN + 9].reshape(3, 3) @ seat.origin
                rows[seat.body, EXTERNAL : EXTERNAL + 3] += wrench[:3] + np.cross(arm, wrench[3:])
                rows[seat.body, EXTERNAL + 3 : EXTERNAL + 6] += wrench[3:]
        forward, self._header[FORWARD] = int(self._header[FORWARD]), self._header[RECURSION]
        try:
            result: Array = method(q, *arguments)
        finally:
            self._header[FORWARD] = forward
            rows[:, EXTERNAL : EXTERNAL + 6] = 0.0
        return result


def _declined(*_: Any) -> int:
    """In place of a short way in, where there is none."""
    return NOT_PLAIN


def _some(names: Sequence[str], most: int = 6) -> str:
    return ", ".join(names[:most]) + (" …" if len(names) > most else "")
