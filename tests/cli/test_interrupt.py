"""A Ctrl-C that falls into a callback from C, where Python ignores exceptions, is heard all the same."""

import os
import signal
import subprocess
import sys

import pytest

SWALLOWED = """
import ctypes, os, signal, time
from harness.cli.interrupt import hear_at_once
{heard}
@ctypes.CFUNCTYPE(None)
def called_from_c():
    os.kill(os.getpid(), signal.SIGINT)
    for _ in range(1000):
        pass  # the exception comes here, and goes no further
try:
    called_from_c()
    time.sleep(3.0)
except KeyboardInterrupt:
    print("heard")
else:
    print("lost")
"""


@pytest.mark.skipif(os.name == "nt", reason="Windows has no timer signals")
@pytest.mark.parametrize(("call", "outcome"), [("hear_at_once()", "heard"), ("", "lost")])
def test_an_interrupt_inside_a_callback_comes_again(call, outcome):
    # A shell that started these tests in the background has had SIGINT ignored, and children inherit that.
    child = subprocess.run(
        [sys.executable, "-c", SWALLOWED.format(heard=call)],
        capture_output=True,
        text=True,
        timeout=60,
        check=True,
        preexec_fn=lambda: signal.signal(signal.SIGINT, signal.SIG_DFL),
    )
    assert child.stdout.strip() == outcome
    assert ("Traceback" in child.stderr) == (outcome == "lost")
