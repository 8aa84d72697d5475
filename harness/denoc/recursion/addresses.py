"""Where the compiled dynamics of a kind of mechanism stand; what is not asked for is neither imported nor compiled."""

from __future__ import annotations


def addresses(flexible: bool) -> tuple[int, int]:
    """Addresses of forward and inverse dynamics, passive forces counted."""
    if flexible:
        from harness.denoc.recursion import flexible_address

        return flexible_address.addresses()
    from harness.denoc.recursion import rigid_address

    return rigid_address.addresses()
