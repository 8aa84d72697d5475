"""Faults in readers: of models, every number of which has a row, and of recordings, every format of which has one."""

from __future__ import annotations

from harness.cases.gate.planted.patch import of_file

MODELS = (
    *of_file(
        "read_urdf.py", "file_urdf_fields",
        ("friction forgotten", "return values[0], values[1]", "return values[0], 0.0", "file_fields; friction @ hip"),
        ("what a joint follows read upside down", "return Mimic(str(mimic.get(\"joint\")), multiplier, offset)",
         "return Mimic(str(mimic.get(\"joint\")), 1.0 / multiplier, offset)", "file_fields; mimic.multiplier @ spin"),
        ("quaternions with w first", "constant(from_quaternion((w, x, y, z)))", "constant(from_quaternion((x, y, z, -w)))",
         "file_fields; rotation @ rail"),
        ("an axis that is not told taken as z", "return constant([1.0, 0.0, 0.0])  # the format's default", "return constant([0.0, 0.0, 1.0])",
         "file_fields; axis @ rail"),
        ("axes that are not made units", "return constant(np.asarray(axis) / length)", "return constant(np.asarray(axis))",
         "file_fields; axis @ hip"),
        ("speeds read from efforts", 'self._limit(limit, "velocity", np.inf, owner)', 'self._limit(limit, "effort", np.inf, owner)',
         "file_fields; velocity @ hip"),
    ),
    *of_file(
        "read_mjcf.py", "file_mjcf_fields",
        ("dry friction forgotten", "friction=float(model.dof_frictionloss[dof]) if dry else 0.0", "friction=0.0", "file_fields; friction @ hip"),
        ("the pose that is drawn taken as zero", "turn = turn @ about_axis(axis, -reference)", "turn = turn @ about_axis(axis, 0.0)",
         "file_fields; rotation @ hip"),
        ("drag beyond linear lost", 'effects += [Attachment("quadratic_drag", name, {"coefficient": drag})] if drag else []',
         'effects += [Attachment("quadratic_drag", name, {"coefficient": 0.5 * drag})] if drag else []', "file_fields; quadratic_drag @ rail"),
        ("half of a stiffening spring", 'Attachment("cubic_stiffness", name, {"stiffness": cubic})',
         'Attachment("cubic_stiffness", name, {"stiffness": 0.5 * cubic})', "file_fields; cubic_stiffness @ rail"),
        ("efforts of the lower side", "effort=float(np.abs(model.jnt_actfrcrange[k]).max())", "effort=float(np.abs(model.jnt_actfrcrange[k]).sum())",
         "file_fields; effort @ hip"),
        ("gravity's other sign", "(1.0 - uniform_compensation(model)) * model.opt.gravity", "(uniform_compensation(model) - 1.0) * model.opt.gravity",
         "file_fields; gravity @ -"),
    ),
    *of_file(
        "mjcf_actuators.py", "file_mjcf_fields",
        ("ranges without the gear", "ends = np.sort(gear * np.asarray(model.actuator_forcerange[i]", "ends = np.sort(1.0 * np.asarray(model.actuator_forcerange[i]",
         "file_fields; lower @ drive"),
        ("forces without the gear", "return gear * float(data.actuator_force[output])", "return float(data.actuator_force[output])",
         "file_fields; gain @ drive"),
    ),
    *of_file(
        "read_toml.py", "file_toml_fields",
        ("rotations left out", 'rotation = constant(from_rpy(origin.vector("rpy", (0.0, 0.0, 0.0))))',
         'origin.vector("rpy", (0.0, 0.0, 0.0))', "file_fields; rotation @ hip"),
        ("armature from damping", 'armature=table.number("armature", 0.0, non_negative=True)',
         'armature=table.number("armature", 0.0, non_negative=True) * 2.0', "file_fields; armature @ hip"),
        ("rest of the spring forgotten", 'rest_position=table.number("rest_position", 0.0)', 'rest_position=0.0 * table.number("rest_position", 0.0)',
         "file_fields; rest_position @ hip"),
        ("pitch a turn, not a radian", 'pitch = table.number("pitch", mend=', 'pitch = 0.159 * table.number("pitch", mend=', "file_fields; pitch @ screw"),
        ("second axis from the first", 'axis2 = table.direction("axis2", mend="add axis2 = [0, 1, 0], in the joint frame")',
         'axis2 = table.direction("axis2", mend="add axis2 = [0, 1, 0], in the joint frame")[::-1].copy()', "file_fields; axis2 @ cross"),
        ("centre of mass mirrored", 'com=table.vector("com", (0.0, 0.0, 0.0)),', 'com=-table.vector("com", (0.0, 0.0, 0.0)),', "file_fields; com @ a"),
        ("gravity that always is the Earth's", 'gravity = top.vector("gravity", STANDARD_GRAVITY)', 'gravity = 0.0 * top.vector("gravity", STANDARD_GRAVITY)',
         "file_fields; gravity @ -"),
        ("offsets of followers forgotten", 'inner.number("multiplier", 1.0), inner.number("offset", 0.0))',
         'inner.number("multiplier", 1.0), 0.0 * inner.number("offset", 0.0))', "file_fields; mimic.offset @ screw"),
    ),
    *of_file(
        "system/table.py", "file_toml_fields",
        ("products of inertia in URDF's order", "xy, xz, yz = products or (0.0, 0.0, 0.0)", "xy, yz, xz = products or (0.0, 0.0, 0.0)",
         "file_fields; inertia @ a"),
    ),
    *of_file(
        "toml_loops.py", "file_toml_loop",
        ("frames that are not turned", 'constant(from_rpy(inner.vector("rpy", (0.0, 0.0, 0.0))))', 'constant(from_rpy(0.0 * inner.vector("rpy", (0.0, 0.0, 0.0))))',
         "file_fields; first.rotation @ cut"),
    ),
    *of_file(
        "flexible_link.py", "file_toml_fields",
        ("the second plane from the first", "self.area, second, second2 = w * t, w * t**3 / 12.0, t * w**3 / 12.0",
         "self.area, second, second2 = w * t, w * t**3 / 12.0, w * t**3 / 12.0", "file_fields; bending_stiffness2 @ rod"),
        ("polar moment of one plane", "self.polar_moment = second + second2", "self.polar_moment = second2", "file_fields; polar_inertia @ rod"),
        ("torsion of an open section", "return a * b**3 * (16.0 / 3.0 - 3.36 * b / a", "return a * b**3 * (16.0 / 3.0 - 0.0 * b / a", "file_torsion; torsional_stiffness @ rod"),
        ("a shear modulus without Poisson", "return self.youngs_modulus / (2.0 * (1.0 + ratio))", "return self.youngs_modulus / 2.0", "file_torsion; torsional_stiffness @ rod"),
        ("stiffening on whatever is said", 'geometric_stiffening=table.flag("geometric_stiffening", True)',
         'geometric_stiffening=table.flag("geometric_stiffening", True) or True', "file_fields; geometric_stiffening @ rod"),
        ("material damping halved", 'self.damping = material.number("damping", 0.0, non_negative=True)',
         'self.damping = 0.5 * material.number("damping", 0.0, non_negative=True)', "file_fields; material_damping @ rod"),
    ),
    *of_file(
        "lowering.py", "joints_that_follow",
        ("followers from the leader's zero", "offset += multiplier * mimic.offset", "offset += 0.0 * multiplier * mimic.offset",
         "followers_place; mimic @ finger"),
    ),
)  # fmt: skip

RECORDINGS = (
    *of_file(
        "recording/units.py", "recording_files",
        ("factors upside down", "size = float(given.to(goal.units).magnitude)", "size = 1.0 / float(given.to(goal.units).magnitude)", "recording_csv; reader of csv @ -"),
    ),
    *of_file(
        "packing.py", "recording_files",
        ("offsets forgotten", "stored.astype(np.float64) * factor + shift", "stored.astype(np.float64) * factor", "recording_hdf5; reader of hdf5 @ hub.velocity"),
    ),
    *of_file(
        "ros_messages.py", "recording_files",
        ("nanoseconds taken as microseconds", "return seconds * 1_000_000_000 + rest", "return seconds * 1_000_000_000 + rest // 1000",
         "recording_mcap; reader of mcap @ time"),
        ("numbers of the joint before", "for joint, number in zip(joints, array, strict=True):", "for joint, number in zip(joints, array[::-1], strict=True):",
         "recording_mcap; reader of mcap @ -"),
    ),
    *of_file(
        "formats/matlab.py", "recording_files",
        ("fields of structures under another name", 'walk(f"{name}.{key}" if name else key, inner)',
         'walk(f"{name}.{key}" if name else key, -np.asarray(inner) if key == "effort" else inner)', "recording_matlab; reader of matlab @ hub.effort"),
    ),
    *of_file(
        "formats/netcdf.py", "recording_files",
        ("single precision", "value.astype(np.float64) for key", "value.astype(np.float32) for key", "recording_netcdf; reader of netcdf @ -"),
    ),
    *of_file(
        "formats/hdf5.py", "recording_files",
        ("units passed over", "units.update(dict.fromkeys(found, unit))", "units.update({})", "recording_hdf5; reader of hdf5 @ -"),
    ),
)  # fmt: skip

FILES = (*MODELS, *RECORDINGS)
