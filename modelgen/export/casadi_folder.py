"""`--to casadi`: the kernels of a scene as CasADi functions that load where modelgen is not installed."""

from __future__ import annotations

import json
import shlex

import casadi as ca

from modelgen.codegen.amalgamation import HEADER, elementary_text, header_text
from modelgen.codegen.compiler import LIBRARIES, SHARED, find_compiler, portable_flags
from modelgen.codegen.emit import Package
from modelgen.derivation import Derivation
from modelgen.errors import ModelgenError
from modelgen.export.scene_header_and_tables import source
from modelgen.export.shared_library import shared_library

LIBRARY, COMPOSED = "libkernels.so", "rhs.casadi"
ELEMENTARY = "elementary.c"
UNITS = ("model.c", ELEMENTARY)


def casadi_files(derivation: Derivation, package: Package) -> dict[str, str | bytes]:
    """The files of the folder by name. Kernels are compiled for any processor of this kind, over double."""
    manifest = package.manifest
    texts = {name: text for name, text in package.files.items() if name.endswith(".c")}
    texts |= {HEADER: header_text(), ELEMENTARY: elementary_text()}
    composed, why = _composed(derivation)
    facts = {
        "scene": manifest.instance["name"],
        "library": LIBRARY,
        "kernels": manifest.functions,
        "composed": {composed.name(): COMPOSED} if composed is not None else {},
        "kinds": manifest.kinds,
        "instance": {**manifest.instance, "feature_pairs": [*manifest.instance["feature_pairs"]]},
    }
    library, command = _compiled(texts)
    told = (
        f"| `{COMPOSED}` | {why} |"
        if composed is not None
        else f"\nIt has no composed right-hand side: {why}."
    )
    readme = source("casadi_readme.md").format(
        name=manifest.instance["name"], library=LIBRARY, command=command, composed=told
    )
    files: dict[str, str | bytes] = {**texts, LIBRARY: library, "load.py": source("load.py")}
    files |= {"functions.json": json.dumps(facts, indent=1, allow_nan=False) + "\n", "README.md": readme}
    return files if composed is None else {**files, COMPOSED: composed.serialize()}


def _composed(derivation: Derivation) -> tuple[ca.Function | None, str]:
    """The whole right-hand side, and what it is; None, and why there is none."""
    try:
        return derivation.rhs(), "the whole right-hand side, all contacts closed, with derivatives"
    except ModelgenError as refused:
        return None, refused.found


def _compiled(texts: dict[str, str]) -> tuple[bytes, str]:
    """The shared library of the kernels, and a command that makes it."""
    compiler = find_compiler()
    flags = portable_flags(compiler, "double")
    command = ["cc", *flags, *SHARED, "-o", LIBRARY, *UNITS, *LIBRARIES]
    return shared_library(compiler, flags, texts, UNITS), shlex.join(command)
