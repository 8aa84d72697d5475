#!/usr/bin/env bash
# The potential energy of an OpenSim model leaves out the springs on coordinates.
#
# One would guess: calcPotentialEnergy counts every spring of the model, so that without damping it and calcKineticEnergy add up
# to a constant; what a SpringGeneralizedForce does to the motion is in it.
# What happens: a PointToPointSpring is counted; SpringGeneralizedForce and ExpressionBasedCoordinateForce move the model as they
# should and count as nothing, with no word.
# Seen with: opensim 4.6, numpy 2.4.6; pendulum of 1.5 kg at 0.4 m, released at 0.9 rad, 2 N m/rad about 0.1 rad, 0.6 s:
#   acceleration as by the closed form, kinetic + potential energy over a span of 0.87 J, with 1/2 k (q - q0)^2 added constant
#   to 1e-6 J; with a spring of 3 N/m between points instead it is constant as it is
# Why it matters: a drift of the energy is how an integrator's accuracy is judged and how damping is found; here a spring without
# losses looks like a drive that pumps energy in and out.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m pip install --quiet --no-compile --disable-pip-version-check --no-deps --target "$folder/site" opensim==4.6 numpy==2.4.6
cd "$folder"
PYTHONNOUSERSITE=1 PYTHONPATH="$folder/site" python3 - <<'PY'
from importlib.metadata import version

import numpy as np
import opensim

print("OpenSim", version("opensim"))
opensim.Logger.setLevelString("Error")
MASS, LEVER, ABOUT, GRAVITY, STIFFNESS, REST, START = 1.5, 0.4, 0.01, 9.81, 2.0, 0.1, 0.9


def on_coordinate(model, body):
    force = opensim.SpringGeneralizedForce("q")
    force.setStiffness(STIFFNESS)
    force.setRestLength(REST)
    force.setViscosity(0.0)
    model.addForce(force)


def by_expression(model, body):
    model.addForce(opensim.ExpressionBasedCoordinateForce("q", f"-{STIFFNESS}*(q-{REST})"))


def between_points(model, body):
    model.addForce(opensim.PointToPointSpring(model.getGround(), opensim.Vec3(1, 0, 0), body, opensim.Vec3(0, -0.5, 0), 3.0, 0.4))


def swing(add):
    """First acceleration [rad/s^2], and energies [J] without and with the spring's own over 0.6 s."""
    model = opensim.Model()
    model.setGravity(opensim.Vec3(0, -GRAVITY, 0))
    body = opensim.Body("b", MASS, opensim.Vec3(0, -LEVER, 0), opensim.Inertia(0.02, 0.03, ABOUT))
    model.addBody(body)
    zero = opensim.Vec3(0)
    joint = opensim.PinJoint("j", model.getGround(), zero, zero, body, zero, zero)
    joint.updCoordinate().setName("q")
    model.addJoint(joint)
    add(model, body)
    state = model.initSystem()
    coordinate = model.getCoordinateSet().get("q")
    coordinate.setValue(state, START)
    model.realizeAcceleration(state)
    first = coordinate.getAccelerationValue(state)
    manager = opensim.Manager(model)
    manager.setIntegratorAccuracy(1e-9)
    manager.initialize(state)
    energies = []
    for time in np.linspace(0.0, 0.6, 13):
        if time > 0:
            state = manager.integrate(time)
        model.realizeDynamics(state)
        own = 0.5 * STIFFNESS * (coordinate.getValue(state) - REST) ** 2
        told = model.calcKineticEnergy(state) + model.calcPotentialEnergy(state)
        energies.append((told, told + own))
    return first, np.array(energies)


closed = (-MASS * GRAVITY * LEVER * np.sin(START) - STIFFNESS * (START - REST)) / (ABOUT + MASS * LEVER**2)
for add in (on_coordinate, by_expression):
    first, energies = swing(add)
    told, whole = np.ptp(energies, axis=0)
    print(f"{add.__name__:14}: {first:.4f} rad/s^2 at first (closed form {closed:.4f}); energy from {energies[0, 0]:.4f} J over "
          f"{told:.4f} J, with the spring's own over {whole:.1e} J")
    if abs(first - closed) > 1e-6 or whole > 1e-4:
        raise SystemExit("changed: the motion is not that of the spring")
    if told < 0.5:
        raise SystemExit("changed: the spring is in the potential energy now")
_, energies = swing(between_points)
print(f"between_points: energy over {np.ptp(energies[:, 0]):.1e} J")
if np.ptp(energies[:, 0]) > 1e-4:
    raise SystemExit("changed: the spring between points is not in the potential energy")
PY
