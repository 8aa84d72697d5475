"""Faults at one joint or body of several, which show along the whole chain and must be named where they are; and of loops in lanes."""

from __future__ import annotations

from harness.cases.gate.planted.patch import of_file


def _if(owner: str, name: str, factor: str) -> str:
    return f'({factor} if {owner}.name == "{name}" else 1.0)'


OF_ENGINES = (
    *of_file(
        "pinocchio_model.py", "chain_7",
        ("one axis turned round", "kind(np.array(joint.axis))", f'kind({_if("joint", "joint5", "-1.0")} * np.array(joint.axis))', "pinocchio; axis @ joint5"),
        ("one armature a tenth too small", "armature.append(joint.armature)", f'armature.append({_if("joint", "joint3", "0.9")} * joint.armature)',
         "pinocchio; armature @ joint3"),
        ("one mass a thousandth too large", "pin.Inertia(float(link.mass),", f'pin.Inertia({_if("link", "link4", "1.001")} * float(link.mass),',
         "pinocchio; mass @ link4"),
        ("one centre of mass a thousandth too far out", "np.array(link.com), np.array(link.inertia))",
         f'{_if("link", "link5", "1.001")} * np.array(link.com), np.array(link.inertia))', "pinocchio; com @ link5"),
        ("one inertia a thousandth too large", "np.array(link.com), np.array(link.inertia))",
         f'np.array(link.com), {_if("link", "link6", "1.001")} * np.array(link.inertia))', "pinocchio; inertia @ link6"),
    ),
    *of_file(
        "mujoco_model.py", "chain_7",
        ("one arm a thousandth too long", "pos=np.array(joint.xyz),", f'pos={_if("joint", "joint4", "1.001")} * np.array(joint.xyz),', "mujoco; xyz @ joint4"),
        ("damping of one joint a tenth too strong", "damping=np.array([joint.damping, drag",
         f'damping=np.array([{_if("joint", "joint6", "1.1")} * joint.damping, drag', "mujoco; damping @ joint6"),
        ("armature of a slider forgotten", "springref=slack,\n                armature=joint.armature,",
         f'springref=slack,\n                armature={_if("joint", "joint2", "0.0")} * joint.armature,', "mujoco; armature @ joint2"),
    ),
    *of_file(
        "mujoco_model.py", "joint_springs",
        ("one spring twice as stiff", "stiffness=np.array([joint.stiffness,", f'stiffness=np.array([{_if("joint", "joint2", "2.0")} * joint.stiffness,',
         "acceleration; mujoco; stiffness @ joint2"),
    ),
    *of_file(
        "exudyn_rigid_model.py", "chain_7",
        ("damping of one joint a hundredth too strong", "jointDControlVector=np.array([joint.damping for",
         f'jointDControlVector=np.array([{_if("joint", "joint5", "1.01")} * joint.damping for', "exudyn; damping @ joint5"),
    ),
)  # fmt: skip

OF_ROWS = (
    *of_file(
        "tree.py", "chain_7",
        ("one joint a thousandth too far out", "row[OFFSET : OFFSET + 3] = origin", f'row[OFFSET : OFFSET + 3] = {_if("joint", "joint3", "1.001")} * origin',
         "acceleration; xyz @ joint3"),
        ("one armature a hundredth too large", "= joint.armature, joint.damping", f'= {_if("joint", "joint6", "1.01")} * joint.armature, joint.damping',
         "acceleration; armature @ joint6"),
        ("damping of a slider a hundredth too large", "= joint.armature, joint.damping", f'= joint.armature, {_if("joint", "joint2", "1.01")} * joint.damping',
         "acceleration; damping @ joint2"),
        ("one first moment a thousandth too large", "row[MOMENT : MOMENT + 3] += link.mass * com",
         f'row[MOMENT : MOMENT + 3] += {_if("link", "link5", "1.001")} * link.mass * com', "acceleration; body @ link5"),
    ),
    *of_file(
        "tree.py", "joint_springs",
        ("one spring slack a tenth of a radian off", "= joint.stiffness, joint.rest_position",
         '= joint.stiffness, joint.rest_position + 0.1 * (joint.name == "joint4")', "acceleration; rest_position @ joint4"),
    ),
    *of_file(
        "lanes/model.py", "lanes_chain",
        ("one joint a millimetre off", "row[at : at + 3] = joint.xyz", 'row[at : at + 3] = joint.xyz + 1e-3 * (joint.name == "joint3")',
         "lanes_adaptive; xyz @ joint3"),
        ("one rigid part a thousandth too heavy", "row[at + 6 : at + 16] = _rigid_part(link)",
         f'row[at + 6 : at + 16] = {_if("link", "link2", "1.001")} * _rigid_part(link)', "lanes_adaptive; body @ link2"),
        ("one armature forgotten", "row[places] = joint.armature, joint.damping", f'row[places] = {_if("joint", "joint4", "0.0")} * joint.armature, joint.damping',
         "lanes_adaptive; armature @ joint4"),
        ("damping of one joint a hundredth too strong", "row[places] = joint.armature, joint.damping",
         f'row[places] = joint.armature, {_if("joint", "joint1", "1.01")} * joint.damping', "lanes_adaptive; damping @ joint1"),
    ),
)  # fmt: skip

LOOPS_IN_LANES = of_file(
    "lanes/closed.py", "lanes_closed",
    ("a point of a loop that half of its turning accelerates", "plus(cross(al2, b), cross(w2, cross(w2, b))))", "plus(cross(al2, b), _times(0.5, cross(w2, cross(w2, b)))))",
     "lanes_loop_motion; loops @ -"),
)  # fmt: skip

ONE_PLACE = (*OF_ENGINES, *OF_ROWS, *LOOPS_IN_LANES)
