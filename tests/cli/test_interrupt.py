"""A Ctrl-C that falls into a callback from C, where Python ignores exceptions, is heard all the same."""

import os
import signal
import subprocess
import sys

import pytest


def run_alone(code: str) -> subprocess.CompletedProcess[str]:
    """A Python of its own, that hears SIGINT: a shell that started these tests in the background has had it ignored, and children
    inherit that."""
    return subprocess.run(
        [sys.executable, "-c", code],
        capture_output=True,
        text=True,
        timeout=60,
        check=False,
        preexec_fn=lambda: signal.signal(signal.SIGINT, signal.SIG_DFL),
    )


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
    child = run_alone(SWALLOWED.format(heard=call))
    assert child.returncode == 0
    assert child.stdout.strip() == outcome
    assert ("Traceback" in child.stderr) == (outcome == "lost")


HALF_DONE = """
import ctypes, os, signal, sys, time
from harness.cli import main
from harness.cli.interrupt import hear_at_once
@ctypes.CFUNCTYPE(None)
def called_from_c():
    os.kill(os.getpid(), signal.{number})
    for _ in range(1000):
        pass
def broken(**_):
    hear_at_once()
    called_from_c()
    raise RuntimeError("nothing was compiled")
signal.signal(signal.SIGUSR1, lambda *_: None)
main.denoc.main = broken
status = main.status_of([])
time.sleep(0.2)  # nothing comes after it
sys.exit(status)
"""


@pytest.mark.skipif(os.name == "nt", reason="Windows has no timer signals")
@pytest.mark.parametrize(
    ("number", "status", "said"),
    [("SIGINT", 130, "denoc: stopped; nothing was written"), ("SIGUSR1", 2, "denoc: a defect in denoc: RuntimeError")],
)
def test_an_error_that_a_lost_interrupt_left_is_no_defect(number, status, said):
    child = run_alone(HALF_DONE.format(number=number))
    assert child.returncode == status
    assert child.stderr.startswith(said)
    assert len(child.stderr.splitlines()) == 1


@pytest.mark.parametrize(
    "chained", ["raise ImportError('initialization failed') from interrupt", "raise ImportError('half')"]
)
def test_an_interrupt_inside_a_compiled_module_that_loads_is_one(chained, monkeypatch, capsys):
    """Such a module says that it cannot be loaded, by an ImportError that comes of the interrupt."""
    from harness.cli import main

    def interrupted(**_options):
        try:
            raise KeyboardInterrupt
        except KeyboardInterrupt as interrupt:
            exec(chained, {"interrupt": interrupt})

    monkeypatch.setattr(main.denoc, "main", interrupted)
    assert main.status_of(["doctor"]) == 130
    assert capsys.readouterr().err == "denoc: stopped; nothing was written\n"


LOADS = """
import os, signal, sys
from harness.compiled_packages import loaded
{before}
try:
    package = loaded("half_loaded")
except KeyboardInterrupt:
    print("heard", hasattr(sys.modules.get("half_loaded"), "compiled"))
else:
    print("lost", hasattr(package, "compiled"))
"""
# A package as Exudyn is: whatever keeps its compiled part from loading, it tries another way and hides the first.
HALF_LOADED = """
import os, signal
try:
    os.kill(os.getpid(), signal.SIGINT)
    for _ in range(1000):
        pass
    compiled = True
except BaseException:
    pass
"""


@pytest.mark.skipif(os.name == "nt", reason="Windows has no kill that a handler hears")
@pytest.mark.parametrize(
    ("before", "said"), [("", "heard True"), ("signal.signal(signal.SIGINT, signal.SIG_IGN)", "lost True")]
)
def test_an_interrupt_while_a_compiled_package_loads_waits_until_it_is_there(tmp_path, before, said):
    (tmp_path / "half_loaded.py").write_text(HALF_LOADED)
    child = run_alone(f"import sys; sys.path.insert(0, {str(tmp_path)!r})\n" + LOADS.format(before=before))
    assert (child.stdout.strip(), child.stderr) == (said, "")
    assert child.returncode == 0
