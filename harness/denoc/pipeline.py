"""How numba is led through a kernel: the passes that kernels need, and machine code only for what is called from outside.

Kernels are long rows of formulas without closures, exceptions, context managers or generators. numba's usual passes look for all
of these several times over, which is a sixth of the time (``Kernel``). And it makes machine code of every function, of
those too that other kernels only ever take in: another fifth (``Part``).

Compiling makes objects by the million and keeps most of them, so that the garbage collector, at its usual pace, walks
through all of them again and again and finds nothing: a twentieth of the time, where other work fills the caches a quarter. It
comes less often meanwhile.

The classes are numba's own points of extension (``njit(pipeline_class=…)``, ``CodeLibrary``); a numba that is built
otherwise is left to compile in its own way.
"""

from __future__ import annotations

import contextlib
import gc
from collections.abc import Iterator
from typing import Any

from numba.core import codegen, typed_passes, untyped_passes
from numba.core.compiler import Compiler, CompilerBase
from numba.core.compiler_machinery import PassManager

# In the order in which they run; those that numba has besides are for what kernels do not contain.
_PASSES = (
    (untyped_passes, "TranslateByteCode"),
    (untyped_passes, "FixupArgs"),
    (untyped_passes, "IRProcessing"),
    (untyped_passes, "GenericRewrites"),
    (untyped_passes, "ReconstructSSA"),
    (typed_passes, "NopythonTypeInference"),
    (typed_passes, "PreLowerStripPhis"),
    (typed_passes, "NoPythonSupportedFeatureValidation"),
    (typed_passes, "IRLegalization"),
    (typed_passes, "NativeLowering"),
    (typed_passes, "NoPythonBackend"),
)

# Objects made before the collector looks at the youngest; how often it looks at those before it looks at older ones. With
# these a process that compiles everything takes a tenth more memory, where no collections at all take twice as much.
_COLLECTIONS = (50_000, 20, 5)


@contextlib.contextmanager
def _fewer_collections() -> Iterator[None]:
    """Let the garbage collector come less often than the user has it, if he has it at all."""
    before = gc.get_threshold()
    if 0 < before[0] < _COLLECTIONS[0]:
        gc.set_threshold(*_COLLECTIONS)
    try:
        yield
    finally:
        gc.set_threshold(*before)


class _Kernel(CompilerBase):
    """The compiler with the passes of ``_PASSES``."""

    def compile_extra(self, function: Any) -> Any:
        """Compile a function, and first whatever it calls."""
        with _fewer_collections():
            return super().compile_extra(function)

    def define_pipelines(self) -> list[Any]:
        passes = PassManager("kernel")
        for home, name in _PASSES:
            passes.add_pass(getattr(home, name), name)
        passes.finalize()
        return [passes]


class _Absent:
    """The code generator of a library that has no code: nothing in it can be set."""

    def __init__(self, generator: Any) -> None:
        self._generator = generator

    def __getattr__(self, name: str) -> Any:
        return getattr(self._generator, name)

    def set_env(self, name: str, environment: Any) -> None:
        """Nothing: the environment is for calls from Python and for exceptions."""


class _LinkedOnly(codegen.JITCodeLibrary):
    """Code that is linked into other code, and optimized and translated there."""

    @property
    def codegen(self) -> Any:
        return _Absent(self._codegen)

    def get_pointer_to_function(self, name: str) -> int:
        self._ensure_finalized()
        return 0

    def finalize(self) -> None:
        for library in dict.fromkeys(self._linking_libraries):
            self._reload_init.update(library._reload_init)
            self._final_module.link_in(library._get_module_for_linking(), preserve=True)
        self._finalize_dynamic_globals()
        self._finalized = True

    def get_asm_str(self) -> str:
        """Assembly of the code as it would be by itself."""
        self._ensure_finalized()
        alone = codegen.JITCodeLibrary(self._codegen, self.name)
        alone._final_module = self._final_module.clone()
        alone._optimize_final_module()
        return str(alone.get_asm_str())


class _Part(_Kernel):
    """``_Kernel`` for a function without wrappers, which only other kernels can call."""

    def __init__(
        self, typingctx: Any, targetctx: Any, library: Any, args: Any, return_type: Any, flags: Any, locals: Any
    ) -> None:
        super().__init__(typingctx, targetctx, library, args, return_type, flags, locals)
        if self.state.library is None and flags.no_cpython_wrapper and flags.no_cfunc_wrapper:
            self.state.library = _LinkedOnly(self.state.targetctx.codegen(), "part")


def _known() -> bool:
    """Whether this numba has what the classes above build on."""
    library = codegen.CPUCodeLibrary
    return all(hasattr(home, name) for home, name in _PASSES) and all(
        hasattr(library, name)
        for name in (
            "_ensure_finalized",
            "_get_module_for_linking",
            "_finalize_dynamic_globals",
            "_optimize_final_module",
        )
    )


#: For ``njit(pipeline_class=…)`` and ``cfunc``.
Kernel: Any = _Kernel if _known() else Compiler
#: The same for functions that only kernels call; they are not to be cached, being nothing by themselves.
Part: Any = _Part if _known() else Compiler
