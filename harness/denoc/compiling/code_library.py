"""What becomes of a kernel's code in LLVM: how it is linked, optimized, and whether it is translated.

Extensions of numba's ``CodeLibrary``; ``pipeline`` says which kernel has which.
"""

from __future__ import annotations

from typing import Any

import llvmlite.binding as llvm
from numba.core import codegen


class _Around:
    """A code generator that does some things in another way."""

    def __init__(self, generator: Any) -> None:
        self._generator = generator

    def __getattr__(self, name: str) -> Any:
        return getattr(self._generator, name)


class _Absent(_Around):
    """The code generator of a library that has no code: nothing in it can be set."""

    def set_env(self, name: str, environment: Any) -> None:
        """Nothing: the environment is for calls from Python and for exceptions."""


class LoopsAsTheyAre(_Around):
    """The code generator with LLVM's unrolling and vectorising of loops left out."""

    def _module_pass_manager(self, cost: str = "", **options: Any) -> Any:
        if cost == "cheap":
            return self._generator._module_pass_manager(cost=cost, **options)
        tuning = llvm.create_pipeline_tuning_options(speed_level=3)
        tuning.loop_unrolling = tuning.loop_vectorization = False
        builder = llvm.create_pass_builder(self._generator._tm, tuning)
        return builder.getModulePassManager(), builder


class Library(codegen.JITCodeLibrary):
    """Code whose functions are made simple one by one, and optimized in full only where all is linked."""

    def _optimize_functions(self, module: Any) -> None:
        module.data_layout = self._codegen._data_layout
        passes, builder = self._codegen._function_pass_manager(opt=1)
        for function in module.functions:
            if not function.is_declaration:
                passes.run(function, builder)


class LinkedOnly(Library):
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
