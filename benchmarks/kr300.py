"""An industrial robot's public recordings as a rig: six axes, motor encoders and motor torques.

    git clone https://github.com/JonasWeigand/Robot_Identification SOURCE
    python benchmarks/kr300.py --source SOURCE --out kr300
    denoc diagnose kr300/A.csv kr300/B.csv kr300/C.csv --model kr300/model.toml --fit-effort

The model is its authors' (KUKA Quantec Ultra KR300, ``robot_model/``): links, rotors and gears, without the friction and the
hydraulic counterbalance of axis 2 that their own simulation adds. Nothing of theirs (MIT) is part of this repository.
"""

from __future__ import annotations

import argparse
import re
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.io import loadmat
from scipy.spatial.transform import Rotation

from harness.system import Joint, JointType, Link, System
from harness.system.write import write

Array = NDArray[np.float64]

# Where the axes of the model are while the recorded angles are zero [rad]: as ``robot_dynamics.m`` adds to them.
ZEROS = np.deg2rad([0.0, -90.0, 90.0, 0.0, 0.0, 0.0])
# What hangs on the flange [kg]: they identify 3.05 steps of 25 kg from 75 kg on, which is 151 kg, and 0.1 m beyond it.
PAYLOAD, FLANGE, PAYLOAD_AT, FLANGE_AT = 150.0, 17.78, 0.1, -0.05
RECORDINGS = "ABC"
SECOND = 3  # axes with an encoder behind the gear


@dataclass(frozen=True)
class Axis:
    """An axis by Denavit and Hartenberg: d, a [m], alpha, offset [rad]; and what it carries, about the axes of its end."""

    d: float
    a: float
    alpha: float
    offset: float
    mass: float
    com: Array
    inertia: Array
    rotor: float

    @property
    def end(self) -> tuple[Array, Array]:
        """Rotation and place of the axis's end, from where it turns."""
        return Rotation.from_euler("x", self.alpha).as_matrix(), np.array([self.a, 0.0, self.d])


def axes_of(text: str) -> list[Axis]:
    """The axes of the authors' model file; the last one with flange and payload."""
    out = []
    plain = re.sub(r"\.\.\.\s*\n|'revolute'\s*,", " ", re.sub(r"%.*", "", text))
    for body in re.findall(r"L\(\d\)\s*=\s*Link\((.*?)\)\s*;", plain, re.DOTALL):
        fields = dict(re.findall(r"'(\w+)'\s*,\s*(\[[^\]]*\][^,]*|[^,\]]+)", body))
        given = {key: _number(fields[key]) for key in ("d", "a", "alpha", "offset", "Jm", "G") if key in fields}
        flange = "I" not in fields
        tensor = np.zeros(6) if flange else _numbers(fields["I"])
        xx, yy, zz, xy, yz, xz = tensor
        mass = PAYLOAD + FLANGE if flange else _number(fields["m"])
        at = (PAYLOAD * PAYLOAD_AT + FLANGE * FLANGE_AT) / mass
        com = np.array([0.0, 0.0, at]) if flange else _numbers(fields["r"])
        out.append(
            Axis(
                given["d"], given["a"], given["alpha"], given.get("offset", 0.0), mass, com,
                np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]]), given["Jm"] * given["G"] ** 2,
            )
        )  # fmt: skip
    return out


def _number(text: str) -> float:
    """A number of the authors' notation: a product or quotient of plain ones."""
    value = 1.0
    for sign, part in re.findall(
        r"([*/]?)\s*(-?\s*[\w.]+)", text.replace("deg_to_rad", repr(np.pi / 180.0)).replace("pi", repr(np.pi))
    ):
        number = float(part.replace(" ", ""))
        value = value / number if sign == "/" else value * number
    return value


def _numbers(text: str) -> Array:
    """A list of the authors', times a power of ten."""
    found = re.match(r"\[(.*?)\]\*10\^(-?\d+)", text.strip())
    if found is None:
        raise SystemExit(f"{text.strip()}: no list of numbers times a power of ten, as the authors write it")
    return np.array([float(v) for v in found[1].split(",")]) * 10.0 ** int(found[2])


def system_of(axes: list[Axis]) -> System:
    """The robot upright on a base, its axes' zeros where the recorded angles are zero."""
    turn, place = Rotation.from_euler("x", np.pi).as_matrix(), np.zeros(3)
    links, joints = list[Link](), list[Joint]()
    for k, axis in enumerate(axes):
        at = turn @ Rotation.from_euler("z", axis.offset + ZEROS[k]).as_matrix()
        bent, end = axis.end
        links.append(Link(f"l{k + 1}", mass=axis.mass, com=bent @ axis.com + end, inertia=bent @ axis.inertia @ bent.T))
        joints.append(
            Joint(
                f"a{k + 1}", JointType.REVOLUTE, f"l{k}" if k else "base", f"l{k + 1}", xyz=place, rotation=at,
                axis=np.array([0.0, 0.0, 1.0]), armature=axis.rotor,
            )
        )  # fmt: skip
        turn, place = bent, end
    return System("kr300", tuple(joints), tuple(links), tolerance=0.01)


def recorded(source: Path, name: str) -> Any:
    """What one of the authors' recordings holds."""
    (folder,) = (source / "data" / "recorded_trajectories").glob(f"* {name} *")
    return loadmat(str(folder / "data.mat"), squeeze_me=True, struct_as_record=False)


def main() -> None:
    """Read the authors' folder, write model and recordings."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--source", type=Path, required=True)
    parser.add_argument("--out", type=Path, required=True)
    args = parser.parse_args()
    (file,) = (args.source / "robot_model").glob("*.m")
    system = system_of(axes_of(file.read_text(encoding="utf-8", errors="replace")))
    args.out.mkdir(parents=True, exist_ok=True)
    write(system, args.out / "model.toml")
    for name in RECORDINGS:
        whole = recorded(args.source, name)
        seen, gear = whole["rec"], np.asarray(whole["para"].u)
        behind = np.deg2rad(seen.act_pos_se_deg)[:SECOND]
        columns = [
            seen.time_cont,
            *np.deg2rad(seen.act_pos_mot_deg),
            *behind,
            *(gear[:, None] * seen.act_torque_abs_nm),
        ]
        heads = [
            "time",
            *(f"a{k}.position" for k in range(1, 7)),
            *(f"a{k}.link_position" for k in range(1, SECOND + 1)),
        ]
        heads += [f"a{k}.effort" for k in range(1, 7)]
        np.savetxt(
            args.out / f"{name}.csv",
            np.transpose(columns),
            fmt="%.9g",
            delimiter=",",
            header=",".join(heads),
            comments="",
        )


if __name__ == "__main__":
    main()
