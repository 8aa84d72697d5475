"""Faults in what bends: the integrals of a beam, its kernels, its sensors, and the engines of finite elements."""

from __future__ import annotations

from harness.cases.gate.planted.patch import of_file

INTEGRALS = (
    *of_file(
        "beam/integrals.py", "flexible_pendulum_as_printed",
        ("half of the foreshortening at every node", "H=_foreshortening(tuple(shapes), plane, x),",
         "H=0.5 * _foreshortening(tuple(shapes), plane, x),", "hanging_frequency; geometric_stiffening @ rod"),
    ),
    *of_file(
        "beam/integrals.py", "frequencies_pinned_hub",
        ("shapes that know of no hub", "inertia = joint.armature + float(axis", "inertia = float(axis", "frequency; shapes @ rod"),
    ),
    *of_file(
        "beam/integrals.py", "frequencies_tip_mass",
        ("shapes that know of no payload", "mass, moment = beam.payload, 0.0", "mass, moment = 0.0, 0.0", "frequency; shapes @ rod"),
    ),
    *of_file(
        "beam/integrals.py", "beam_paths",
        ("modal damping as if the root were held", "return mass - np.outer(coupling, coupling) / inertia", "return mass",
         "modal_damping_hinged; modal_damping @ rod"),
        ("modal damping that forgets the payload", "coupling = data.rho * (data.weights * arm) @ s + data.payload * reach * tip",
         "coupling = data.rho * (data.weights * arm) @ s", "modal_damping_hinged; modal_damping @ rod"),
        ("shapes that know of no rotary inertia at the tip", "inertia = float(axis @ beam.payload_inertia @ axis)", "inertia = 0.0",
         "payload_inertia_frequency; shapes @ rod"),
        ("twist that knows of no inertia at the tip", "tip = float(beam.direction @ beam.payload_inertia @ beam.direction)",
         "tip = 0.0", "torsion_payload_frequency; shapes @ rod"),
    ),
    *of_file(
        "beam/shapes.py", "beam_paths frequencies_pinned_free",
        ("shapes with a twentieth less shear at the tip", "shear = tip[3] + w * mount.mass * tip[0]",
         "shear = 0.95 * tip[3] + w * mount.mass * tip[0] + 0.05 * tip[2]", "frequency; shapes @ rod"),
        ("curvature a hundredth too large", "return (self.roots / self.length) ** 2 * self._derivative(station, 2)",
         "return 1.01 * (self.roots / self.length) ** 2 * self._derivative(station, 2)", "frequency; bending_stiffness @ rod"),
    ),
    *of_file(
        "elastic.py", "beam_paths",
        ("twist's inertia a hundredth too large", "inertia = polar * data.S1 * np.outer(twist, twist)",
         "inertia = 1.01 * polar * data.S1 * np.outer(twist, twist)", "torsion_frequency; polar_inertia @ rod"),
        ("a payload half as heavy among the points", "mass = np.append(data.rho * data.weights, data.payload)",
         "mass = np.append(data.rho * data.weights, 0.5 * data.payload)", "payload_inertia_frequency; payload @ rod"),
    ),
    *of_file(
        "elastic.py", "bent_in_space",
        ("payload left in the hub", "moment = mass * l / 2 + data.payload * l", "moment = mass * l / 2",
         "bent; payload @ upper"),
        ("sections that turn in the first plane alone", "station.slope * second,", "station.slope * first,",
         "mass_matrix_bent; mass_matrix @ upper|lower"),
        ("joints that all ride on the tip", "x = float(np.clip(origin @ direction, 0.0, data.length))", "x = data.length",
         "link_place; link_pose @ carriage"),
        ("the tip's inertia not in the beam's axes", "tip = local.T @ data.payload_inertia @ local", "tip = data.payload_inertia",
         "mass_matrix_bent; mass_matrix @ upper"),
    ),
    *of_file(
        "frequencies.py", "beam_paths rotating_cantilever",
        ("a weight of the difference wrong", "CENTRAL = ((1, 45.0 / 60.0), (2, -9.0 / 60.0)", "CENTRAL = ((1, 45.0 / 60.0), (2, -8.0 / 60.0)",
         "rotating_cantilever; linearization @ -"),
    ),
    *of_file(
        "static_correction.py", "beam_paths",
        ("a load at the end that bends a tenth less", "l**3 / 3.0 * force", "l**3 / 3.3 * force", "tip_deflection_at_rest; tip_deflection @ rod"),
        ("curvature of the distributed load left out", "curvature = x @ loads + l * force", "curvature = l * force",
         "root_strain_at_rest; root_strain @ rod"),
    ),
    *of_file(
        "channels.py", "bent_in_space",
        ("a tip that does not turn across", "c2, s2 = np.cos(b @ (slope * two)), np.sin(b @ (slope * two))",
         "c2, s2 = np.cos(0.0 * b @ (slope * two)), np.sin(0.0 * b @ (slope * two))", "tip_acceleration_bent; tip_acceleration @ upper"),
        ("half of the foreshortening's acceleration", "second = bdd @ shapes - quadratic(b, bdd)",
         "second = bdd @ shapes - 0.5 * quadratic(b, bdd)", "tip_acceleration_bent; tip_acceleration @ upper"),
    ),
)  # fmt: skip

FLEXIBLE_KERNELS = of_file(
    "recursion/flexible.py", "bent_in_space",
    ("sections that turn across without spin", "ox, oy, oz = ox + ax2 * two_rate, oy + ay2 * two_rate, oz + az2 * two_rate",
     "ox, oy, oz = ox + ax2 * (0.0 * two_rate), oy + ay2 * two_rate, oz + az2 * two_rate", "acceleration_bent; coriolis @ upper|lower"),
    ("half of the Coriolis acceleration of a slider on a beam",
     "tx, ty, tz = cross(ox, oy, oz, tx + 2.0 * slide * z0, ty + 2.0 * slide * z1, tz + 2.0 * slide * z2)\n    d[i, BIAS + 3]",
     "tx, ty, tz = cross(ox, oy, oz, tx + 1.0 * slide * z0, ty + 1.0 * slide * z1, tz + 1.0 * slide * z2)\n    d[i, BIAS + 3]",
     "acceleration_bent; coriolis @ rail"),
    ("half of the Coriolis acceleration of bending across", "t1 + 2.0 * ad, t2 + 2.0 * ud, t3 + 2.0 * wd)",
     "t1 + 2.0 * ad, t2 + 2.0 * ud, t3 + 1.0 * wd)", "acceleration_bent; coriolis @ upper|lower"),
    ("foreshortening with the other sign in the coupling", "v1, v2, v3 = -e[hb + k], e[at + 2 + k], e[at + 2 + m + k]",
     "v1, v2, v3 = e[hb + k], e[at + 2 + k], e[at + 2 + m + k]", "mass_matrix_bent; mass_matrix @ upper|lower"),
    ("a product of inertia of a bent beam with the other sign", "j13 - a * w, j23 - u * w", "j13 - a * w, j23 + u * w",
     "mass_matrix_bent; mass_matrix @ upper|lower|shoulder|elbow"),
    ("a payload's gyroscopic moment left out", "t1 += i11 * b1 + i12 * b2 + i13 * b3", "t1 += i11 * b1 + i12 * b2", "acceleration_bent; coriolis @ upper|shoulder"),
    ("discs of twist that turn the other way", "m2, m3 = m2 + spin * w3, m3 - spin * w2", "m2, m3 = m2 - spin * w3, m3 + spin * w2",
     "acceleration_bent; coriolis @ upper|lower"),
    ("beams that do not damp in forward dynamics", "e[k_at + k * m + l] * q[first + l] + e[c_at + k * m + l] * qd[first + l]",
     "e[k_at + k * m + l] * q[first + l] + 0.0 * e[c_at + k * m + l] * qd[first + l]", "acceleration_bent; damping @ upper|lower"),
    ("inverse dynamics without armature beside beams", "tau[own] = along + d[i, ARMATURE] * qdd[own]", "tau[own] = along",
     "inverse_dynamics_bent; armature @ shoulder|wrist"),
    ("beams of less elastic energy", "potential += 0.5 * e[k_at + k * m + l]", "potential += 0.4 * e[k_at + k * m + l]", "energy_bent; stiffness @ upper|lower"),
    ("springs slack at zero beside beams", "out[own] += d[i, DAMPING] * qd[own] + d[i, STIFFNESS] * (q[own] - d[i, REST])",
     "out[own] += d[i, DAMPING] * qd[own] + d[i, STIFFNESS] * q[own]", "bent; stiffness @ rail"),
    ("a column of the mass matrix without a moment", "value = nx * e[o] + ny * e[o + 1] + nz * e[o + 2] + fx",
     "value = nx * e[o] + ny * e[o + 1] + fx", "mass_matrix_bent; mass_matrix @ upper|lower"),
    ("momentum without the speed of bending", "vx += e[o + 3] * qd[first + k]", "vx += 0.0 * e[o + 3] * qd[first + k]", "momentum_bent; momentum @ upper|lower"),
    ("accelerometers that see half the spin", "out[k, 9 + c] = d[i, SPIN + c]", "out[k, 9 + c] = 0.5 * d[i, SPIN + c]",
     "tip_acceleration_bent; tip_acceleration @ upper"),
)  # fmt: skip

FINITE_ELEMENTS = (
    *of_file(
        "exudyn_ancf.py", "flexible_pendulum_as_printed",
        ("cables a hundredth too stiff", "bendingStiffness=beam.bending_stiffness,", "bendingStiffness=1.01 * beam.bending_stiffness,",
         "frequency; exudyn_ancf; bending_stiffness @ rod"),
        ("cables a hundredth too heavy", "massPerLength=beam.mass / beam.length,", "massPerLength=1.01 * beam.mass / beam.length,",
         "frequency; exudyn_ancf; mass @ rod"),
        ("half of the hub", "hub, loss = link.joint.armature, link.joint.damping", "hub, loss = 0.5 * link.joint.armature, link.joint.damping",
         "frequency; exudyn_ancf; armature @ pivot"),
    ),
    *of_file(
        "exudyn_ancf.py", "beam_paths",
        ("a payload half as heavy", "massMatrix=np.diag([beam.payload, beam.payload, turning, turning])",
         "massMatrix=np.diag([0.5 * beam.payload, 0.5 * beam.payload, turning, turning])", "payload_weight; exudyn_ancf; payload @ rod"),
    ),
    *of_file(
        "exudyn_ancf.py", "geared_links",
        ("half of the damping at the base", "hub, loss = link.joint.armature, link.joint.damping",
         "hub, loss = link.joint.armature, 0.5 * link.joint.damping", "joint_angle; exudyn_ancf; damping @ shoulder"),
        ("inner joints without rotors", "inertia = link.joint.armature if inner else 0.0", "inertia = 0.0", "joint_angle; exudyn_ancf; armature @ elbow"),
        ("deflections with the other sign", "bending_side(link) * (tangent[:, 0]", "-bending_side(link) * (tangent[:, 0]",
         "tip_deflection; exudyn_ancf; tip_deflection @ -"),
    ),
    *of_file(
        "exudyn_ancf.py", "ten_links_alternating",
        ("bars without the inertia of their place", "inertia=link.inertia + link.link.mass * float(link.com @ link.com) + armature,",
         "inertia=link.inertia + armature,", "joint_angle; exudyn_ancf; inertia @ -"),
    ),
    *of_file(
        "exudyn_joint.py", "geared_links",
        ("rotors that turn with one side alone", "gradient[own] = sign * direction", "gradient[own] = max(sign, 0.0) * direction",
         "joint_angle; exudyn_ancf; armature @ elbow"),
        ("dampers a tenth too strong", "damping * float(gradient @ rates)", "1.1 * damping * float(gradient @ rates)",
         "joint_angle; exudyn_ancf; damping @ elbow"),
    ),
    *of_file(
        "exudyn_ffrf.py", "geared_links_unstiffened",
        ("half of the rotor at the base", "inertia=built.utilities.RigidBodyInertia(mass=armature, inertiaTensor=armature * np.eye(3)),",
         "inertia=built.utilities.RigidBodyInertia(mass=armature, inertiaTensor=0.5 * armature * np.eye(3)),",
         "joint_angle; exudyn_ffrf; armature @ shoulder"),
        ("dampers twice as strong", "stiffness=0.0, damping=link.joint.damping", "stiffness=0.0, damping=2.0 * link.joint.damping",
         "joint_angle; exudyn_ffrf; damping @ elbow"),
        ("deflections with the other sign", "bending_side(link) * data[2] @ reduced.tip_shift", "-bending_side(link) * data[2] @ reduced.tip_shift",
         "tip_deflection; exudyn_ffrf; tip_deflection @ -"),
        ("ends that do not turn", "end_turn, end_rate = turn + data[2] @ reduced.tip_turn,", "end_turn, end_rate = turn + 0.0 * data[2] @ reduced.tip_turn,",
         "joint_angle; exudyn_ffrf; carried @ upper"),
    ),
    *of_file(
        "exudyn_ffrf.py", "flexible_pendulum_unstiffened",
        ("bars that weigh a tenth less", "loadVector=[*(mass * self.chain.gravity), 0.0]", "loadVector=[*(0.9 * mass * self.chain.gravity), 0.0]",
         "joint_angle; exudyn_ffrf; gravity @ -"),
    ),
    *of_file(
        "reduced_bar.py", "flexible_pendulum_unstiffened",
        ("bars a hundredth too stiff", "beam.bending_stiffness * 12.0 / (width * depth**3)", "1.01 * beam.bending_stiffness * 12.0 / (width * depth**3)",
         "frequency; exudyn_ffrf; bending_stiffness @ rod"),
    ),
    *of_file(
        "engines/planar.py", "geared_links",
        ("hinges a thousandth too far out", "hinge=flat(rotations[joint.parent] @ joint.xyz)", "hinge=1.001 * flat(rotations[joint.parent] @ joint.xyz)",
         "exudyn_ancf; xyz @ elbow"),
        ("gravity a hundredth too strong", "np.array([system.gravity @ x_axis, system.gravity @ y_axis])",
         "1.01 * np.array([system.gravity @ x_axis, system.gravity @ y_axis])", "joint_angle; exudyn_ancf; gravity @ -"),
    ),
)  # fmt: skip

FLEXIBLE = (*INTEGRALS, *FLEXIBLE_KERNELS, *FINITE_ELEMENTS)
