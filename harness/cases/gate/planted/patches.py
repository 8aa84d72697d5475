"""Faults planted in the code itself: one line of it, as it might go wrong, and what the gate must say.

Sources are found by the name of the file and the text, so that a file may move; a test holds that each text stands there
once. ``cases``: what is run; ``words``: must stand in what the gate says of the rows that fail, all of them.
"""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Patch:
    """One line of one file made wrong."""

    name: str
    file: str
    old: str
    new: str
    cases: tuple[str, ...]
    words: tuple[str, ...]


def _of(file: str, cases: str, *faults: tuple[str, str, str, str]) -> tuple[Patch, ...]:
    """Faults of one file: name, old, new, words (separated by a semicolon)."""
    return tuple(
        Patch(f"{file}: {name}", file, old, new, tuple(cases.split()), tuple(words.split("; ")))
        for name, old, new, words in faults
    )


READERS = (
    *_of(
        "rotation.py", "file_urdf_general",
        ("roll, pitch and yaw in the other order", "roll, pitch, yaw = np.asarray(rpy", "yaw, pitch, roll = np.asarray(rpy",
         "file_mass_matrix; readers"),
        ("pitch with the other sign", "[-sp, cp * sr, cp * cr],", "[sp, cp * sr, cp * cr],", "file_mass_matrix; readers"),
    ),
    *_of(
        "rotation.py", "file_mjcf_general",
        ("a quaternion's matrix with one sign wrong", "[2 * (x * y + w * z), 1", "[2 * (x * y - w * z), 1",
         "file_mass_matrix; readers"),
    ),
    *_of(
        "read_urdf.py", "file_urdf_general",
        ("products of inertia exchanged", "tensor = np.array([[xx, xy, xz], [xy, yy, yz]",
         "tensor = np.array([[xx, xz, xy], [xz, yy, yz]", "file_mass_matrix; readers"),
        ("inertia turned the other way", "np.asarray(rotation) @ tensor @ np.asarray(rotation).T",
         "np.asarray(rotation).T @ tensor @ np.asarray(rotation)", "file_mass_matrix; readers"),
        ("half the damping", "return values[0], values[1]", "return 0.5 * values[0], values[1]", "file_passive; readers"),
        ("upper limit read from effort", 'self._limit(limit, "upper", 0.0, owner)', 'self._limit(limit, "effort", 0.0, owner)',
         "file_limits"),
        ("lower limit forgotten", 'lower = self._limit(limit, "lower", 0.0, owner)', "lower = -np.inf", "file_limits"),
        ("origins without rotation", "return xyz, constant(from_rpy(self.numbers(origin, \"rpy\", 3, zero, owner)))\n        if not",
         "return xyz, constant(np.eye(3))\n        if not", "file_mass_matrix; readers"),
        ("a thousandth more mass", 'mass = self.number(mass_element, "value", None, owner)',
         'mass = 1.001 * self.number(mass_element, "value", None, owner)', "file_mass_matrix; readers"),
    ),
    *_of(
        "read_mjcf.py", "file_mjcf_general",
        ("offset of a joint in its body left out", "xyz = model.body_pos[b] + body_in_link[parent]", "xyz = model.body_pos[b]",
         "file_mass_matrix; readers"),
        ("inertia turned the other way", "axes @ np.diag(model.body_inertia[b]) @ axes.T",
         "axes.T @ np.diag(model.body_inertia[b]) @ axes", "file_mass_matrix; readers"),
        ("centre of mass not from the joint", "com=constant(model.body_ipos[b] - anchor)", "com=constant(model.body_ipos[b])",
         "file_mass_matrix; readers"),
        ("armature forgotten", "armature=float(model.dof_armature[dof]) + driven.armature,", "armature=0.0,", "file_mass_matrix; readers"),
        ("springs twice as stiff", "stiffness=float(model.jnt_stiffness[k]) if",
         "stiffness=2.0 * float(model.jnt_stiffness[k]) if",
         "file_passive; readers"),
        ("springs slack on the other side", "rest_position=float(model.qpos_spring[coordinate])",
         "rest_position=-float(model.qpos_spring[coordinate])", "file_passive; readers"),
        ("damping forgotten", "damping=float(model.dof_damping[dof]) + driven.damping[0] if dampers else 0.0", "damping=0.0",
         "file_passive; readers"),
        ("upper limit for lower", "upper=float(model.jnt_range[k, 1])", "upper=float(model.jnt_range[k, 0])", "file_limits"),
        ("a joint's place in its body not turned", "place = xyz + rotation @ model.jnt_pos[k] if",
         "place = xyz + model.jnt_pos[k] if",
         "file_mass_matrix; readers"),
    ),
    *_of(
        "flexible_link.py", "file_toml_flexible_pendulum",
        ("half the thickness forgotten to be half", "self.half_depth = self.thickness / 2.0", "self.half_depth = self.thickness",
         "file_half_depth"),
        ("a hundredth more thickness", "self.area, second, second2 = w * t, w * t**3 / 12.0, t * w**3 / 12.0",
         "self.area, second, second2 = w * t, w * (1.01 * t) ** 3 / 12.0, t * w**3 / 12.0", "file_frequency"),
        ("a thousandth more stiffness", "self.stiffness = self.youngs_modulus * second",
         "self.stiffness = 1.001 * self.youngs_modulus * second", "file_frequency"),
    ),
)  # fmt: skip

ADAPTERS = (
    *_of(
        "pinocchio_model.py", "chain_7",
        ("gravity a thousandth too strong", "model.gravity.linear = np.array(system.gravity)",
         "model.gravity.linear = 1.001 * np.array(system.gravity)", "gravity; pinocchio"),
        ("damping a hundredth too strong", "return -self.damping * qd", "return -1.01 * self.damping * qd",
         "damping; pinocchio"),
        ("armature a tenth too small", "armature.append(joint.armature)", "armature.append(0.9 * joint.armature)",
         "armature; pinocchio"),
        ("energy without armature", "kinetic += 0.5 * float(self.armature @ qd**2)", "kinetic += 0.0", "energy; pinocchio"),
        ("inverse dynamics with passive forces twice", "return self.axes.out(q, tau) - self._passive(q, qd)",
         "return self.axes.out(q, tau) - 2.0 * self._passive(q, qd)", "inverse_dynamics; pinocchio"),
        ("masses a thousandth too large", "pin.Inertia(float(link.mass),", "pin.Inertia(1.001 * float(link.mass),",
         "mass; pinocchio"),
        ("axes turned round", "kind(np.array(joint.axis))", "kind(-np.array(joint.axis))", "mass; pinocchio"),
    ),
    *_of(
        "pinocchio_model.py", "joint_springs",
        ("springs slack on the other side", "self.stiffness * (x - self.rest) + self",
         "self.stiffness * (x + self.rest) + self",
         "stiffness; pinocchio"),
    ),
    *_of(
        "mujoco_model.py", "chain_7",
        ("centres of mass a tenth of a millimetre off", "ipos=np.array(link.com),", "ipos=np.array(link.com) + 1e-4,",
         "mass; mujoco"),
        ("armature forgotten", "springref=slack,\n                armature=joint.armature,",
         "springref=slack,\n                armature=0.0,", "armature; mujoco"),
        ("damping a tenth too strong", "damping=np.array([joint.damping, drag", "damping=np.array([1.1 * joint.damping, drag",
         "damping; mujoco"),
        ("arms a thousandth too long", "pos=np.array(joint.xyz),", "pos=1.001 * np.array(joint.xyz),", "mass; mujoco"),
        ("masses a thousandth too large", "model.body_mass[body] = link.mass", "model.body_mass[body] = 1.001 * link.mass",
         "mass; mujoco"),
        ("gravity with the other sign", "spec.option.gravity = np.array(system.gravity)",
         "spec.option.gravity = -np.array(system.gravity)", "gravity; mujoco"),
    ),
    *_of(
        "mujoco_model.py", "joint_springs",
        ("springs slack at zero", "springref=slack", "springref=0.0", "stiffness; mujoco"),
        ("springs twice as stiff", "stiffness=np.array([joint.stiffness,", "stiffness=np.array([2.0 * joint.stiffness,",
         "stiffness; mujoco"),
    ),
    *_of(
        "exudyn_rigid_model.py", "chain_7",
        ("damping a hundredth too strong", "jointDControlVector=np.array([joint.damping for",
         "jointDControlVector=np.array([1.01 * joint.damping for", "damping; exudyn"),
        ("inverse dynamics with a sign wrong", "return mass @ qdd - right", "return mass @ qdd + right",
         "inverse_dynamics; exudyn"),
    ),
    *_of(
        "exudyn_ancf.py", "beam_paths",
        ("payload without weight", "load = [*(beam.payload * self.chain.gravity), 0.0]",
         "load = [*(0.0 * self.chain.gravity), 0.0]", "payload_weight; exudyn_ancf"),
    ),
)  # fmt: skip

NATIVE = (
    *_of(
        "tree.py", "chain_7",
        ("joints a thousandth too far out", "row[OFFSET : OFFSET + 3] = origin", "row[OFFSET : OFFSET + 3] = 1.001 * origin",
         "mass; denoc"),
        ("armature a hundredth too large", "= joint.armature, joint.damping",
         "= 1.01 * joint.armature, joint.damping", "armature"),
        ("damping a hundredth too large", "= joint.armature, joint.damping", "= joint.armature, 1.01 * joint.damping",
         "damping"),
        ("gravity a thousandth too strong", "ACCELERATION + 6] = -np.asarray(system.gravity)",
         "ACCELERATION + 6] = -1.001 * np.asarray(system.gravity)", "gravity"),
        ("first moments a thousandth too large", "row[MOMENT : MOMENT + 3] += link.mass * com",
         "row[MOMENT : MOMENT + 3] += 1.001 * link.mass * com", "mass"),
        ("inertia turned the other way", "inertia=rotation @ link.inertia @ rotation.T)",
         "inertia=rotation.T @ link.inertia @ rotation)", "mass"),
    ),
    *_of(
        "tree.py", "joint_springs",
        ("springs slack on the other side", "= joint.stiffness, joint.rest_position", "= joint.stiffness, -joint.rest_position",
         "stiffness"),
        ("springs a hundredth too stiff", "= joint.stiffness, joint.rest_position",
         "= 1.01 * joint.stiffness, joint.rest_position",
         "stiffness"),
    ),
    *_of(
        "tree.py", "spatial_quantities",
        ("a link's frame turned the other way", "seats[link.name] = Seat(body, axes.T, np.zeros(3))",
         "seats[link.name] = Seat(body, axes, np.zeros(3))", "link_pose"),
    ),
    *_of(
        "tree.py", "welded_tree",
        ("welded bodies turned the other way", "_add_inertia(rows[seat.body], link, rotation, origin)",
         "_add_inertia(rows[seat.body], link, rotation.T, origin)", "mass; denoc"),
    ),
    *_of(
        "lanes/rows.py", "batch_tree",
        ("welded bodies turned in the other order", "_multiply(turn[up], placed, whole)", "_multiply(placed, turn[up], whole)",
         "batch"),
    ),
    *_of(
        "dynamics_call.py", "batch_flexible",
        ("every row under the first row's forces",
         "call(function, model, q[k].ctypes.data, qd[k].ctypes.data, third[k].ctypes.data, out[k].ctypes.data)",
         "call(function, model, q[k].ctypes.data, qd[k].ctypes.data, third[0].ctypes.data, out[k].ctypes.data)", "batch_straight"),
        ("every row at the first row's speed",
         "call(function, model, q[k].ctypes.data, qd[k].ctypes.data, third[k].ctypes.data, out[k].ctypes.data)",
         "call(function, model, q[k].ctypes.data, qd[0].ctypes.data, third[k].ctypes.data, out[k].ctypes.data)", "batch_straight"),
    ),
    *_of(
        "model.py", "spatial_quantities",
        ("external forces a hundredth too large", "EXTERNAL + 6] += wrench[3:]", "EXTERNAL + 6] += 1.01 * wrench[3:]",
         "wrenches"),
        ("external moments left out", "EXTERNAL + 3] += wrench[:3] +", "EXTERNAL + 3] += 0.0 * wrench[:3] +", "wrenches"),
    ),
    *_of(
        "model.py", "chain_7",
        ("gravity a thousandth too strong in its own answer", "return self.bias(q, self._zero)",
         "return 1.001 * self.bias(q, self._zero)", "gravity"),
        ("energies exchanged", "return float(kinetic), float(potential)", "return float(potential), float(kinetic)", "energy"),
    ),
    *_of(
        "model.py", "file_urdf_general",
        ("passive forces with the other sign", "subtract_passive(*self._arguments, q, qd, out)\n        return -out",
         "subtract_passive(*self._arguments, q, qd, out)\n        return out", "file_passive"),
    ),
    *_of(
        "model.py", "beam_paths",
        ("beams a hundredth too stiff in the linear forces", "= data.K, data.C", "= 1.01 * data.K, data.C",
         "static_deflection"),
    ),
    *_of(
        "motion/fixed_step.py", "integrators",
        ("a stage of Runge-Kutta in the wrong place", "ahead = h if stage == 2 else 0.5 * h",
         "ahead = h if stage == 2 else 0.45 * h",
         "rk4"),
        ("a weight of Gauss-Legendre wrong", "GAUSS_B = np.array([5.0 / 18.0, 4.0 / 9.0, 5.0 / 18.0])",
         "GAUSS_B = np.array([5.0 / 18.0 + 1e-5, 4.0 / 9.0, 5.0 / 18.0 - 1e-5])", "gauss"),
    ),
)  # fmt: skip

BEAMS = (
    *_of(
        "beam/integrals.py", "beam_paths frequencies_clamped_free",
        ("material damping twice", "beam.material_damping * stiffness", "2.0 * beam.material_damping * stiffness",
         "material_damping"),
        ("modal damping half", "(weighted * (2.0 * ratios", "(weighted * (1.0 * ratios", "modal_damping"),
        ("the second plane as stiff as the first", "(BENDING2, beam.bending_stiffness2, curvature)",
         "(BENDING2, beam.bending_stiffness, curvature)", "second_plane"),
        ("torsion a hundredth too stiff", "(TORSION, beam.torsional_stiffness, slope)",
         "(TORSION, 1.01 * beam.torsional_stiffness, slope)", "torsion"),
        ("polar inertia a hundredth too large", "polar_inertia=beam.polar_inertia,", "polar_inertia=1.01 * beam.polar_inertia,",
         "torsion"),
        ("payload a tenth too light", "payload=beam.payload,", "payload=0.9 * beam.payload,", "payload"),
        ("payload without inertia", "payload_inertia=np.array(beam.payload_inertia)",
         "payload_inertia=0.0 * np.array(beam.payload_inertia)", "payload_inertia"),
        ("gauges on the whole depth", "half_depth=beam.half_depth", "half_depth=2.0 * beam.half_depth", "root_strain"),
        ("a hundredth too heavy", "rho=beam.mass / beam.length", "rho=1.01 * beam.mass / beam.length", "frequency; mode"),
        ("a hundredth too stiff", "(BENDING, beam.bending_stiffness, curvature)",
         "(BENDING, 1.01 * beam.bending_stiffness, curvature)",
         "frequency; mode"),
    ),
    *_of(
        "channels.py", "beam_paths",
        ("strain with the other sign", '.root_strain"] = data.half_depth * curvature',
         '.root_strain"] = -data.half_depth * curvature',
         "root_strain"),
        ("tip acceleration without the beam's own", "+ 2.0 * np.cross(spin, rate) + second", "+ 2.0 * np.cross(spin, rate)",
         "tip_acceleration"),
        ("tip deflection a hundredth too large", "tip = b[:, bends] @ data.tip.s[bends] +",
         "tip = 1.01 * b[:, bends] @ data.tip.s[bends] +", "root_strain"),
    ),
)  # fmt: skip

LANES = (
    *_of(
        "lanes/model.py", "lanes_chain lanes_tree",
        ("rigid parts a thousandth too heavy", "row[at + 6 : at + 16] = _rigid_part(link)",
         "row[at + 6 : at + 16] = 1.001 * _rigid_part(link)", "lanes_adaptive; so it is the lanes"),
        ("gravity a thousandth too strong", "row[0:3] = system.gravity", "row[0:3] = 1.001 * system.gravity",
         "lanes_adaptive; so it is the lanes"),
        ("armature forgotten", "row[places] = joint.armature, joint.damping", "row[places] = 0.0, joint.damping",
         "lanes_adaptive; so it is the lanes"),
        ("damping a hundredth too strong", "row[places] = joint.armature, joint.damping",
         "row[places] = joint.armature, 1.01 * joint.damping", "lanes_adaptive; so it is the lanes"),
        ("springs slack at zero", "joint.friction, joint.stiffness, joint.rest_position",
         "joint.friction, joint.stiffness, 0.0",
         "lanes_adaptive; so it is the lanes"),
        ("joints a millimetre off", "row[at : at + 3] = joint.xyz", "row[at : at + 3] = joint.xyz + 1e-3",
         "lanes_adaptive; so it is the lanes"),
    ),
    *_of(
        "lanes/model.py", "integrators",
        ("an end of a step with a weight wrong", "table[stages, :stages] = source.B",
         "table[stages, :stages] = source.B * 1.0001",
         "lanes"),
    ),
    *_of(
        "joint_laws/address.py", "joint_laws",
        ("teeth a hundredth too stiff", "push = p[1] * beyond", "push = 1.01 * p[1] * beyond", "play; hub"),
    ),
    *_of(
        "laws.py", "joint_laws",
        ("damping with the other sign", "- load(laws, start + DAMPING * 8) * v", "+ load(laws, start + DAMPING * 8) * v",
         "damping; hub"),
        ("springs slack at zero", "(q - load(laws, start + REST * 8))", "(q + load(laws, start + REST * 8))", "spring; hub"),
        ("cubic springs square", "load(laws, start + CUBIC * 8) * (q * q * q)", "load(laws, start + CUBIC * 8) * (q * q)",
         "cubic_spring; hub"),
        ("drag linear", "load(laws, start + DRAG * 8) * (v * v) * direction", "load(laws, start + DRAG * 8) * v",
         "quadratic_drag; hub"),
        ("cogging a hundredth too strong", "load(laws, start + COGGING_AMPLITUDE * 8) * s",
         "1.01 * load(laws, start + COGGING_AMPLITUDE * 8) * s", "cogging; hub"),
        ("friction that creeps at half the speed", "twice = 2.0 * magnitude(v)", "twice = 4.0 * magnitude(v)", "creep; hub"),
        ("stops that damp with the other sign", "push = push + load(laws, start + STOP_DAMPING * 8)",
         "push = push - load(laws, start + STOP_DAMPING * 8)", "stop; hub"),
        ("static friction that never falls", "level = level + extra * exponential(-choose",
         "level = level + extra + 0.0 * exponential(-choose",
         "stribeck; hub"),
        ("Dahl's friction half as stiff", "inverse = choose(torque * stiffness, stiffness, 0.0)",
         "inverse = 0.5 * choose(torque * stiffness, stiffness, 0.0)", "dahl; hub"),
        ("a constant torque a hundredth too large", "load(laws, start + CONSTANT * 8)\n",
         "1.01 * load(laws, start + CONSTANT * 8)\n", "constant_torque; hub"),
    ),
)  # fmt: skip

KERNELS = (
    *_of(
        "rigid.py", "chain_7",
        ("half of a slider's Coriolis acceleration", "hx = wy * rz - wz * ry + 2.0 * v * zx",
         "hx = wy * rz - wz * ry + 1.0 * v * zx",
         "coriolis"),
        ("inverse dynamics without armature", "tau[i - 1] = along + d[i, ARMATURE] * qdd[i - 1]", "tau[i - 1] = along",
         "armature"),
        ("kinetic energy without armature", "+ vz * fz + d[i, ARMATURE] * v * v", "+ vz * fz", "energy"),
        ("hinges without armature in forward dynamics", "pivot = u0 * zx + u1 * zy + u2 * zz + d[i, ARMATURE]",
         "pivot = u0 * zx + u1 * zy + u2 * zz", "forward dynamics; denoc"),
    ),
    *_of(
        "rigid.py", "spatial_quantities",
        ("momentum without the arm", "lx + nx + y * fz - z * fy", "lx + nx + y * fz", "momentum"),
        ("a Coriolis matrix without the turning of axes", "rate = oy * zz - oz * zy,", "rate = oy * zz,", "coriolis"),
    ),
)  # fmt: skip

SENSORS = _of(
    "measurement.py", "sensor_models",
    ("offset with the other sign", "return signal + params[:, :1]\n", "return signal - params[:, :1]\n", "sensor_offset"),
    ("gain twice", "return signal * params[:, :1]\n", "return signal * params[:, :1] ** 2\n", "sensor_gain"),
    ("drift a hundredth too fast", "return signal + params[:, :1] * time", "return signal + 1.01 * params[:, :1] * time",
     "sensor_drift"),
    ("cubic term forgotten", "(params[:, :1] + signal * params[:, 1:2])", "(params[:, :1])", "sensor_nonlinearity"),
    ("phase of a periodic error forgotten", "np.sin(params[:, 1:2] * signal + params[:, 2:3])",
     "np.sin(params[:, 1:2] * signal)", "sensor_periodic_error"),
    ("hum as a cosine", "amplitude · sin(2π frequency · time); params: amplitude [channel unit], frequency [Hz].\"\"\"\n"
     "    return signal + hum_courses(time, params, np.zeros(1))[0]",
     "\"\"\"\n    return signal + hum_courses(time, params, np.zeros(1))[1]", "sensor_hum"),
    ("saturation on one side", "np.clip(signal, -params[:, :1], params[:, :1])", "np.minimum(signal, params[:, :1])",
     "sensor_saturation"),
    ("steps cut off rather than rounded", "np.round(signal / safe) * safe", "np.floor(signal / safe) * safe",
     "sensor_quantisation"),
    ("a dead zone twice as wide", "np.maximum(np.abs(signal) - params[:, :1], 0.0)",
     "np.maximum(np.abs(signal) - 2.0 * params[:, :1], 0.0)", "sensor_deadzone"),
    ("delays that run ahead", "shifted = resample(signal, time, time[None, :] - params[:, :1])",
     "shifted = resample(signal, time, time[None, :] + params[:, :1])", "sensor_delay"),
    ("efforts that are not delayed", "np.clip(time[None, :] - params[:, :1], time[0]",
         "np.clip(time[None, :] + 0.0 * params[:, :1], time[0]",
     "sensor_held_delay"),
    ("clocks that run the other way", "time[None, :] / params[:, :1])", "time[None, :] * params[:, :1])", "sensor_clock_skew"),
    ("cutoffs in radians a second", "1.0 / (2.0 * np.pi * np.maximum(params[:, 0], 1e-12))",
     "1.0 / np.maximum(params[:, 0], 1e-12)", "sensor_lowpass"),
)  # fmt: skip

PATCHES: tuple[Patch, ...] = (*READERS, *ADAPTERS, *NATIVE, *BEAMS, *SENSORS, *LANES, *KERNELS)
