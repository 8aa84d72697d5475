"""An engine that is not there says what brings it: its package, or what its package lacks of the system."""

import pytest

from harness.errors import cannot_be_loaded, install


@pytest.mark.parametrize(
    ("error", "text"),
    [
        ("No module named 'exudyn'", "Exudyn cannot be loaded (No module named 'exudyn'): " + install("engines")),
        # What the dynamic linker says in a bare Debian container: pip cannot mend that.
        (
            "Tried: .exudynCPP -> libGL.so.1: cannot open shared object file: No such file or directory",
            "Exudyn is installed, but this system lacks libGL.so.1: apt install libgl1 on Debian or Ubuntu",
        ),
        (
            "libgomp.so.1: cannot open shared object file: No such file or directory",
            "Exudyn is installed, but this system lacks libgomp.so.1: apt install libgomp1 on Debian or Ubuntu",
        ),
        (
            "libX11.so.6: cannot open shared object file: No such file or directory",
            "Exudyn is installed, but this system lacks libX11.so.6: the system's package manager has it",
        ),
    ],
)
def test_the_mend_is_the_one_that_helps(error: str, text: str) -> None:
    assert str(cannot_be_loaded("Exudyn", ImportError(error), install("engines"))) == text
