"""Damping read off decays whose truth other code made: MuJoCo, the linear oscillator's closed form, sums of damped waves."""

from __future__ import annotations

import json
import math
from dataclasses import replace

import numpy as np
import pytest
from scipy.optimize import brentq, curve_fit

from harness.cases.paper.rig import flexible
from harness.cases.pendulums import LENGTH, MASS, paper_inertia, paper_pendulum, paper_small_frequency
from harness.cli.main import status_of
from harness.compare.decay import estimate
from harness.compare.decay.apart import apart
from harness.compare.decay.bands import bands
from harness.compare.decay.estimate import departure
from harness.compare.decay.oscillator import LAWS, losses
from harness.compare.decay.swings import half_swings
from harness.engines import registry
from harness.engines.oscillator import oscillate
from harness.recording.recording import Channel, Recording
from harness.system import Attachment

NOISE = 2e-3


def mujoco_decay(viscous, quadratic, seed, *, duration=15.0, release=1.5):
    system = paper_pendulum(damping=viscous)
    if quadratic:
        system = replace(system, attachments=(Attachment("quadratic_drag", "pivot", {"coefficient": quadratic}),))
    time = np.linspace(0.0, duration, round(duration * 200.0) + 1)
    run = registry.engine("mujoco").build(system).simulate(np.array([release]), np.zeros(1), time)
    return time, run.position[:, 0] + NOISE * np.random.default_rng(seed).normal(size=time.size)


def closed_form_decay(viscous, dry, seed, *, frequency=1.3, duration=15.0):
    """A spring's oscillator of unit inertia, phase by phase in closed form, sticking at the end."""
    time = np.linspace(0.0, duration, round(duration * 150.0) + 1)
    stiffness = (2.0 * math.pi * frequency) ** 2
    position, _ = oscillate((0.4, 0.0), 1.0, viscous, stiffness, np.zeros_like(time), dry, time)
    return time, position + 0.05 + 5e-4 * np.random.default_rng(seed).normal(size=time.size)


@pytest.mark.parametrize("seed", [11, 12, 13])
def test_concealed_viscous_and_quadratic_damping_is_found(seed):
    rng = np.random.default_rng(seed)
    truth = np.array([rng.uniform(4e-4, 2e-3), 0.0, rng.uniform(2e-4, 1e-3)])
    found = estimate(*mujoco_decay(truth[0], truth[2], seed))
    assert found.swings.sine
    assert found.likelihood.laws == ("viscous", "quadratic")
    inertia = paper_inertia()
    off = (found.likelihood.coefficients * inertia - truth)[[0, 2]] / (found.likelihood.std * inertia)[[0, 2]]
    assert np.abs(off).max() < 4.0
    assert found.envelope.coefficients[0] * inertia == pytest.approx(truth[0], abs=1e-4)
    assert found.envelope.coefficients[2] * inertia == pytest.approx(truth[2], abs=5e-5)
    assert found.likelihood.rms == pytest.approx(NOISE, rel=0.05)


@pytest.mark.parametrize(("viscous", "dry"), [(0.15, 0.6), (0.0, 1.0), (0.3, 0.0)])
def test_dry_friction_of_a_spring_in_closed_form(viscous, dry):
    found = estimate(*closed_form_decay(viscous, dry, 5), sine=False)
    assert found.likelihood.laws == tuple(law for law, value in (("viscous", viscous), ("dry", dry)) if value)
    errors = np.abs(found.likelihood.coefficients - np.array([viscous, dry, 0.0]))
    assert (errors <= 4.0 * found.likelihood.std + 1e-12).all()
    assert found.envelope.coefficients[:2] == pytest.approx([viscous, dry], abs=0.04)
    assert found.swings.rest == pytest.approx(0.05, abs=2e-3)
    assert found.likelihood.frequency == pytest.approx(1.3, rel=1e-4)


def test_the_decrement_of_a_small_viscous_swing_is_the_closed_form():
    found = estimate(*closed_form_decay(0.3, 0.0, 7), sine=False)
    # δ = ζ 2π / √(1 − ζ²) with 2 ζ ω = 0.3
    ratio = 0.3 / (2.0 * 2.0 * math.pi * 1.3)
    assert found.decrement.decrement == pytest.approx(2.0 * math.pi * ratio / math.sqrt(1.0 - ratio**2), rel=0.01)
    assert found.decrement.viscous == pytest.approx(0.3, rel=0.01)
    assert found.departure is None


def test_the_printed_rule_is_the_ratio_times_the_critical_damping():
    """ξ_c = ρ l² √(2 l g / 3) is 2 J ω of the bare rod; a ratio of amplitudes near one makes ξ of it nearly critical."""
    rho, inertia = MASS / LENGTH, MASS * LENGTH**2 / 3.0
    circular = math.sqrt(MASS * LENGTH / 2.0 * 9.81 / inertia)
    assert rho * LENGTH**2 * math.sqrt(2.0 * LENGTH * 9.81 / 3.0) == pytest.approx(2.0 * inertia * circular, rel=1e-12)
    found = estimate(*mujoco_decay(1.9e-3, 0.0, 3))
    assert found.decrement.printed == pytest.approx(
        found.decrement.ratio * 2.0 * 2.0 * math.pi * found.swings.small, rel=1e-12
    )
    # Forty times what the damping is.
    assert 30.0 < found.decrement.printed * paper_inertia() / 1.9e-3 < 60.0


def test_a_wide_viscous_swing_biases_the_decrement_and_not_the_fit():
    found = estimate(*mujoco_decay(1.9e-3, 0.0, 4))
    inertia = paper_inertia()
    assert 1.03 < found.decrement.viscous * inertia / 1.9e-3 < 1.12
    assert found.linear.coefficients[0] * inertia == pytest.approx(1.9e-3, rel=2e-3)


def test_losses_are_the_integrals_over_a_half_swing():
    from scipy.integrate import quad

    a, w = 1.3, 2.0

    def speed(q):
        return math.sqrt(max(2.0 * w**2 * (math.cos(q) - math.cos(a)), 0.0))

    expected = [quad(speed, -a, a)[0], 2.0 * a, quad(lambda q: speed(q) ** 2, -a, a)[0]]
    assert losses(np.array([a]), w, sine=True)[:, 0] == pytest.approx(expected, rel=1e-6)
    assert len(expected) == len(LAWS)


def test_two_bands_are_told_apart_with_their_decays():
    time = np.linspace(0.0, 6.0, 6001)
    slow = 2e-3 * np.exp(-0.20 * time) * np.cos(2.0 * np.pi * 1.1 * time)
    fast = 8e-4 * np.exp(-0.90 * time) * np.sin(2.0 * np.pi * 35.0 * time)
    signal = slow + fast + 2e-5 * np.random.default_rng(8).normal(size=time.size)
    swing, vibration = bands(time, signal)
    for band, frequency, rate in ((swing, 1.1, 0.20), (vibration, 35.0, 0.90)):
        assert band.frequency[0] == pytest.approx(frequency, rel=2e-3)
        assert band.line == pytest.approx(frequency, rel=2e-3)
        assert band.rate[0] == pytest.approx(rate, rel=0.03)
        assert band.damping_ratio[0] == pytest.approx(rate / (2.0 * math.pi * frequency), rel=0.03)
        assert band.rate[1] - 0.02 * rate < rate < band.rate[2] + 0.02 * rate


def dry_amplitudes(first, ratio, shift, count):
    """Exact turning points of a spring with viscous and dry damping: |x| falls about a rest moved by friction over stiffness."""
    found = [first]
    while len(found) < count and found[-1] > 2.0 * shift:
        found.append((found[-1] - shift) * ratio - shift)
    return np.array(found)


@pytest.mark.parametrize(("viscous", "dry", "duration"), [(0.10, 0.35, 25.0), (0.02, 0.5, 25.0), (0.0, 2.4, 8.0)])
def test_the_linear_model_departs_when_the_exact_amplitudes_say_so(viscous, dry, duration):
    """An exponential through the first four swings, off by a tenth for good; the last one stops before the swings are four."""
    frequency = 1.3
    circular = 2.0 * math.pi * frequency
    time, signal = closed_form_decay(viscous, dry, 3, frequency=frequency, duration=duration)
    damped = math.sqrt(circular**2 - viscous**2 / 4.0)
    ratio = math.exp(-0.5 * viscous * math.pi / damped)
    exact = dry_amplitudes(0.4, ratio, dry / circular**2, int(2.0 * frequency * duration))[1:]
    first = exact[:9]
    (factor, level), _ = curve_fit(lambda k, c, a: a * c**k, np.arange(float(len(first))), first, (0.95, exact[0]))
    k = np.arange(len(exact) + 1)
    off = np.append(np.abs(level * factor ** k[:-1] - exact) > 0.1 * exact, True)
    expected = (1 + (np.flatnonzero(~off)[-1] + 1)) * math.pi / damped
    left = departure(half_swings(time, signal, sine=False), until=float(time[-1]))
    assert left == pytest.approx(expected, abs=0.6 / frequency)


def pinned_mode(length, rigidity, per_length, hub):
    """First bending of a uniform beam on a hinge with a hub: frequency [rad/s], root slope² over modal mass, by Euler-Bernoulli.

    φ = a sin βx + b sinh βx + c (cos βx − cosh βx), φ(0) = 0; EI φ''(0) = −ω² I φ'(0); free at the tip.
    """

    def conditions(beta):
        z, square = beta * length, beta**4 * rigidity / per_length
        sag = 2.0 * rigidity * beta**2
        return np.array(
            [
                [square * hub * beta, square * hub * beta, -sag],
                [-math.sin(z), math.sinh(z), -math.cos(z) - math.cosh(z)],
                [-math.cos(z), math.cosh(z), math.sin(z) - math.sinh(z)],
            ]
        )

    beta = brentq(lambda b: np.linalg.det(conditions(b)), 3.0 / length, 4.2 / length)
    a, b, c = np.linalg.svd(conditions(beta))[2][-1]
    x = np.linspace(0.0, length, 20001)
    shape = a * np.sin(beta * x) + b * np.sinh(beta * x) + c * (np.cos(beta * x) - np.cosh(beta * x))
    slope = beta * (a + b)
    mass = per_length * np.trapezoid(shape**2, x) + hub * slope**2
    return beta**2 * math.sqrt(rigidity / per_length), slope**2 / mass


def test_joint_and_link_are_told_apart():
    """The joint's part is ξ φ'(0)² / 2ωm of the hinged beam; the link's is what the recording was made with."""
    system = flexible(damping=2e-4, ratio=0.002)
    run = (
        registry.engine("denoc")
        .build(system)
        .simulate(np.array([-1.0, 0.0, 0.0, 0.0]), np.zeros(4), np.arange(6001) / 1000.0)
    )
    tip = np.asarray(run.channels["rod.tip_deflection"])
    recording = Recording(
        "bent", "", run.time, (Channel("pivot.position", "pivot", "position", "rad", run.position[:, 0]),)
    )
    circular, share = pinned_mode(0.3, 2.0e11 * 0.025 * 0.001**3 / 12.0, 0.2, 2e-5)
    found = apart(recording, flexible(damping=0.0, ratio=0.0), bands(run.time, tip)[1])
    assert circular / (2.0 * math.pi) == pytest.approx(found.frequency, rel=5e-3)  # gravity lifts it a little
    assert found.joint[0] == pytest.approx(2e-4, rel=3e-3)
    assert found.by_joint[0] == pytest.approx(2e-4 * share / (2.0 * circular), rel=0.02)
    assert found.modal[0] == pytest.approx(0.002, rel=0.01)
    assert found.mode == 1


@pytest.fixture
def recording(tmp_path):
    time, signal = mujoco_decay(1.5e-3, 0.0, 2, duration=8.0)
    path = tmp_path / "swing.csv"
    lines = [f"{t:.6f},{math.degrees(x):.6f}" for t, x in zip(time, signal, strict=True)]
    path.write_text("\n".join(["time,pivot.position [deg]", *lines]) + "\n", encoding="utf-8")
    return path


def test_the_command_writes_numbers_and_a_picture(recording, tmp_path, capsys):
    out = tmp_path / "out"
    assert status_of(["decay", str(recording), "--model", "models/urdf/rigid_pendulum.urdf", "--out", str(out)]) == 0
    assert "viscous" in capsys.readouterr().out
    told = json.loads((out / "decay.json").read_text(encoding="utf-8"))
    assert told["schema"] == "denoc.decay/1"
    assert told["likelihood"]["viscous"]["value"] == pytest.approx(1.5e-3, rel=0.01)
    assert told["likelihood"]["viscous"]["unit"] == "N·m·s/rad"
    assert (out / "decay.svg").read_text(encoding="utf-8").startswith("<svg")


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["--channel", "pivot.positon"], "pivot.position"),
        (["--plot", "x.gif"], "svg"),
        (["--bands"], "vibrates"),
    ],
)
def test_what_cannot_be_done_is_one_line(recording, arguments, words, capsys):
    assert status_of(["decay", str(recording), *arguments]) == 2
    told = capsys.readouterr().err
    assert words in told
    assert told.count("\n") == 1


def test_swings_that_hardly_decay_tell_the_restoring_force_by_their_shape():
    """Their frequencies agree under any law: at 1.5 rad those of a pendulum are 0.86 of that of vanishing swings."""
    found = estimate(*mujoco_decay(0.0, 0.0, 3, duration=12.0))
    assert found.swings.sine and found.likelihood.laws == ()
    assert found.likelihood.frequency == pytest.approx(paper_small_frequency(), rel=1e-4)
    assert found.likelihood.rms == pytest.approx(NOISE, rel=0.05)
    found = estimate(*closed_form_decay(0.0, 0.0, 3))
    assert not found.swings.sine
    assert found.likelihood.frequency == pytest.approx(1.3, rel=1e-4)
