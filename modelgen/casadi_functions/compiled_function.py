"""A CasADi function as a compiled file that any process with CasADi loads, with its derivatives."""

from __future__ import annotations

from pathlib import Path

import casadi as ca

from modelgen.codegen.compiler import LEVEL, LIBRARIES, SHARED, find_compiler, run_compiler
from modelgen.errors import ModelgenError
from modelgen.file_writing import scratch_folder, write_file

EXPORT = "-DGCC_HASCLASSVISIBILITY"  # lets CasADi's text mark the functions that others may call


def save_external(
    function: ca.Function, folder: str | Path, *, second: bool = False, level: str = LEVEL
) -> Path:
    """Write a function as C and compile it: `casadi.external(function.name(), path)` is the same function.

    The file has the function and its derivatives forward and reverse, from which CasADi makes Jacobians. It
    needs neither Python nor modelgen: C programs call it by CasADi's own interface for generated code.

    Args:
        function: of `as_casadi`, or any other that CasADi can write as C.
        folder: that exists; it receives NAME.c and NAME.so.
        second: also write the forward derivative of the reverse one, products of second derivatives with
            vectors, which solvers with an exact Hessian need. It takes several times as long to compile.
        level: of optimisation.

    Returns:
        The path of NAME.so.

    Raises:
        ModelgenError: the folder does not exist, no compiler is found, or it fails.
    """
    place = Path(folder)
    if not place.is_dir():
        raise ModelgenError("save_external", f"{str(folder)!r} is no folder", "a folder that exists")
    name = function.name()
    compiler = find_compiler()
    generator = ca.CodeGenerator(f"{name}.c", {"with_header": False, "main": False})
    reverse = function.reverse(1)
    for each in (function, function.forward(1), reverse, *([reverse.forward(1)] if second else [])):
        generator.add(each)
    source, target = place / f"{name}.c", place / f"{name}.so"
    write_file(source, generator.dump())
    flags = (*compiler.flags("double", level), "-Wno-unused-parameter", EXPORT)
    with scratch_folder() as scratch:
        made = scratch / target.name
        words = [*compiler.command, *flags, *SHARED, "-o", str(made), source.name, *LIBRARIES]
        run_compiler(words, place.absolute(), place.absolute() / f"{name}.log")
        write_file(target, made.read_bytes())
    return target
