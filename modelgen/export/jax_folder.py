"""`--to jax`: the runs of a scene as JAX functions with gradients, which load without modelgen."""

from __future__ import annotations

import json
import shlex
from importlib import import_module
from pathlib import Path

import numpy as np

from modelgen.codegen.amalgamation import SOURCE
from modelgen.codegen.compiler import LIBRARIES, SHARED, find_compiler, portable_flags
from modelgen.codegen.core_cache import runtime_object
from modelgen.codegen.emit import Package
from modelgen.codegen.library import Library
from modelgen.errors import ModelgenError, install
from modelgen.export.c_folder import program_files
from modelgen.export.scene_header_and_tables import source
from modelgen.export.shared_library import shared_library
from modelgen.notation import component_names
from modelgen.runtime.c_initialisers import array_text
from modelgen.runtime.core_session import Session
from modelgen.runtime.sensitivity import REASONS
from modelgen.runtime.sensitivity_directions import direction_arrays, directions_of, known_names
from modelgen.runtime.settings import accuracy_of
from modelgen.runtime.trajectory import OUTCOME_OF_CODE

LIBRARY, DIRECTIONS = "libscene.so", "scene_directions.h"
INPUT_REFUSED = -2  # of jax.c, an outcome beside those of the core
STILL = ("orientation",)  # the change of a quaternion depends on the start


def jax_files(library: Library, package: Package) -> dict[str, str | bytes]:
    """The files of the folder by name; the library is compiled for any processor of this kind, over double.

    Raises ModelgenError without JAX, whose header is needed, and for scenes over another real type.
    """
    include, instance = _headers(), library.manifest.instance
    if library.real != "double":
        raise ModelgenError(
            instance["source"], f"real {library.real!r}", "JAX runs over double", "--real double"
        )
    session = Session(library, accuracy_of(instance, None, {}))
    texts = program_files(session, package) | {"jax.c": source("jax.c"), DIRECTIONS: _directions(library)}
    compiler = find_compiler()
    flags = (*portable_flags(compiler, "double"), f"-I{include}")
    core = runtime_object(compiler, portable_flags(compiler, "double"), derivatives=True)
    compiled = shared_library(compiler, flags, texts, ("scene.c", "jax.c", str(core)))
    command = ["cc", *portable_flags(compiler, "double"), *SHARED, "-o", LIBRARY]
    command += ["scene.c", "jax.c", SOURCE, *LIBRARIES]
    told = f'{shlex.join(command)} -I"$(python -c "import jax; print(jax.ffi.include_dir())")"'
    return {
        **texts,
        LIBRARY: compiled,
        "load.py": source("jax_load.py"),
        "functions.json": json.dumps(_facts(session), indent=1, allow_nan=False) + "\n",
        "README.md": source("jax_readme.md").format(name=instance["name"], library=LIBRARY, command=told),
    }


def _headers() -> Path:
    """The folder of XLA's headers."""
    try:
        return Path(import_module("jax.ffi").include_dir())
    except ImportError:
        raise ModelgenError("--to jax", "no package 'jax'", "", install("jax")) from None


def _directions(library: Library) -> str:
    """The direction along which a run is followed forward: of all starts and inputs, weighted at random."""
    parameters = {each["name"] for each in library.manifest.instance.get("parameters", ())}
    names = [
        name
        for name in known_names(library.manifest.instance)
        if name not in parameters and name.rpartition(".")[2] not in STILL
    ]
    directions = directions_of(library.manifest.instance, names)
    rows = direction_arrays(library, directions)
    weights = np.random.default_rng(0).uniform(0.5, 1.0, len(directions))
    arrays = [
        array_text(f"scene_direction_{name}", weights @ rows[name], "static const")
        for name in ("start", "input")
    ]
    return "\n".join(['#include "scene.h"', *arrays, ""])


def _facts(session: Session) -> dict[str, object]:
    instance = session.instance
    n_q, n_u = int(instance["n_q"]), int(instance["n_u"])
    return {
        "name": instance["name"],
        "hash": session.library.record.hash[:16],
        "library": LIBRARY,
        "sensors": component_names(instance["sensors"]["names"]),
        "inputs": [each["name"] for each in instance["inputs"]],
        "input_defaults": [
            0.0 if each["hold"] == "linear" else float(each["default"]) for each in instance["inputs"]
        ],
        # of values; rates of inputs that are linear have none
        "input_ranges": [
            (None, None) if each["hold"] == "linear" else (each["minimum"], each["maximum"])
            for each in instance["inputs"]
        ],
        "bodies": {
            body["name"]: {"q": body["q"], "u": body["u"], "n_q": size, "n_u": min(size, 6)}
            for body in instance["bodies"]
            if (size := {"free": 7, "point": 3}.get(body["motion"], 0))
        },
        "q": session.x[:n_q].tolist(),
        "u": session.x[n_q : n_q + n_u].tolist(),
        "outcomes": {str(code): outcome.value for code, outcome in OUTCOME_OF_CODE.items()}
        | {str(INPUT_REFUSED): "an input is not finite or beyond its range; keep it within"},
        "reasons": {str(code): reason for code, reason in enumerate(REASONS)},
    }
