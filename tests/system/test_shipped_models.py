"""The models that come with the project are read without a complaint, and are what their comments say."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from jacobian_mechanics import mass_matrix

import harness

MODELS = Path(__file__).resolve().parents[2] / "models"
ALL = sorted(path for path in MODELS.rglob("*") if path.suffix in (".urdf", ".xml", ".toml"))


@pytest.mark.parametrize("path", ALL, ids=lambda p: f"{p.parent.name}/{p.stem}")
def test_every_model_is_read_without_notes(path: Path) -> None:
    assert harness.load(path).notes == ()


@pytest.mark.parametrize("path", ["urdf/rigid_pendulum.urdf", "mjcf/rigid_pendulum.xml"])
def test_rigid_pendulum_is_the_papers(path: str) -> None:
    """ρl³/3 + m_p l² + I_h about the pivot, (ρl²/2 + m_p l) g for gravity: 1.0657 Hz for small swings."""
    system = harness.load(MODELS / path)
    inertia = mass_matrix(system, np.zeros(1))[0, 0]
    assert inertia == pytest.approx(0.180 * 0.30**2 / 3 + 0.020 * 0.30**2 + 2e-5, rel=1e-12)
    link = system.links[0]
    torque = -link.mass * link.com[2] * 9.81
    assert torque == pytest.approx((0.180 * 0.15 + 0.020 * 0.30) * 9.81, rel=1e-12)
    assert np.sqrt(torque / inertia) / (2 * np.pi) == pytest.approx(1.0657, abs=5e-5)
    assert system.joints[0].damping == 1.9e-3
    assert system.joint_names == ("pivot",)


@pytest.mark.parametrize("name", ["rigid_pendulum", "double_pendulum", "triple_pendulum", "cart_pendulum"])
def test_urdf_and_mjcf_say_the_same(name: str) -> None:
    urdf, mjcf = harness.load(MODELS / f"urdf/{name}.urdf"), harness.load(MODELS / f"mjcf/{name}.xml")
    assert urdf.joint_names == mjcf.joint_names
    q = np.random.default_rng(1).uniform(-2, 2, len(urdf.joint_names))
    np.testing.assert_allclose(mass_matrix(urdf, q), mass_matrix(mjcf, q), rtol=0, atol=1e-14)
    assert [j.damping for j in urdf.joints] == [j.damping for j in mjcf.joints]
