"""A user's own effect: loaded, simulated, refused with a place and a mend."""

from pathlib import Path

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from harness import effects
from harness.errors import InputError
from harness.system import Attachment, Joint, JointType, Link, System
from harness.system.description import constant

EXAMPLE = Path(__file__).parents[2] / "examples" / "own_effect.py"
GOOD = """
name = "leaf"
parameters = {"strength": {"unit": "N*m", "lower": 0.0, "scale": 0.01}}
def torque(position, velocity, time, p):
    return -p[0] * position
"""


def write(tmp_path, text):
    file = tmp_path / "mine.py"
    file.write_text(text)
    return file


def test_the_example_acts_as_its_formula_says():
    (magnet,) = effects.load_user_effects(EXAMPLE)
    assert magnet.parameter_names == ("energy", "angle", "width")
    mass, length = 0.2, 0.3
    inertia = constant(np.diag([mass * length**2 / 12.0] * 2 + [0.0]))
    joint = Joint("pivot", JointType.REVOLUTE, "base", "rod", axis=constant([0.0, 1.0, 0.0]))
    attached = Attachment("magnet", "pivot", {"energy": 0.01, "angle": 0.2, "width": 0.1})
    system = System(
        "p", (joint,), (Link("rod", mass, constant([0, 0, -length / 2]), inertia),), attachments=(attached,)
    )
    model = effects.lane_model(system, [magnet])
    time = np.linspace(0.0, 2.0, 201)
    position, _, _ = model.simulate(effects.lane_row(model, system, [magnet]), [0.5], [0.0], time)

    def rate(t, y):
        away = (y[0] - 0.2) / 0.1
        pull = -0.01 * away / 0.1 * np.exp(-0.5 * away**2)
        return [y[1], (pull - mass * 9.81 * length / 2 * np.sin(y[0])) / (mass * length**2 / 3)]

    expected = solve_ivp(rate, (0, 2), [0.5, 0], t_eval=time, rtol=1e-11, atol=1e-12, method="DOP853").y[0]
    assert np.abs(position[0, :, 0] - expected).max() < 1e-7


def test_several_effects_in_one_file(tmp_path):
    text = """
class Leaf:
    name = "leaf"
    parameters = {"a": {"unit": "N*m"}}
    def torque(position, velocity, time, p):
        return -p[0] * position
class Brush:
    name = "brush"
    parameters = {"b": {"unit": "N*m*s/rad", "lower": 0.0}}
    @staticmethod
    def torque(position, velocity, time, p):
        return -p[0] * velocity
"""
    assert [e.name for e in effects.load_user_effects(write(tmp_path, text))] == ["leaf", "brush"]


@pytest.mark.parametrize(
    ("change", "words"),
    [
        (('name = "leaf"', ""), "needs a name"),
        (("leaf", "base_tilt"), "is an effect of the catalogue already"),
        (('"unit": "N*m", ', ""), "states no unit"),
        (("lower", "lowest"), "'lowest' is unknown"),
        (('"scale": 0.01', '"scale": -1.0'), "scale -1 is no size"),
        (("position, velocity, time, p", "position, velocity, p"), "it must take position, velocity, time, p"),
        (("-p[0] * position", "-p[0] * undefined_name"), "cannot be compiled"),
        (("-p[0] * position", "float('nan')"), "finite number|cannot be compiled"),
        (("-p[0] * position", "-p[0] *"), "not valid Python"),
        (("def torque", "def talk"), "defines no effect"),
        (("name =", "import no_such_module\nname ="), "ModuleNotFoundError"),
    ],
)
def test_refusals(tmp_path, change, words):
    file = write(tmp_path, GOOD.replace(*change))
    with pytest.raises(InputError, match=words) as caught:
        effects.load_user_effects(file)
    assert str(file) in str(caught.value)
    assert "\n" not in str(caught.value)


def test_missing_file(tmp_path):
    with pytest.raises(InputError, match="no such file"):
        effects.load_user_effects(tmp_path / "none.py")
