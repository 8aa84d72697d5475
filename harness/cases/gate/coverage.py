"""Every path of the product that computes, and the rows that hold it: a path without a row fails the build.

A path is named for what it is (``Denoc.mass_matrix``, ``law stiffness``, ``kernel planar``); its rows are patterns of
``case/quantity/engines``. The test beside this table lists the paths by looking at the code: what is new there and not here,
or here and not there, and a pattern that matches no accepted row, are failures. ``docs/gate.md`` shows the same table.
"""

from __future__ import annotations

from collections.abc import Iterable
from fnmatch import fnmatchcase

_LAWS = {
    "armature": "armature", "damping": "damping", "coulomb_torque": "dry_friction", "static_torque": "stribeck",
    "stribeck_velocity": "stribeck", "quadratic_drag": "quadratic_drag", "mu_radius": "load_friction",
    "creep_velocity": "creep", "soft_time": "soft_friction", "soft_inertia": "soft_friction", "dahl_torque": "dahl",
    "dahl_stiffness": "dahl", "stiffness": "spring", "rest_angle": "spring", "cubic_stiffness": "cubic_spring",
    "cubic_damping": "polynomial", "polynomial_square": "polynomial", "polynomial_cube": "polynomial",
    "polynomial_rest": "polynomial",
    "constant_torque": "constant_torque", "cogging_amplitude": "cogging", "cogging_periods": "cogging",
    "cogging_phase": "cogging", "stop_angle": "stop", "stop_stiffness": "stop", "stop_damping": "stop",
    "stop_inertia": "stop_inertia", "stop_both": "stop_both", "stop_lower": "stop_both",
    "user_scale": "play", "user_1": "play", "user_2": "play", "user_3": "play", "user_4": "play",
}  # fmt: skip

_SENSORS = (
    "offset", "gain", "drift", "nonlinearity", "periodic_error", "hum", "saturation", "quantisation", "deadzone", "delay",
    "held_delay", "clock_skew", "lowpass", "highpass",
)  # fmt: skip

# Readers of recordings by the module that each is, and a row of its own.
_RECORDINGS = {
    "csv": "csv", "hdf5": "hdf5", "matlab": "matlab", "netcdf": "netcdf", "numpy_arrays": "numpy", "mcap": "mcap",
    "rosbag": "rosbag", "parquet": "parquet",
}  # fmt: skip

PATHS: dict[str, tuple[str, ...]] = {
    # One state.
    "Denoc.forward_dynamics": (
        "chain_*/acceleration/*",
        "tree_*/acceleration/*",
        "spatial_quantities/wrenches_forward/*",
    ),
    "Denoc.inverse_dynamics": ("chain_*/inverse_dynamics/*", "spatial_quantities/wrenches_inverse/*"),
    "Denoc.mass_matrix": ("chain_*/mass_matrix/*", "tree_*/mass_matrix/*"),
    "Denoc.bias": ("chain_*/bias/*",),
    "Denoc.gravity": ("chain_*/gravity/*",),
    "Denoc.coriolis_matrix": (
        "spatial_quantities/coriolis_matrix/*",
        "spatial_quantities/coriolis_force/*",
        "bent_in_space/coriolis_matrix_bent/*",
    ),
    "Denoc.passive": ("file_*/file_passive/*", "joint_springs/acceleration/*"),
    "Denoc.energy": ("chain_*/energy/*", "joint_springs/energy/*"),
    "Denoc.energies": ("chain_*/energy/*",),
    "Denoc.momentum": ("spatial_quantities/momentum/*", "bent_in_space/momentum_bent/*"),
    "Denoc.link_pose": ("spatial_quantities/link_pose/*", "bent_in_space/link_place_bent/*"),
    "Denoc.linear_passive": ("beam_paths/static_deflection/*",),
    "Denoc.frequencies": ("frequencies_*/frequency/*", "rigid_pendulum/frequency/*"),
    "Denoc.hub_motion": ("beam_paths/tip_acceleration*",),
    "Denoc.integrate": ("joints_in_space/manifold_integrate/*",),
    "Denoc.difference": ("joints_in_space/manifold_difference/*",),
    "Denoc.position_rates": ("joints_in_space/manifold_position_rates/*", "free_flight/momentum_kept/*"),
    # Many states.
    "Denoc.forward_dynamics_batch": (
        "batch_*/forward_dynamics_batch/*",
        "batch_flexible/forward_dynamics_batch_straight/*",
        "bent_in_space/forward_dynamics_batch_bent/*",
    ),
    "Denoc.inverse_dynamics_batch": (
        "batch_*/inverse_dynamics_batch/*",
        "batch_flexible/inverse_dynamics_batch_straight/*",
        "bent_in_space/inverse_dynamics_batch_bent/*",
    ),
    "Denoc.mass_matrix_batch": (
        "batch_*/mass_matrix_batch/*",
        "batch_flexible/mass_matrix_batch_straight/*",
        "bent_in_space/mass_matrix_batch_bent/*",
    ),
    "Denoc.accelerations": (
        "batch_flexible/forward_dynamics_batch_straight/*",
        "bent_in_space/forward_dynamics_batch_bent/*",
    ),
    "BatchModel.forward_dynamics": ("batch_tree/forward_dynamics_batch/*",),
    "BatchModel.inverse_dynamics": ("batch_tree/inverse_dynamics_batch/*",),
    "BatchModel.mass_matrix": ("batch_tree/mass_matrix_batch/*", "batch_hinges/mass_matrix_batch/*"),
    "BatchModel.floating_dynamics": ("batch_floating/forward_dynamics_batch/*",),
    "SpaceBatch.forward_dynamics": ("batch_in_space/forward_dynamics_batch/*", "batch_loose/forward_dynamics_batch/*"),
    "SpaceBatch.inverse_dynamics": ("batch_in_space/inverse_dynamics_batch/*", "batch_loose/inverse_dynamics_batch/*"),
    "SpaceBatch.mass_matrix": ("batch_in_space/mass_matrix_batch/*", "batch_loose/mass_matrix_batch/*"),
    # Loops.
    "Closed.forward_dynamics": ("four_bar/acceleration/*", "bricard/acceleration/*", "andrews_squeezer/acceleration/*"),
    "Closed.inverse_dynamics": ("four_bar/inverse_dynamics/*", "bricard/inverse_dynamics/*"),
    "Closed.simulate": ("four_bar*/*motion/*", "andrews_squeezer/positions_at_end/*", "*/loops_kept/*"),
    # Runs.
    "Denoc.simulate": ("*/trajectory/*", "integrators/*"),
    "method dop853": ("integrators/dop853_error/*", "integrators/events_error/*", "integrators/event_time/*"),
    "method rk4": ("integrators/rk4_error/*", "integrators/rk4_order/*"),
    "method gauss": ("integrators/gauss_error/*", "integrators/gauss_order/*"),
    "forces zero": ("integrators/force_zero_*",),
    "forces linear": ("integrators/force_linear_*",),
    "dry friction": ("rotor/dry_friction_stop/*", "joint_laws/break_loose/*", "joint_laws/break_loose_between/*"),
    "LaneModel.simulate": ("lanes_*/lanes_adaptive_*", "joint_laws/*"),
    "LaneModel.row": ("lanes_*/lanes_adaptive_*",),
    "LaneModel.parts": (
        "lanes_double_pendulum/lanes_adaptive_planar/*",
        "lanes_double_pendulum/lanes_adaptive_spatial/*",
    ),
    "LaneModel.closed": ("lanes_closed/lanes_states_closed/*",),
    "LaneModel.slot": ("joint_laws/*",),
    "lanes adaptive": ("lanes_*/lanes_adaptive_*", "integrators/lanes_*_error/*"),
    "lanes rk4": ("lanes_*/lanes_rk4_*", "integrators/lanes_*_rk4_order/*"),
    "lanes exponential": ("lanes_*/lanes_exponential_*",),
    **{f"law {slot}": (f"joint_laws/{row}_planar/*", f"joint_laws/{row}_spatial/*") for slot, row in _LAWS.items()},
    "base excitation": ("joint_laws/base_excitation_planar/*", "joint_laws/base_excitation_spatial/*"),
    # What is compiled apart.
    "kernel rigid": ("chain_2/acceleration/*", "tree_20/acceleration/*"),
    "kernel rigid_others": ("tree_20/mass_matrix/*", "tree_20/energy/*"),
    "kernel loops": (
        "four_bar/acceleration/*",
        "bricard/acceleration/*",
        "bricard/acceleration_by_columns/*",
        "andrews_squeezer/positions_at_end/*",
    ),
    "kernel chain": ("hinges_4/acceleration/*", "hinges_5/acceleration/*", "hinges_8/acceleration/*"),
    "kernel flexible": ("flexible_pendulum/*", "two_flexible_links/*", "bent_in_space/acceleration_bent/*"),
    "kernel flexible_others": (
        "*/mass_matrix_straight/*",
        "beam_paths/tip_acceleration*",
        "bent_in_space/*_bent/*",
        "bent_in_space_unstiffened/*_bent/*",
    ),
    "kernel batches": ("batch_*/*",),
    "kernel in_space": ("batch_in_space/*", "batch_loose/*"),
    "kernel dop853": ("integrators/dop853_error/*",),
    "kernel rk4": ("integrators/rk4_order/*",),
    "kernel gauss": ("integrators/gauss_order/*",),
    "kernel planar": ("lanes_*/lanes_*_planar/*",),
    "kernel spatial": ("lanes_*/lanes_*_spatial/*",),
    "kernel lane_parameters": ("lanes_tree/*", "lanes_two_flexible_links/*"),
    "kernel lanes": ("lanes_chain/*", "lanes_flexible_pendulum/*"),
    "kernel exponential": ("lanes_flexible_pendulum/lanes_exponential_*",),
    "kernel closed": ("lanes_closed/lanes_loop_motion/*", "lanes_closed/lanes_loop_damping/*"),
    # What a description says of a joint.
    "joint type": (
        "chain_*/acceleration/*",
        "welded_tree/acceleration/*",
        "joints_in_space/acceleration/*",
        "free_of_a_link/acceleration/*",
    ),
    "joint xyz": ("spatial_quantities/link_pose/*",),
    "joint rotation": ("spatial_quantities/link_pose/*", "file_urdf_general/file_mass_matrix/*"),
    "joint axis": ("spatial_quantities/link_pose/*",),
    "joint armature": ("chain_*/mass_matrix/*", "file_mjcf_general/file_mass_matrix/*"),
    "joint damping": ("rotor/viscous_decay/*", "file_urdf_general/file_passive/*"),
    "joint friction": ("rotor/dry_friction_stop/*",),
    "joint stiffness": ("joint_springs/spring_swing/*", "file_mjcf_general/file_passive/*"),
    "joint rest_position": ("joint_springs/spring_swing/*",),
    "joint lower": ("file_*/file_limits/*",),
    "joint upper": ("file_*/file_limits/*",),
    "joint axis2": ("joints_in_space/acceleration/*", "joints_in_space/trajectory/*"),
    "joint pitch": (
        "joints_that_follow/acceleration/*",
        "joints_that_follow/energy/*",
        "joints_that_follow/followers_place/*",
    ),
    "joint mimic": (
        "joints_that_follow/acceleration/*",
        "joints_that_follow/mass_matrix/*",
        "joints_that_follow/followers_place/*",
    ),
    # … of a rigid link …
    "link mass": ("chain_*/gravity/*",),
    "link com": ("chain_*/gravity/*",),
    "link inertia": ("chain_*/mass_matrix/*",),
    "gravity": ("chain_*/gravity/*", "file_mjcf_general/file_bias/*"),
    # … and of a beam.
    "beam length": ("frequencies_clamped_free/frequency/*",),
    "beam direction": ("two_flexible_links/*",),
    "beam bending": ("two_flexible_links/*",),
    "beam mass": ("frequencies_clamped_free/frequency/*",),
    "beam bending_stiffness": ("frequencies_clamped_free/frequency/*",),
    "beam bending_stiffness2": ("beam_paths/second_plane_frequency/*",),
    "beam bending2": ("beam_paths/second_plane_frequency/*",),
    "beam torsional_stiffness": ("beam_paths/torsion_frequency/*",),
    "beam polar_inertia": ("beam_paths/torsion_frequency/*",),
    "beam torsion_modes": ("beam_paths/torsion_frequency/*", "beam_paths/torsion_payload_frequency/*"),
    "beam half_depth": ("beam_paths/root_strain/*", "file_toml_*/file_half_depth/*"),
    "beam material_damping": ("beam_paths/material_damping_decay/*",),
    "beam modal_damping": ("beam_paths/modal_damping_decay/*", "beam_paths/modal_damping_hinged/*"),
    "beam modes": ("frequencies_clamped_free/frequency/*",),
    "beam geometric_stiffening": ("flexible_pendulum*/*",),
    "beam payload": ("beam_paths/static_deflection/*", "beam_paths/payload_weight/*"),
    "beam payload_inertia": ("beam_paths/payload_inertia_frequency/*",),
    "channel tip_deflection": (
        "two_flexible_links/*",
        "beam_paths/root_strain/*",
        "beam_paths/tip_deflection_at_rest/*",
    ),
    "channel root_strain": ("beam_paths/root_strain/*", "beam_paths/root_strain_at_rest/*"),
    "channel tip_acceleration": (
        "beam_paths/tip_acceleration/*",
        "beam_paths/tip_acceleration_at_rest/*",
        "bent_in_space/tip_acceleration_bent/*",
    ),
    # Sensors and inputs, files, and the engines that all this is held against.
    **{f"sensor {name}": (f"sensor_models/sensor_{name}/*",) for name in _SENSORS},
    "reader urdf": (
        "file_urdf_*/file_mass_matrix/*",
        "file_urdf_*/file_bias/*",
        "file_urdf_*/file_limits/*",
        "file_urdf_fields/file_fields/*",
    ),
    "reader mjcf": (
        "file_mjcf_*/file_mass_matrix/*",
        "file_mjcf_*/file_bias/*",
        "file_mjcf_*/file_limits/*",
        "file_mjcf_fields/file_fields/*",
        "file_floating_*/mass_matrix_as_read/*",
        "file_floating_*/bias_as_read/*",
    ),
    "reader toml": (
        "file_toml_*/file_frequency/*",
        "file_toml_fields/file_fields/*",
        "file_toml_fields/file_torsion/*",
        "file_toml_loop/file_fields/*",
        "file_toml_general/file_mass_matrix/*",
        "file_toml_general/file_bias/*",
    ),
    # What is unpacked, and MATLAB 7.3, which is HDF5, come on top of these.
    **{f"recording {name}": (f"recording_files/recording_{row}/*",) for name, row in _RECORDINGS.items()},
    "engine denoc": ("*/acceleration/denoc+*",),
    "engine pinocchio": ("*/acceleration/denoc+pinocchio",),
    "engine mujoco": ("*/acceleration/denoc+mujoco",),
    "engine exudyn": ("*/acceleration/denoc+exudyn",),
    "engine exudyn_ancf": ("*/*/denoc+exudyn_ancf", "geared_links/*/denoc+exudyn_ancf"),
    "engine exudyn_ffrf": ("*/*/denoc+exudyn_ffrf", "geared_links_unstiffened/*/denoc+exudyn_ffrf"),
    "engine analytic": ("rigid_pendulum/acceleration/denoc+analytic",),
}

# Numbers of a description that no dynamics hang on, or that another row's pattern cannot hold; each with its reason.
EXEMPT: dict[str, str] = {
    "BatchModel.with_row": "the same with other numbers, compiled before: tests alone, to the bit",
    "Closed.assemble": "what every row of a closed mechanism begins with",
    "Closed.closed_velocity": "what every row of a closed mechanism begins with",
    "Closed.open_by": "what loops_kept is measured with; its own values: tests alone",
    "Closed.loop_jacobian": "what loops_kept is measured with; its own values: tests alone",
    "Closed.constraint_forces": "against the whole matrix of masses and conditions: tests alone",
    "LaneModel.following": "which initial states a fit moves where a loop has clearance: tests alone",
    "Closed.refuse_open": "makes a refusal, and computes nothing",
    "Denoc.singular": "makes a refusal, and computes nothing",
    "Denoc.vector": "checks an argument, and computes nothing",
    "Denoc.position": "checks an argument, and computes nothing",
    "Denoc.position_place": "where a joint's positions stand",
    "Denoc.velocity_share": "how followers go with their leader: tests alone",
    "joint name": "a name",
    "joint parent": "a name",
    "joint child": "a name",
    "joint effort": "recorded, not enforced: nothing is computed from it",
    "joint velocity": "recorded, not enforced: nothing is computed from it",
    "link gravcomp": "carried weight: tests against MuJoCo's run of the file alone",
    "link name": "a name",
    "link beam": "its numbers are paths of their own",
    "link end": "where plots and effects take a link to end: no equation of motion has it",
    "beam shapes": "a choice of shapes: each is held by the frequencies of its mount",
    "beam shape_samples": "shapes of the user's own: tests alone",
    "beam mode_stiffness": "a factor that a diagnosis fits: tests alone",
    "beam width": "kept for audit and for writing the file back",
    "beam thickness": "kept for audit and for writing the file back",
    "beam youngs_modulus": "kept for audit and for writing the file back",
    "beam density": "kept for audit and for writing the file back",
    "sensor unchanged": "hands its argument back",
    "sensor release": "a late release is a delay that starts from rest: tests alone",
    "sensor hum_courses": "what hum is made of",
    "sensor highpass_memory": "what a filter may know of before its first sample, for a fit: tests alone",
    "sensor lowpass_memory": "what a filter may know of before its first sample, for a fit: tests alone",
    "sensor within": "a question about times",
    "sensor resample": "what delay and clock_skew are made of",
}


def rows_of(path: str, keys: Iterable[str]) -> list[str]:
    """Those of the rows' keys that hold a path."""
    return [key for key in keys if any(fnmatchcase(key, pattern) for pattern in PATHS[path])]


def table() -> str:
    """The paths and their rows in Markdown, for the documentation."""
    lines = ["| path | rows (`case/quantity/engines`) |", "| -- | -- |"]
    lines += [f"| `{path}` | {', '.join(f'`{pattern}`' for pattern in patterns)} |" for path, patterns in PATHS.items()]
    lines += ["", "No row of their own have:", ""]
    lines += [f"- `{path}`: {why}" for path, why in EXEMPT.items()]
    return "\n".join(lines) + "\n"
