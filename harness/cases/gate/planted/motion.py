"""Faults in what moves mechanisms on: steppers, forces between samples, dry friction, loops, joints in space, sensors' filters."""

from __future__ import annotations

from harness.cases.gate.planted.patch import of_file

STEPPERS = (
    *of_file(
        "motion/adaptive.py", "integrators",
        ("dense output a ten-thousandth off", "dense[1, i] = step * stages[0, i] - delta", "dense[1, i] = 1.0001 * step * stages[0, i] - delta",
         "dop853_error; dop853 @ -"),
        ("forces of the step's beginning at every stage", "(now + C[s] * step - begin) / width, applied)", "(now - begin) / width, applied)",
         "force_linear_dop853; force between samples (linear) @ -"),
        ("errors judged ten thousand times too small", "error = step * error5 / np.sqrt((error5 + 0.01 * error3) * n2)",
         "error = 1e-8 * step * error5 / np.sqrt((error5 + 0.01 * error3) * n2)", "dop853_error; dop853 @ -"),
        ("a stage a thousandth short", "at[i] = y[i] + step * value\n    force_at", "at[i] = y[i] + 0.999999 * step * value\n    force_at",
         "dop853_error; dop853 @ -"),
    ),
    *of_file(
        "motion/adaptive.py", "rotor",
        ("dry friction a hundredth too strong", "force[i] = applied[i] - mode[i] * limit[i] if", "force[i] = applied[i] - 1.01 * mode[i] * limit[i] if",
         "dry_friction_stop; dry_friction @ hub"),
    ),
    *of_file(
        "motion/adaptive.py", "joint_laws",
        ("joints that break loose a tenth late", "abs(needed(mode, scratch, i)) - limit[i] * (1.0 + _MARGIN), status",
         "abs(needed(mode, scratch, i)) - 1.1 * limit[i], status", "break_loose; dry_friction @ hub"),
    ),
    *of_file(
        "motion/fixed_step.py", "integrators",
        ("forces of the stage before", "c = 0.0 if stage == 0 else 1.0 if stage == 3 else 0.5", "c = 0.0 if stage < 3 else 1.0",
         "force_linear_rk4; force between samples (linear) @ -"),
        ("Gauss-Legendre with forces of the step's beginning", "force_at(tau, linear, k, (s + GAUSS_C[r]) / steps, force)",
         "force_at(tau, linear, k, s / steps, force)", "force_linear_gauss; force between samples (linear) @ -"),
        ("a weight of the position wrong", "x += GAUSS_B[c] * (1.0 - GAUSS_C[c]) * a[c, i]", "x += GAUSS_B[c] * (1.0 - 0.9999 * GAUSS_C[c]) * a[c, i]",
         "gauss_error; position_rates @ -"),
        ("a weight of Runge-Kutta's positions wrong", "dq[i] += weight * rate[i]",
         "dq[i] += (weight if stage else 0.9999 * weight) * rate[i]", "rk4_error; position_rates @ -"),
        ("a weight of Runge-Kutta's velocities wrong", "dv[i] += weight * change",
         "dv[i] += (0.9999 * weight if stage == 1 else weight) * change", "rk4_error; velocity_rates @ -"),
        ("forces held that run straight", "out[i] = tau[k, i] + share * (tau[k + 1, i] - tau[k, i]) if linear else tau[k, i]",
         "out[i] = tau[k, i]", "force_linear; force between samples (linear) @ -"),
    ),
    *of_file(
        "lanes/fixed_step.py", "integrators",
        ("a weight of Runge-Kutta wrong", "weight = h / 6.0 if stage == 0 or stage == 3 else h / 3.0",
         "weight = h / 6.0 if stage == 0 or stage == 3 else (0.9999 * h) / 3.0", "lanes; rk4_error; position_rates|velocity_rates @ -"),
        ("a weight of the positions wrong", "store(total, i * 8, load(total, i * 8) + weight * speed)",
         "store(total, i * 8, load(total, i * 8) + (0.9999 * weight) * speed)", "lanes; rk4_error; position_rates @ -"),
        ("forces of the step's beginning at every stage", "part = (s - place * inner + reach) / inner * hold", "part = (s - place * inner) / inner * hold",
         "force_linear_lanes_rk4; force between samples (linear) @ -"),
        ("a stage in the wrong place", "ahead = h if stage == 2 else 0.5 * h", "ahead = h if stage == 2 else 0.49 * h", "lanes; rk4_error; lanes rk4 @ -"),
    ),
    *of_file(
        "lanes/exponential.py", "lanes_flexible_pendulum",
        ("a weight of the differences wrong", "terms = [phi[1], phi[2], phi[3] + phi[2] / 2,", "terms = [phi[1], phi[2], phi[3] + phi[2] / 3,",
         "lanes_exponential; integration @ -"),
    ),
    *of_file(
        "lanes/exponential.py", "lanes_long_steps",
        ("what carries a step on squared once less", "phi[0] @ phi[k] + sum(", "phi[0] @ (0.999 * phi[k]) + sum(", "lanes_exponential; integration @ -"),
    ),
    *of_file(
        "lanes/nodes.py", "integrators",
        ("forces in the lanes that do not change between samples", "load(ws, j + TAU_SLOPE * 8) * (", "0.0 * load(ws, j + TAU_SLOPE * 8) * (",
         "force_linear_lanes_adaptive; force between samples (linear) @ -"),
    ),
    *of_file(
        "engines/march.py", "joint_springs",
        ("other engines' steps with a weight wrong", "state = state + h / 6.0 * (a + 2.0 * (b + c) + d)",
         "state = state + h / 6.0 * (a + 2.0 * (b + 1.001 * c) + d)", "spring_swing; pinocchio; integration @ -"),
    ),
)  # fmt: skip

LANE_RECURSIONS = (
    *of_file(
        "lanes/spatial.py", "lanes_chain",
        ("a bias wrench with a sign wrong", "(wy * nz - wz * ny) + (vy * fz - vz * fy),", "(wy * nz - wz * ny) - (vy * fz - vz * fy),",
         "lanes_adaptive; coriolis @ -"),
    ),
    *of_file(
        "lanes/tree.py", "lanes_bent_in_space",
        ("half of the Coriolis acceleration of bending", "tx = -wz * y + (xd + xd)", "tx = -wz * y + xd", "lanes_adaptive; coriolis @ upper|lower"),
    ),
)  # fmt: skip

IN_SPACE = (
    *of_file(
        "chart/kernels.py", "joints_in_space",
        ("quaternions that turn at half the rate", "a, b, c = 0.5 * v[j], 0.5 * v[j + 1], 0.5 * v[j + 2]", "a, b, c = 0.25 * v[j], 0.25 * v[j + 1], 0.25 * v[j + 2]",
         "joints_in_space/trajectory; position_rates @ root|hip"),
        ("a product of rates with the other sign", "out[c + 1] -= sign * w[c] * w[c + 2]", "out[c + 1] += sign * w[c] * w[c + 2]",
         "joints_in_space/acceleration; coriolis @ root|hip"),
        ("a rotation with one sign wrong", "s * (x * y + w * z), 1.0 - s * (x * x + z * z)", "s * (x * y - w * z), 1.0 - s * (x * x + z * z)",
         "joints_in_space/acceleration; mass_matrix @ root|hip"),
    ),
    *of_file(
        "pinocchio_axes.py", "free_flight free_of_a_link",
        ("free joints in axes of the base", "result[at : at + 3] = (turn if back else turn.T) @ result[at : at + 3]", "pass",
         "free_of_a_link; pinocchio; mass_matrix @ loose"),
    ),
)  # fmt: skip

LOOPS = (
    *of_file(
        "loops/columns.py", "bricard",
        ("couplings at the wrong coordinate's rate", "value += x[at_.twists(places, f) + k * n + j] * v[j]", "value += 0.5 * x[at_.twists(places, f) + k * n + j] * v[j]",
         "acceleration_by_columns; coriolis @ -"),
        ("free accelerations without the opposing forces", "x[free + i] = tau[i] - x[at_.vector(places, 1) + i]", "x[free + i] = tau[i] - 0.99 * x[at_.vector(places, 1) + i]",
         "acceleration_by_columns; bias @ -"),
    ),
    *of_file(
        "mujoco_loops.py", "four_bar",
        ("rates of MuJoCo's loops with the other sign", "found = eliminated(mass, forces, jacobian, -rate @ qd)",
         "found = eliminated(mass, forces, jacobian, rate @ qd)", "acceleration; mujoco; coriolis @ -"),
    ),
)  # fmt: skip

FILTERS = of_file(
    "measurement.py", "sensor_models",
    ("a high-pass that starts settled on nothing", "return signal - _passed(signal, time, params, params[:, 1] * signal[:, 0])",
     "return signal - 0.99 * _passed(signal, time, params, params[:, 1] * signal[:, 0])", "sensor_highpass; sensor_highpass @ -"),
    ("the quadratic term halved", "return signal * (1.0 + signal * (params[:, :1] + signal * params[:, 1:2]))",
     "return signal * (1.0 + signal * (0.5 * params[:, :1] + signal * params[:, 1:2]))", "sensor_nonlinearity; sensor_nonlinearity @ -"),
    ("a filter that takes samples for steps", "coefficients = (x0, s0, 3.0 * (x1 - x0) - 2.0 * s0 - s1,", "coefficients = (x0, 0.0 * s0, 3.0 * (x1 - x0) - 2.0 * s0 - s1,",
     "sensor_lowpass; sensor_lowpass @ -"),
)  # fmt: skip

RESAMPLING = of_file(
    "effects/resampling.py", "sensor_models",
    ("interpolation by the first samples of all", "first = min(max(k - 2, 0), last - POINTS)", "first = min(max(k - 2, 0), last - POINTS) * 0",
     "sensor_delay; sensor_delay @ -"),
)  # fmt: skip

MOTION = (*STEPPERS, *LANE_RECURSIONS, *IN_SPACE, *LOOPS, *FILTERS, *RESAMPLING)
