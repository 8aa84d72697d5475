"""The catalogue states what it must, and says it where it says it acts."""

from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

from harness import effects
from harness.effects.page import page
from harness.errors import InputError
from harness.recording.units import factor_to_si
from harness.system import Attachment, Joint, JointType, Link, System
from harness.system.description import constant

# The words that other people's scripts lean on: effects and their parameters.
WORDS = {
    "viscous_damping": {"coefficient": "N*m*s/rad"},
    "coulomb_friction": {"torque": "N*m"},
    "stribeck_friction": {"coulomb_torque": "N*m", "static_torque": "N*m", "stribeck_velocity": "rad/s"},
    "load_dependent_friction": {"mu_radius": "m"},
    "quadratic_drag": {"coefficient": "N*m*s**2/rad**2"},
    "dahl_friction": {"torque": "N*m", "stiffness": "N*m/rad"},
    "friction_creep": {"velocity": "rad/s"},
    "friction_softness": {"time": "s", "inertia": "kg*m**2"},
    "joint_stiffness": {"stiffness": "N*m/rad", "rest_angle": "rad"},
    "cubic_stiffness": {"stiffness": "N*m/rad**3"},
    "constant_torque": {"torque": "N*m"},
    "link_inertia": {"share": "1"},
    "cogging_torque": {"amplitude": "N*m", "periods": "1/rev", "phase": "rad"},
    "end_stop": {"angle": "rad", "stiffness": "N*m/rad", "damping": "N*m*s/rad"},
    "stop_inertia": {"inertia": "kg*m**2"},
    "backlash": {"gap": "rad"},
    "loop_clearance": {"gap": "m"},
    "transmission_ratio": {"factor": "1"},
    "joint_flexibility": {"stiffness": "N*m/rad", "damping": "N*m*s/rad"},
    "payload_mass": {"mass": "kg"},
    "added_inertia": {"inertia": "kg*m**2"},
    "com_offset": {"offset": "m"},
    "com_displacement": {"x": "m", "y": "m", "z": "m"},
    "imbalance": {"u": "m", "v": "m"},
    "base_tilt": {"angle": "rad"},
    "base_excitation": {"amplitude": "m/s**2", "frequency": "Hz", "phase": "rad"},
    "base_compliance": {"stiffness": "N/m", "mass": "kg", "damping": "N*s/m"},
    "link_flexibility": {"frequency": "Hz", "damping_ratio": "1"},
    "modal_damping": {"damping_ratio": "1"},
    "higher_mode": {"frequency": "Hz", "damping_ratio": "1"},
    "flexural_rigidity": {"factor": "1"},
    "geometric_stiffening": {},
    "sensor_offset": {"offset": "channel"},
    "sensor_gain": {"gain": "1"},
    "sensor_delay": {"delay": "s"},
    "sensor_lowpass": {"cutoff": "Hz"},
    "sensor_highpass": {"cutoff": "Hz"},
    "sensor_nonlinearity": {"quadratic": "1/channel", "cubic": "1/channel**2"},
    "sensor_drift": {"rate": "channel/s"},
    "sensor_saturation": {"limit": "channel"},
    "sensor_zero": {},
    "sensor_hum": {"amplitude": "channel", "frequency": "Hz"},
    "clock_skew": {"factor": "1"},
    "actuator_gain": {"gain": "1"},
    "servo_gain": {"gain": "1"},
    "servo_torque": {"gain": "1"},
    "actuator_delay": {"delay": "s"},
    "actuator_deadzone": {"width": "N*m"},
    "actuator_saturation": {"limit": "N*m"},
}


def rod(length=0.3, mass=0.2, name="rod", joint="pivot", parent="base", at=(0.0, 0.0, 0.0)):
    inertia = np.diag([mass * length**2 / 12.0] * 2 + [0.0])
    return (
        Joint(joint, JointType.REVOLUTE, parent, name, xyz=constant(at), axis=constant([0.0, 1.0, 0.0])),
        Link(name, mass, constant([0.0, 0.0, -length / 2.0]), constant(inertia)),
    )


@pytest.fixture
def pendulum():
    joint, link = rod()
    return System("pendulum", (joint,), (link,))


@pytest.fixture
def double():
    first, upper = rod()
    second, lower = rod(name="forearm", joint="elbow", parent="rod", at=(0.0, 0.0, -0.3))
    return System("double", (first, second), (upper, lower))


def channel(name, values=None):
    site, _, quantity = name.rpartition(".")
    values = np.linspace(-0.4, 1.0, 101) if values is None else values
    return SimpleNamespace(name=name, site=site, quantity=quantity, unit="rad", values=values)


def recorded(*names, efforts=()):
    return SimpleNamespace(
        time=np.linspace(0.0, 5.0, 101), channels=tuple(map(channel, names)), efforts=tuple(map(channel, efforts))
    )


def test_every_word_of_the_contract_is_there():
    known = effects.catalogue()
    for name, parameters in WORDS.items():
        stated = {p.name: p.unit for p in known[name].parameters}
        assert parameters.items() <= stated.items()
        assert stated == parameters or name == "sensor_highpass"  # it must say what it had settled on as well


def test_every_effect_is_stated_in_full():
    known = effects.catalogue()
    for name, effect in known.items():
        assert effect.name == name
        for text in (effect.title, effect.signature, effect.shows_in, effect.source):
            assert len(text) > 4, name
        assert effect.expressed_by, name
        for other in (*effect.simpler, *effect.confusable_with):
            assert other in known and other != name, (name, other)
        for parameter in effect.parameters:
            assert parameter.what and parameter.starts, (name, parameter.name)
            assert parameter.lower < parameter.upper


def test_every_effect_says_how_large_it_usually_is_unless_it_is_a_place_or_has_no_number(pendulum):
    sizes = effects.references(pendulum, "pivot")
    places = {"sensor_saturation"}  # where something begins is not a size
    for name, effect in effects.catalogue().items():
        usual = [p for p in effect.parameters if p.plausible is not None]
        said = bool(usual) or effect.plausible is not None
        assert said == (bool(effect.parameters) and name not in places), name
        for parameter in usual:
            own, size = parameter.plausible, parameter.plausible.size(sizes)
            assert own.source and np.isfinite(size) and size > 0.0
            # Where the effect is absent it surprises nobody; ten times its usual size, like a Cauchy density there.
            absent = parameter.neutral if np.isfinite(parameter.neutral) else np.finfo(float).max
            absent = np.finfo(float).max if own.inverse else absent
            assert own.surprise(absent, parameter.neutral, sizes) == pytest.approx(0.0, abs=1e-12)
            far = 0.1 / size if own.inverse else parameter.neutral + 10.0 * size
            assert own.surprise(far, parameter.neutral, sizes) == pytest.approx(2.0 * np.log(101.0))


def test_a_stand_that_swings_as_slowly_as_its_load_surprises_by_what_its_numbers_make_together(pendulum):
    effect = effects.catalogue()["base_compliance"]
    sizes = effects.references(pendulum, "pivot")
    moving = 2.0 * sizes.mass  # a stand as heavy as its load
    for times, ratio in ((1.0, 1.0), (5.0, 0.04)):  # of the swing's frequency; ω² = k / (M + m)
        stiffness = moving * (times * sizes.frequency) ** 2
        found = effect.plausible.surprise({"stiffness": stiffness, "mass": sizes.mass, "damping": 0.0}, sizes)
        assert found == pytest.approx(2.0 * np.log1p((ratio / 0.04) ** 2)), times


def test_confusion_goes_both_ways_for_the_classes_that_a_single_angle_sensor_cannot_part():
    known = effects.catalogue()
    for one, other in (
        ("sensor_offset", "base_tilt"),
        ("payload_mass", "added_inertia"),
        ("payload_mass", "clock_skew"),
    ):
        assert other in known[one].confusable_with and one in known[other].confusable_with


def test_units_are_units():
    for effect in effects.catalogue().values():
        for unit in effect.units(channel_unit="rad") + effect.units(channel_unit="m/s**2", prismatic=True):
            if unit not in ("1/rev",):
                # pint must read every unit we print; a wrong one would raise InputError
                import pint

                pint.UnitRegistry(cache_folder=None).parse_expression(unit)
    assert effects.effect("sensor_drift").units(channel_unit="rad") == ("rad/s",)
    assert effects.effect("sensor_nonlinearity").units(channel_unit="m") == ("1/(m)", "1/(m)**2")
    assert effects.effect("viscous_damping").units(prismatic=True) == ("N*s/m",)
    assert factor_to_si("deg", "position", prismatic=False)[0] == pytest.approx(np.pi / 180.0)


def test_start_values_lie_inside_the_bounds(pendulum):
    sizes = effects.references(pendulum, "pivot", recorded("pivot.position"))
    for effect in effects.catalogue().values():
        for parameter in effect.parameters:
            for value in parameter.start_values(sizes):
                assert parameter.lower <= value <= parameter.upper
                assert np.isfinite(value)


def test_natural_sizes_of_a_rod(pendulum):
    # Uniform rod: J = m l²/3, gravity torque m g l/2, ω = √(3 g / 2 l).
    sizes = effects.references(pendulum, "pivot")
    assert sizes.inertia == pytest.approx(0.2 * 0.3**2 / 3.0, rel=1e-12)
    assert sizes.torque == pytest.approx(0.2 * 9.81 * 0.15, rel=1e-12)
    assert sizes.frequency == pytest.approx(np.sqrt(1.5 * 9.81 / 0.3), rel=1e-12)
    assert sizes.length == pytest.approx(0.3, rel=1e-9)


def test_the_end_of_a_rod_with_a_bob_is_found():
    # 0.1 kg rod of 0.4 m with 0.05 kg at its end.
    rod_mass, bob, length = 0.1, 0.05, 0.4
    mass = rod_mass + bob
    com = (rod_mass * length / 2 + bob * length) / mass
    about_origin = rod_mass * length**2 / 3 + bob * length**2
    transverse = about_origin - mass * com**2
    link = Link("rod", mass, constant([0.0, 0.0, -com]), constant(np.diag([transverse, transverse, 0.0])))
    found, share = effects.scale.rod_and_bob(link)
    assert found == pytest.approx(length, rel=1e-9)
    assert share == pytest.approx(bob / mass, rel=1e-9)


def test_sites(pendulum, double):
    free, driven = recorded("pivot.position"), recorded("pivot.position", efforts=("pivot.effort",))
    assert effects.sites(effects.effect("coulomb_friction"), double, free) == ("pivot", "elbow")
    assert effects.sites(effects.effect("payload_mass"), double, free) == ("rod", "forearm")
    assert effects.sites(effects.effect("base_tilt"), double, free) == ("base",)
    assert effects.sites(effects.effect("actuator_gain"), double, free) == ()
    assert effects.sites(effects.effect("actuator_gain"), double, driven) == ("pivot",)
    assert effects.sites(effects.effect("sensor_offset"), double, free) == ("pivot.position",)
    assert effects.sites(effects.effect("sensor_delay"), pendulum, free) == ("pivot.position",)
    assert effects.sites(effects.effect("late_release"), pendulum, driven) == ()
    assert effects.sites(effects.effect("modal_damping"), pendulum, free) == ()
    bent = effects.apply(pendulum, Attachment("link_flexibility", "rod", {"frequency": 30.0, "damping_ratio": 0.01}))
    assert effects.sites(effects.effect("modal_damping"), bent, free) == ("rod",)
    assert effects.sites(effects.effect("higher_mode"), bent, free) == ()
    strained = recorded("rod.root_strain")
    assert effects.sites(effects.effect("higher_mode"), bent, strained) == ()  # its shapes are samples
    link = bent.link("rod")
    exact = bent.replace_link(replace(link, beam=replace(link.beam, shapes="auto", shape_samples=None)))
    assert effects.sites(effects.effect("higher_mode"), exact, strained) == ("rod",)
    assert effects.sites(effects.effect("link_flexibility"), bent, free) == ()
    assert effects.sites(effects.effect("geometric_stiffening"), bent, free) == ()
    both = recorded("pivot.position", "elbow.position")
    assert effects.sites(effects.effect("clock_skew"), double, both) == ("pivot.position",)


def test_laws_have_their_slots_in_the_lanes(double):
    model = effects.lane_model(double)
    for effect in effects.catalogue().values():
        if effect.law is None:
            continue
        assert len(effect.law.slots) == len(effect.parameters)
        for site in effects.sites(effect, double):
            row = np.zeros((2, model.P))
            values = np.arange(1.0, 2 * len(effect.parameters) + 1).reshape(2, -1)
            effect.law.write(row, model, site, values)
            for k, slot in enumerate(effect.law.slots):
                assert np.array_equal(row[:, model.slot(site, slot)], values[:, k])


def test_fields_and_attachments(pendulum):
    damped = effects.apply(pendulum, Attachment("viscous_damping", "pivot", {"coefficient": 0.002}))
    assert damped.joint("pivot").damping == 0.002
    assert effects.apply(damped, Attachment("viscous_damping", "pivot", {"coefficient": 0.001})).joint(
        "pivot"
    ).damping == pytest.approx(0.003)
    assert pendulum.joint("pivot").damping == 0.0
    hub = effects.apply(pendulum, Attachment("added_inertia", "pivot", {"inertia": 1e-4}))
    assert hub.joint("pivot").armature == 1e-4
    dragged = effects.apply(pendulum, Attachment("quadratic_drag", "pivot", {"coefficient": 1e-4}))
    assert [a.effect for a in dragged.attachments] == ["quadratic_drag"]
    row = effects.lane_row(effects.lane_model(dragged), dragged)
    assert row[effects.lane_model(dragged).slot("pivot", "quadratic_drag")] == 1e-4


def test_two_springs_are_one(pendulum):
    # k₁ (q − r₁) + k₂ (q − r₂) = (k₁ + k₂)(q − (k₁ r₁ + k₂ r₂)/(k₁ + k₂))
    one = effects.apply(pendulum, Attachment("joint_stiffness", "pivot", {"stiffness": 1.0, "rest_angle": 0.5}))
    two = effects.apply(one, Attachment("joint_stiffness", "pivot", {"stiffness": 3.0, "rest_angle": -0.1}))
    assert two.joint("pivot").stiffness == pytest.approx(4.0)
    assert two.joint("pivot").rest_position == pytest.approx((0.5 - 0.3) / 4.0)


def test_payload_at_the_tip(pendulum):
    link = effects.apply(pendulum, Attachment("payload_mass", "rod", {"mass": 0.1})).link("rod")
    # about the joint: m l²/3 + m_p l²
    about = link.inertia[1, 1] + link.mass * link.com[2] ** 2
    assert link.mass == pytest.approx(0.3)
    assert about == pytest.approx(0.2 * 0.09 / 3.0 + 0.1 * 0.09, rel=1e-9)
    assert link.mass * link.com[2] == pytest.approx(-(0.2 * 0.15 + 0.1 * 0.3), rel=1e-9)


def test_centre_of_mass_along_and_beside(pendulum):
    along = effects.apply(pendulum, Attachment("com_offset", "rod", {"offset": 0.01})).link("rod")
    assert np.allclose(along.com, [0.0, 0.0, -0.16], rtol=0, atol=1e-15)
    beside = effects.apply(pendulum, Attachment("com_side_offset", "rod", {"offset": 0.01})).link("rod")
    # axis y × (−z) = −x
    assert np.allclose(beside.com, [-0.01, 0.0, -0.15], rtol=0, atol=1e-15)


def test_inertia_of_a_link_that_other_joints_turn_and_of_no_other(pendulum):
    with pytest.raises(InputError, match="added_inertia"):
        effects.apply(pendulum, Attachment("link_inertia", "rod", {"share": 0.5}))
    rod = pendulum.link("rod")
    joint = replace(pendulum.joint("pivot"), name="elbow", parent="rod", child="tip", xyz=np.array([0.0, 0.0, -0.3]))
    double = replace(pendulum, joints=(*pendulum.joints, joint), links=(*pendulum.links, replace(rod, name="tip")))
    tip = effects.apply(double, Attachment("link_inertia", "tip", {"share": 0.5})).link("tip")
    assert np.allclose(tip.inertia, 1.5 * rod.inertia, rtol=0, atol=1e-18)
    assert tip.mass == rod.mass and np.array_equal(tip.com, rod.com)
    assert effects.sites(effects.effect("link_inertia"), double) == ("rod", "tip")


def test_a_tilted_base_shifts_the_equilibrium_back(pendulum):
    angle = 0.1
    tilted = effects.apply(pendulum, Attachment("base_tilt", "base", {"angle": angle}))
    assert np.linalg.norm(tilted.gravity) == pytest.approx(9.81)
    # At q = −angle the rod is along gravity: no torque about the axis.
    q = -angle
    rod_direction = np.array([-np.sin(q), 0.0, -np.cos(q)])  # turn of −z about +y by q
    assert np.linalg.norm(np.cross(rod_direction, tilted.gravity)) < 1e-12


def test_a_base_that_gives_is_tilted_about_the_joint_and_not_about_its_slide(pendulum):
    give = Attachment("base_compliance", "base", {"stiffness": 1e4, "mass": 2.0, "damping": 5.0})
    tilt = Attachment("base_tilt", "base", {"angle": 0.1})
    alone = effects.apply(pendulum, tilt)
    assert np.allclose(effects.apply(effects.apply(pendulum, give), tilt).gravity, alone.gravity, rtol=0, atol=1e-15)


def test_a_compliant_base_slides_across_the_axis(pendulum):
    soft = effects.apply(
        pendulum, Attachment("base_compliance", "base", {"stiffness": 1e4, "mass": 2.0, "damping": 5.0})
    )
    slide = soft.joints[0]
    assert slide.prismatic and slide.stiffness == 1e4 and slide.damping == 5.0
    assert soft.link(slide.child).mass == 2.0
    assert abs(slide.axis @ [0.0, 1.0, 0.0]) < 1e-12 and abs(slide.axis @ soft.gravity) < 1e-12
    assert soft.joint("pivot").parent == slide.child


def test_a_drive_side_keeps_friction_and_armature(pendulum):
    geared = pendulum.replace_joint(replace(pendulum.joint("pivot"), armature=3e-4, damping=1e-3, friction=2e-3))
    split = effects.apply(geared, Attachment("joint_flexibility", "pivot", {"stiffness": 4.0, "damping": 0.01}))
    drive, coupling = split.joint("pivot"), split.joint("pivot_coupling")
    assert (drive.armature, drive.damping, drive.friction) == (3e-4, 1e-3, 2e-3)
    assert (coupling.stiffness, coupling.damping, coupling.child) == (4.0, 0.01, "rod")
    assert split.joint_names == ("pivot", "pivot_coupling")


def test_refusals_name_what_is_wrong(pendulum):
    cases = [
        (Attachment("coulomb_frction", "pivot", {"torque": 1.0}), "did you mean 'coulomb_friction'"),
        (Attachment("coulomb_friction", "pivt", {"torque": 1.0}), "did you mean 'pivot'"),
        (Attachment("coulomb_friction", "pivot", {"torque": -1.0}), "not possible"),
        (Attachment("coulomb_friction", "pivot", {}), "lacks its parameter 'torque'"),
        (Attachment("coulomb_friction", "pivot", {"torqe": 1.0}), "no parameter 'torqe'"),
        (Attachment("coulomb_friction", "pivot", {"torque": float("nan")}), "not possible"),
        (Attachment("modal_damping", "rod", {"damping_ratio": 0.1}), "is rigid"),
    ]
    for attachment, words in cases:
        with pytest.raises(InputError, match=words):
            effects.apply(pendulum, attachment)


def test_a_contained_effect_is_not_paired_with_its_container():
    assert not effects.compatible([("coulomb_friction", "pivot"), ("stribeck_friction", "pivot")])
    assert effects.compatible([("coulomb_friction", "pivot"), ("stribeck_friction", "elbow")])
    assert not effects.compatible([("base_tilt", "base"), ("base_tilt", "base")])


def test_the_sensor_chain_runs_from_the_motion_to_the_file():
    attached = [
        Attachment("sensor_saturation", "pivot.position", {"limit": 1.0}),
        Attachment("sensor_offset", "pivot.position", {"offset": 0.1}),
        Attachment("sensor_offset", "elbow.position", {"offset": 0.1}),
        Attachment("sensor_delay", "pivot.position", {"delay": 0.1}),
        Attachment("clock_skew", "elbow.position", {"factor": 1.01}),
        Attachment("actuator_gain", "pivot", {"gain": 1.1}),
    ]
    names = [effect.name for effect, _ in effects.sensor_chain(attached, "pivot.position")]
    assert names == ["clock_skew", "sensor_delay", "sensor_offset", "sensor_saturation"]
    assert [effect.name for effect, _ in effects.input_chain(attached, "pivot")] == ["actuator_gain"]


def test_what_little_else_can_be_bent_to_may_be_a_sensors_too():
    known = effects.catalogue()
    usual = {name for name, effect in known.items() if effect.usual}
    assert {name for name, effect in known.items() if effect.plain} <= usual
    assert {"sensor_offset", "sensor_gain", "viscous_damping"} <= usual and not known["sensor_offset"].plain
    # Several numbers; a past of its own; seldom met; a word on how another one acts.
    assert not {"stribeck_friction", "sensor_lowpass", "load_dependent_friction", "friction_creep"} & usual


def test_the_documentation_is_the_catalogue():
    written = Path(__file__).parents[2] / "docs" / "effects.md"
    assert written.read_text(encoding="utf-8") == page(), "run: python -m harness.effects.page > docs/effects.md"
