"""A CasADi function as a controller in C: compiled once, called by the core at sampled instants."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path

import casadi as ca

from modelgen.codegen.built_files import cache_folder, made_once
from modelgen.codegen.compiler import LIBRARIES, SHARED, find_compiler, run_compiler
from modelgen.codegen.core_cache import content_hash
from modelgen.codegen.sensor_expressions_function import expressions_function
from modelgen.errors import SimulationError
from modelgen.name_suggestions import nearest

SOURCE, ENTRY = "controller.c", "mg_controller_call"
Slots = Sequence[tuple[str, int]]  # names and sizes of what stands in a row

WRAPPER = """
__attribute__((visibility("default"))) void {entry}(void *data, casadi_real t, const casadi_real *sensors,
                                                    casadi_real *command) {{
  const casadi_real *arg[{n_arg}] = {{{arguments}}};
  casadi_real *res[{n_res}] = {{{results}}};
  casadi_int iw[{n_iw}];
  casadi_real w[{n_w}];
  (void)data, (void)t, (void)sensors, (void)command;
  {name}(arg, res, iw, w, 0);
}}
"""


def compiled_controller(
    function: ca.Function | Mapping[str, str], sensors: Slots, inputs: Sequence[str], real: str
) -> Path:
    """The shared library of a controller, whose function ENTRY has the type mg_control.

    Args:
        function: its inputs are `t` and sensors, its outputs inputs of the scene, by name; or expressions of
            `t` and components of sensors by input.
        sensors: names and sizes, in the order of the scene.
        inputs: names, in the order of the scene.
        real: real type of the scene's library.

    Raises:
        SimulationError: a name or size of the function is none of the scene.
        LibraryError: no compiler, or the compiler fails.
    """
    if isinstance(function, Mapping):
        function = expressions_function(function, sensors, "controller")
    text = _text(function, sensors, [(name, 1) for name in inputs], real)
    compiler = find_compiler()
    flags = (*compiler.flags(real), "-Wno-unused-parameter")
    path = cache_folder() / f"controller-{content_hash((text,), compiler, flags)[:16]}.so"

    def compile_text(scratch: Path) -> None:
        words = [*compiler.command, *flags, *SHARED, "-o", path.name, SOURCE, *LIBRARIES]
        run_compiler(words, scratch, path.with_suffix(".log"))

    return made_once(path, {SOURCE: text}, compile_text)


def _text(function: ca.Function, sensors: Slots, inputs: Slots, real: str) -> str:
    """C text of the function and of the call that takes its arguments from the rows of the core."""
    arguments = [
        _place(function.name_in(k), int(function.numel_in(k)), sensors, "sensors")
        for k in range(function.n_in())
    ]
    results = [
        _place(function.name_out(k), int(function.numel_out(k)), inputs, "command")
        for k in range(function.n_out())
    ]
    generator = ca.CodeGenerator(SOURCE, {"casadi_real": real, "with_header": False, "main": False})
    generator.add(function)
    wrapper = WRAPPER.format(
        entry=ENTRY, name=function.name(), n_arg=max(function.sz_arg(), 1), n_res=max(function.sz_res(), 1),
        n_iw=max(function.sz_iw(), 1), n_w=max(function.sz_w(), 1),
        arguments=", ".join(arguments) or "0", results=", ".join(results) or "0",
    )  # fmt: skip
    return str(generator.dump()) + wrapper


def _place(name: str, size: int, slots: Slots, row: str) -> str:
    """Where a named argument stands; raises SimulationError."""
    if name == "t" and row == "sensors" and size == 1:
        return "&t"
    start = 0
    for known, length in slots:
        if known == name:
            if size != length:
                raise SimulationError(f"controller: {name}", f"{size} numbers", f"it has {length}", "")
            return f"{row} + {start}"
        start += length
    what = "sensor, nor t" if row == "sensors" else "input of the scene"
    names = [known for known, _ in slots]
    raise SimulationError(
        "controller", f"{name!r}, which is no {what}", "known are " + ", ".join(names), nearest(name, names)
    )
