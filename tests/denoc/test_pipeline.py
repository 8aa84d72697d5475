"""The garbage collector while kernels are compiled: less often, never more often than the user has it, and as before afterwards."""

import gc
from collections.abc import Iterator
from typing import Any

import pytest
from numba import njit
from numba.core.compiler import CompilerBase

from harness.denoc.compiling.pipeline import Kernel

USUAL = (700, 10, 10)


@pytest.fixture
def meanwhile(monkeypatch: pytest.MonkeyPatch) -> Iterator[list[tuple[int, int, int]]]:
    """Thresholds as the compiler finds them; the test's own are put back."""
    before, seen = gc.get_threshold(), []
    compile_extra = CompilerBase.compile_extra

    def watched(self: CompilerBase, function: object) -> object:
        seen.append(gc.get_threshold())
        return compile_extra(self, function)

    monkeypatch.setattr(CompilerBase, "compile_extra", watched)
    yield seen
    gc.set_threshold(*before)


def _compile() -> None:
    @njit(pipeline_class=Kernel)
    def doubled(x: float) -> float:
        return 2.0 * x

    assert doubled(2.5) == 5.0


def test_collections_are_rare_while_a_kernel_is_compiled(meanwhile: list[tuple[int, int, int]]) -> None:
    gc.set_threshold(*USUAL)
    _compile()
    assert meanwhile and all(seen[0] > USUAL[0] for seen in meanwhile)
    assert gc.get_threshold() == USUAL


@pytest.mark.parametrize("chosen", [(0, 10, 10), (1_000_000, 10, 10)], ids=["none", "fewer still"])
def test_a_user_who_has_fewer_collections_keeps_them(
    meanwhile: list[tuple[int, int, int]], chosen: tuple[int, int, int]
) -> None:
    gc.set_threshold(*chosen)
    _compile()
    assert meanwhile == [chosen]
    assert gc.get_threshold() == chosen


def test_thresholds_return_after_a_kernel_that_cannot_be_compiled(meanwhile: list[tuple[int, int, int]]) -> None:
    gc.set_threshold(*USUAL)

    @njit(pipeline_class=Kernel)
    def wrong(x: Any) -> Any:
        return x.nothing_of_the_kind

    with pytest.raises(Exception, match="nothing_of_the_kind"):
        wrong(1.0)
    assert gc.get_threshold() == USUAL
