"""Faults in paths that the other files of faults leave out: single methods, laws of joints, joints in space, one format each."""

from __future__ import annotations

from harness.cases.gate.planted.patch import of_file

METHODS = (
    *of_file(
        "denoc/model.py", "chain_7",
        ("bias at the speed of the other way", "call_rows(int(self._bare[INVERSE]), int(self._bare.ctypes.data), q[None], qd[None], self._zero[None], out[None])",
         "call_rows(int(self._bare[INVERSE]), int(self._bare.ctypes.data), q[None], 1.001 * qd[None], self._zero[None], out[None])",
         "/bias/; coriolis @ -"),
    ),
    *of_file(
        "denoc/model.py", "batch_flexible",
        ("many states without forces", "forces = Tau if len(Tau) else np.zeros_like(Qd)", "forces = 0.5 * Tau if len(Tau) else np.zeros_like(Qd)",
         "forward_dynamics_batch; applied_force @ -"),
    ),
    *of_file(
        "manifold.py", "joints_in_space",
        ("turns in axes of the base", "turned = _rotation(q[at : at + 4]) * Rotation.from_rotvec(step[spin : spin + 3])",
         "turned = Rotation.from_rotvec(step[spin : spin + 3]) * _rotation(q[at : at + 4])", "manifold_integrate; manifold_integrate @ root|hip"),
        ("differences the other way round", "(_rotation(q0[at : at + 4]).inv() * _rotation(q1[at : at + 4])).as_rotvec()",
         "(_rotation(q1[at : at + 4]).inv() * _rotation(q0[at : at + 4])).as_rotvec()", "manifold_difference; manifold_difference @ root|hip"),
        ("rates of a quaternion with a sign wrong", "[w, -z, y], [z, w, -x], [-y, x, w]])", "[w, z, -y], [z, w, -x], [-y, x, w]])",
         "manifold_position_rates; manifold_position_rates @ root|hip"),
    ),
    *of_file(
        "batch/in_space.py", "batch_in_space",
        ("forces not turned to angles", "kernels.forces_to_turns(self._balls, self._damping, Qd[rows], Tau[rows], kept, forces)",
         "kernels.forces_to_turns(self._balls, self._damping, Qd[rows], 0.99 * Tau[rows], kept, forces)", "forward_dynamics_batch; applied_force @ -"),
        ("accelerations asked at the wrong gravity", "kernels.accelerations_to_turns(self._balls, self._gravity, Qdd[rows], rates, kept, asked)",
         "kernels.accelerations_to_turns(self._balls, 0.99 * self._gravity, Qdd[rows], rates, kept, asked)", "inverse_dynamics_batch; gravity @ -"),
        ("masses of angles, not of spins", "kernels.masses_from_turns(self._balls, kept, out[rows])", "pass", "mass_matrix_batch; mass_matrix @ hip"),
    ),
    *of_file(
        "batch/trunk.py", "batch_floating",
        ("a trunk whose joint resists less", "d = trunk[RESISTING]", "d = 0.99 * trunk[RESISTING]", "forward_dynamics_batch; damping @ root"),
        ("a trunk's axes carried along", "x, y, z = x + (wy * vz - wz * vy), y + (wz * vx - wx * vz), z + (wx * vy - wy * vx)\n", "\n",
         "forward_dynamics_batch; coriolis @ root"),
        ("a pivot of the trunk not less by another", "d2 = 1.0 / ayy", "d2 = 1.001 / ayy", "forward_dynamics_batch; mass_matrix @ root"),
    ),
    *of_file(
        "loops/closed.py", "four_bar",
        ("forces that are not the least", "forces = np.linalg.lstsq(complement @ directions, complement @ needed, rcond=1e-9)[0]",
         "forces = 1.001 * np.linalg.lstsq(complement @ directions, complement @ needed, rcond=1e-9)[0]", "inverse_dynamics; inverse_dynamics @ -"),
    ),
    *of_file(
        "motion/fixed_step.py", "integrators",
        ("forces that run straight where they are held", "tau[k + 1, i] - tau[k, i]) if linear else tau[k, i]",
         "tau[k + 1, i] - tau[k, i]) if linear or share > 0.4 else tau[k, i]", "force_zero; force between samples (zero) @ -"),
    ),
    *of_file(
        "recursion/rigid.py", "tree_20",
        ("kinetic energy without a product of speeds", "+ vz * fz + d[i, ARMATURE] * v * v", "+ 0.999 * vz * fz + d[i, ARMATURE] * v * v", "/energy/; mass_matrix @ -"),
    ),
    *of_file(
        "rigid_chain.py", "hinges_5",
        ("a base that does not accelerate across", "vectors[_BASE, :3] = tree.rows[0, ACCELERATION + 3 : ACCELERATION + 6]",
         "vectors[_BASE, :3] = 1.001 * tree.rows[0, ACCELERATION + 3 : ACCELERATION + 6]", "acceleration; gravity @ -"),
        ("a frame set on another with a sign wrong", "z + (r6 * u + r7 * v + r8 * w),", "z + (r6 * u + r7 * v - r8 * w),", "acceleration; mass_matrix @ -"),
    ),
    *of_file(
        "elastic.py", "geared_links",
        ("beams that bend to the other side", "axes = rotation @ np.column_stack([data.direction, data.bending, data.normal])",
         "axes = rotation @ np.column_stack([data.direction, -data.bending, -data.normal])", "tip_deflection; tip_deflection @ -"),
    ),
    *of_file(
        "lowering.py", "joints_that_follow",
        ("screws of half the pitch", "mimic=Mimic(joint.name, joint.pitch)", "mimic=Mimic(joint.name, 0.5 * joint.pitch)", "followers_place; pitch @ screw"),
    ),
    *of_file(
        "analytic.py", "rigid_pendulum",
        ("a closed form without armature", "inertia=float(joint.axis @ about_origin @ joint.axis) + joint.armature,",
         "inertia=float(joint.axis @ about_origin @ joint.axis),", "analytic; armature @ pivot"),
        ("weight a thousandth too strong", "gravity_force=0.0 if balanced else strength,", "gravity_force=0.0 if balanced else 1.001 * strength,",
         "analytic; gravity @ -"),
    ),
)  # fmt: skip

FORMATS = (
    *of_file(
        "numpy_arrays.py", "recording_files",
        ("names in another order", "found = as_columns(name, values) if name else {}", "found = as_columns(name, values[::-1]) if name else {}",
         "recording_numpy; reader of numpy @ -"),
    ),
    *of_file(
        "parquet.py", "recording_files",
        ("numbers in single precision", "numbers = pc.cast(column, pa.float64(), safe=False)", "numbers = pc.cast(column, pa.float32(), safe=False)",
         "recording_parquet; reader of parquet @ -"),
    ),
)  # fmt: skip

LAWS = of_file(
    "laws.py", "joint_laws",
    ("armature a hundredth too large", "inertia = load(laws, start + ARMATURE * 8)", "inertia = 1.01 * load(laws, start + ARMATURE * 8)", "joint_laws/armature; armature @ hub"),
    ("dry friction a hundredth too strong", "level = load(laws, start + COULOMB * 8)\n", "level = 1.01 * load(laws, start + COULOMB * 8)\n", "joint_laws/dry_friction; dry_friction @ hub"),
    ("friction half as much by load", "level = level + load(laws, start + MU_RADIUS * 8) * reaction", "level = level + 0.5 * load(laws, start + MU_RADIUS * 8) * reaction",
     "load_friction; load_friction @ axle"),
    ("soft friction that holds half as hard", "held = load(laws, start + SOFT_INERTIA * 8) / choose(time, time, 1.0) * v",
     "held = 0.5 * load(laws, start + SOFT_INERTIA * 8) / choose(time, time, 1.0) * v", "soft_friction; soft_friction @ hub"),
    ("cubic damping of the square", "force = force - load(laws, start + CUBIC_DAMPING * 8) * (v * v * v)", "force = force - load(laws, start + CUBIC_DAMPING * 8) * (v * v)",
     "polynomial; polynomial @ hub"),
    ("a one-sided spring without its cube", "(load(laws, start + SQUARE * 8) + load(laws, start + CUBE * 8) * x) * (x * x)", "load(laws, start + SQUARE * 8) * (x * x)",
     "polynomial; polynomial @ hub"),
    ("a spring slack at zero", "x = q - load(laws, start + SLACK * 8)", "x = q + load(laws, start + SLACK * 8)", "polynomial; polynomial @ hub"),
)  # fmt: skip

PLANE = of_file(
    "lanes/planar.py", "lanes_flexible_pendulum",
    ("half of the Coriolis acceleration of bending in the plane", "    twice = w + w\n", "    twice = w\n", "lanes_adaptive_planar; coriolis @ rod"),
)  # fmt: skip

BASE = of_file(
    "lanes/nodes.py", "joint_laws",
    ("a base that shakes out of step", "phase = load(ws, g + 24) * load(ws, group + TIME * 8) + load(ws, g + 32)",
     "phase = load(ws, g + 24) * load(ws, group + TIME * 8)", "base_excitation; base_excitation @ -"),
)  # fmt: skip

PATHS_LEFT = (*METHODS, *FORMATS, *LAWS, *PLANE, *BASE)
