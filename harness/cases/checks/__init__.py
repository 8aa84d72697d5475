"""Ready-made checks, one file each: a frozen dataclass that states what is compared and how much may differ."""

from harness.cases.checks.chaotic import ChaoticAgreement
from harness.cases.checks.energy import EnergyKept
from harness.cases.checks.frequency import FrequencyTruth
from harness.cases.checks.measured import Measured
from harness.cases.checks.period import PeriodTruth
from harness.cases.checks.point import PointTruth
from harness.cases.checks.states import StateAgreement
from harness.cases.checks.trajectory import TrajectoryAgreement

__all__ = [
    "ChaoticAgreement",
    "EnergyKept",
    "FrequencyTruth",
    "Measured",
    "PeriodTruth",
    "PointTruth",
    "StateAgreement",
    "TrajectoryAgreement",
]
