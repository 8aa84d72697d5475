"""An arm on one joint that tests drive in MuJoCo, and the model that they give to the diagnosis."""

from __future__ import annotations

import mujoco

MASS, COM, INERTIA = 0.7, 0.4, 0.012  # kg, m, kg·m² about the centre of mass
STEP = 0.0005  # s, of MuJoCo

URDF = f"""<robot name="arm"><link name="base"/>
<joint name="pivot" type="continuous"><parent link="base"/><child link="arm"/><axis xyz="0 1 0"/></joint>
<link name="arm"><inertial><origin xyz="0 0 {-COM}"/><mass value="{MASS}"/>
<inertia ixx="{INERTIA}" iyy="{INERTIA}" izz="0.0001" ixy="0" ixz="0" iyz="0"/></inertial></link></robot>"""


def arm(*, friction: float = 0.0, damping: float = 0.0) -> mujoco.MjModel:
    """The arm with dry friction [N·m] and viscous damping [N·m·s/rad] that the model does not have."""
    return mujoco.MjModel.from_xml_string(
        f"""<mujoco><option timestep="{STEP}" integrator="RK4"><flag contact="disable"/></option><worldbody><body>
        <joint type="hinge" axis="0 1 0" damping="{damping}" frictionloss="{friction}" solreffriction="0.001 1"/>
        <inertial pos="0 0 {-COM}" mass="{MASS}" diaginertia="{INERTIA} {INERTIA} 0.0001"/></body></worldbody></mujoco>"""
    )
