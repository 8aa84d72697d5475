"""How far two right answers may lie apart, and why."""

from __future__ import annotations


def acceleration_allowed(n: int) -> tuple[float, str]:
    """Relative difference allowed between accelerations of a mechanism with n coordinates, and the reason.

    Measured between Pinocchio and MuJoCo: 2e-15 at n = 1, 1e-14 at 7, 1e-12 at 50, 3e-11 at 200, 3e-10 at 1000. The
    inverse of the mass matrix multiplies rounding (1.1e-16) by its condition number, about n⁴ on a chain.
    """
    if n <= 7:
        return (
            1e-12,
            f"rounding times the condition number of {_of(n)}; other engines differ by 1e-14 among themselves, up to 7",
        )
    if n <= 50:
        return 1e-10, f"rounding times the condition number of {_of(n)}; other engines differ by 1e-12, up to 50"
    return 1e-9, f"rounding times the condition number of {_of(n)}; other engines differ by 3e-10, up to 1000"


def _of(n: int) -> str:
    return f"{n} coordinate{'s' * (n > 1)}"
