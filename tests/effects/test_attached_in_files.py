"""``[[effect]]`` tables of a model file that nothing can act by are refused before anything runs, with the file's name."""

import pytest

from harness.engines.attached import check_attached
from harness.errors import InputError
from harness.system import load

RIG = """
[[joint]]
name = "pivot"
type = "revolute"
parent = "base"
child = "rod"
axis = [0, 1, 0]
[[link]]
name = "rod"
mass = 0.2
com = [0, 0, -0.15]
inertia = [1.5e-3, 1.5e-3, 1e-6]
[[effect]]
"""


@pytest.mark.parametrize(
    ("table", "said"),
    [
        (
            'name = "coulomb"\nsite = "pivot"\nparameters = { torque = 0.01 }',
            r"no effect 'coulomb' \(did you mean 'coulomb_friction'",
        ),
        (
            'name = "coulomb_friction"\nsite = "pivt"\nparameters = { torque = 0.01 }',
            r"no joint 'pivt' \(did you mean 'pivot'",
        ),
        ('name = "payload_mass"\nsite = "pivot"\nparameters = { mass = 0.1 }', "there is no link 'pivot'"),
        ('name = "base_tilt"\nsite = "rod"\nparameters = { angle = 0.1 }', "there is no base 'rod'"),
        (
            'name = "coulomb_friction"\nsite = "pivot"\nparameters = { torqe = 0.01 }',
            r"no parameter 'torqe' \(did you mean 'torque'",
        ),
        (
            'name = "coulomb_friction"\nsite = "pivot"\nparameters = { torque = -0.01 }',
            "torque = -0.01 is not possible",
        ),
    ],
)
def test_an_effect_that_cannot_act_is_refused_with_the_file(tmp_path, table, said):
    (tmp_path / "rig.toml").write_text(RIG + table)
    with pytest.raises(InputError, match=said) as told:
        check_attached(load(tmp_path / "rig.toml"))
    assert "rig.toml" in str(told.value)
