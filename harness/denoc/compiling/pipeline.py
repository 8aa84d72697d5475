"""How numba is led through a kernel: the passes that kernels need, and machine code only for what is called from outside.

Kernels are long rows of formulas without closures, exceptions, context managers or generators. numba's usual passes look for all
of these several times over, which is a sixth of the time, and note four times how long every variable lives, for generators
and for counting references, of which only the last is read: a tenth (``Kernel``). And it makes machine code of every
function, of those too that other kernels only ever take in: another fifth (``Part``). Loops over the coordinates of one
mechanism are too short to be unrolled and vectorised, which makes two to three times their code of them; where a kernel has
no others, they stay as they are (``ShortLoops``).

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

import llvmlite.binding as llvm
from numba.core import codegen, ir_utils, ssa, transforms, typed_passes, untyped_passes
from numba.core.compiler import Compiler, CompilerBase
from numba.core.compiler_machinery import FunctionPass, PassManager, register_pass

from harness.denoc.compiling.code_library import Library, LinkedOnly, LoopsAsTheyAre


class _Pass(FunctionPass):
    """A pass without options."""

    def __init__(self) -> None:
        super().__init__()


@register_pass(mutates_CFG=True, analysis_only=False)
class _Canonical(_Pass):
    """``IRProcessing`` without the lives of variables: blocks in the form that all later passes expect."""

    _name = "kernel_canonical"

    def run_pass(self, state: Any) -> bool:
        function = state.func_ir
        function.blocks = transforms.canonicalize_cfg(function.blocks)
        function.generator_info = None
        return True


@register_pass(mutates_CFG=True, analysis_only=False)
class _SingleAssignment(_Pass):
    """``ReconstructSSA`` without the lives of variables."""

    _name = "kernel_single_assignment"

    def run_pass(self, state: Any) -> bool:
        state.func_ir = ssa.reconstruct_ssa(state.func_ir)
        state.func_ir._definitions = ir_utils.build_definitions(state.func_ir.blocks)
        return True


@register_pass(mutates_CFG=True, analysis_only=False)
class _WithoutPhis(_Pass):
    """``PreLowerStripPhis`` without the lives of variables."""

    _name = "kernel_without_phis"

    def run_pass(self, state: Any) -> bool:
        state.func_ir = typed_passes.PreLowerStripPhis()._strip_phi_nodes(state.func_ir)
        state.func_ir._definitions = ir_utils.build_definitions(state.func_ir.blocks)
        return True


# numba's by name and ours in place of some, in the order in which they run; those that numba has besides are for what kernels
# do not contain.
_PASSES: tuple[tuple[Any, str] | type[Any], ...] = (
    (untyped_passes, "TranslateByteCode"),
    (untyped_passes, "FixupArgs"),
    _Canonical,
    (untyped_passes, "GenericRewrites"),
    _SingleAssignment,
    (typed_passes, "NopythonTypeInference"),
    _WithoutPhis,
    (typed_passes, "NoPythonSupportedFeatureValidation"),
    # The lives of variables, and where they end.
    (typed_passes, "IRLegalization"),
    (typed_passes, "NativeLowering"),
    (typed_passes, "NoPythonBackend"),
)

# Objects made before the collector looks at the youngest; how often it looks at those before it looks at older ones. With
# these a process that compiles everything takes a tenth more memory, where no collections at all take twice as much.
_COLLECTIONS = (50_000, 20, 5)


@contextlib.contextmanager
def fewer_collections() -> Iterator[None]:
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

    def __init__(
        self, typingctx: Any, targetctx: Any, library: Any, args: Any, return_type: Any, flags: Any, locals: Any
    ) -> None:
        super().__init__(typingctx, targetctx, library, args, return_type, flags, locals)
        if self.state.library is None:
            self.state.library = self._new_library(flags)

    def _new_library(self, flags: Any) -> Library:
        library = Library(self._generator(), "kernel")
        library.enable_object_caching()
        return library

    def _generator(self) -> Any:
        return self.state.targetctx.codegen()

    def compile_extra(self, function: Any) -> Any:
        """Compile a function, and first whatever it calls."""
        with fewer_collections():
            return super().compile_extra(function)

    def define_pipelines(self) -> list[Any]:
        passes = PassManager("kernel")
        for step in _PASSES:
            made = step if isinstance(step, type) else getattr(*step)
            passes.add_pass(made, made.__name__)
        passes.finalize()
        return [passes]


class _Part(_Kernel):
    """``_Kernel`` for a function without wrappers, which only other kernels can call."""

    def _new_library(self, flags: Any) -> Library:
        if flags.no_cpython_wrapper and flags.no_cfunc_wrapper:
            return LinkedOnly(self._generator(), "part")
        return super()._new_library(flags)


class _ShortLoops(_Kernel):
    """``_Kernel`` for what loops over the coordinates of a mechanism and not over states."""

    def _generator(self) -> Any:
        return LoopsAsTheyAre(super()._generator())


def _known() -> bool:
    """Whether this numba has what the classes above build on."""
    wanted = [step for step in _PASSES if not isinstance(step, type)]
    wanted += [(getattr(typed_passes, "PreLowerStripPhis", None), "_strip_phi_nodes"), (ssa, "reconstruct_ssa")]
    wanted += [(transforms, "canonicalize_cfg"), (ir_utils, "build_definitions")]
    wanted += [(codegen.CPUCodegen, "_module_pass_manager"), (codegen.CPUCodegen, "_function_pass_manager")]
    # The newer ones of LLVM; an older numba has others.
    wanted += [(llvm, "create_pipeline_tuning_options"), (llvm, "create_pass_builder")]
    for name in ("_ensure_finalized", "_get_module_for_linking", "_finalize_dynamic_globals", "_optimize_final_module"):
        wanted.append((codegen.CPUCodeLibrary, name))
    return all(hasattr(home, name) for home, name in wanted)


#: For ``njit(pipeline_class=…)`` and ``cfunc``.
Kernel: Any = _Kernel if _known() else Compiler
#: The same for kernels whose loops are short.
ShortLoops: Any = _ShortLoops if _known() else Compiler
#: The same for functions that only kernels call; they are not to be cached, being nothing by themselves.
Part: Any = _Part if _known() else Compiler
