"""`--to browser`: one page that runs the scene in a browser: the core and the scene as WebAssembly, and the viewer."""

from __future__ import annotations

import importlib.util
import sys
from base64 import b64encode
from collections.abc import Mapping, Sequence
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np

from modelgen.assembly import require
from modelgen.codegen.compiler import LEVEL, Compiler, compiler_version, run_compiler
from modelgen.codegen.core_cache import runtime_object
from modelgen.codegen.emit import Package
from modelgen.codegen.library import Library
from modelgen.errors import ModelgenError
from modelgen.export.c_folder import program_files
from modelgen.export.scene_text import source
from modelgen.report.run_record import record_of
from modelgen.runtime.arguments import input_range
from modelgen.runtime.c_program import array_text, values_text
from modelgen.runtime.recording import INTEGERS, Recording
from modelgen.runtime.session import CONTINUE, FULL, Session
from modelgen.runtime.settings import accuracy_of
from modelgen.runtime.simulate import simulate
from modelgen.runtime.tables.ctypes_structures import RECORD_ARRAYS, Array
from modelgen.runtime.trajectory import EVENT_KINDS, OUTCOME_OF_CODE
from modelgen.scene.scene_types import Scene
from modelgen.view.page import TOLERANCE, running_page_text
from modelgen.view.run_to_come import page_of_run_to_come
from modelgen.view.slider_range import slider_range

MACHINE = ("-target", "wasm32-wasi")
FLAGS = (f"-{LEVEL}", "-std=c99", "-fno-math-errno", "-ffp-contract=off")
LINK = ("-mexec-model=reactor", "-Wl,--strip-all")
MODULE, LOG = "page.wasm", "page.log"
MOST, LEAST = 1500, 200  # samples of a page


def wasm_compiler() -> Compiler:
    """Zig, which compiles for WebAssembly; ModelgenError where it is not installed."""
    if importlib.util.find_spec("ziglang") is None:
        remedy = 'run: pip install "modelgen[compiler]"'
        raise ModelgenError("--to browser", "no package 'ziglang'", "", remedy)
    command = (sys.executable, "-m", "ziglang", "cc", *MACHINE)
    return Compiler(command, compiler_version(command))


def browser_page(scene: Scene, library: Library, package: Package) -> str:
    """The text of the page. Raises ModelgenError where zig is missing, or the real type is not double."""
    if library.real != "double":
        raise ModelgenError("--to browser", f"the real type {library.real}", "double", "leave out `real`")
    compiler = wasm_compiler()
    accuracy = accuracy_of(library.manifest.instance, None, {})
    session = Session(library, accuracy)
    record = record_of(simulate(library, accuracy=accuracy), library, scene)
    rows = min(max(len(record.columns["t"]), LEAST), MOST)
    recording = Recording(session, np.zeros(rows))
    texts = program_files(session, package)
    texts |= {"record.h": _record_text(recording), "page.c": source("page.c")}
    instance = session.instance
    run = {
        "module": b64encode(_module(compiler, texts)).decode(),
        "rows": rows,
        "until": float(instance["run"]["until"]),
        "accuracy": record.summary["accuracy"],
        "columns": {name: _width(recording.arrays[name]) for name in RECORD_ARRAYS},
        "integers": list(INTEGERS),
        "goes_on": CONTINUE,
        "list_full": FULL,
        "outcomes": {code: outcome.value for code, outcome in OUTCOME_OF_CODE.items()},
        "event_kinds": list(EVENT_KINDS),
        "contact_names": list(session.contacts),
        "inputs": [_slider(each, each["default"]) for each in instance["inputs"]],
    }
    model = require(record.scene_again("export"))
    return running_page_text(page_of_run_to_come(record, model, library, TOLERANCE), run)


def _width(array: Array) -> int:
    """Entries of one row."""
    return int(np.prod(array.shape[1:]))


def _slider(kind: Mapping[str, Any], value: float) -> dict[str, Any]:
    low, high = slider_range(*input_range(kind), value)
    linear = kind.get("hold") == "linear"
    return {
        "name": kind["name"],
        "unit": kind["unit"] or "",
        "value": value,
        "low": low,
        "high": high,
        "linear": linear,
    }


def _record_text(recording: Recording) -> str:
    names = {at: f"column_{k}" for k, at in enumerate(recording.placed)}
    arrays = [array_text(names[at], array) for at, array in recording.placed.items()]
    places = ", ".join(names[getattr(recording.record, name)] for name in RECORD_ARRAYS)
    return "\n".join(
        [
            *arrays,
            f"static mg_record record = {values_text(recording.record, names)};",
            f"static const void *const column_place[] = {{{places}}};\n",
        ]
    )


def _module(compiler: Compiler, texts: Mapping[str, str]) -> bytes:
    core = runtime_object(compiler, FLAGS)
    with TemporaryDirectory(prefix="modelgen-") as name:
        folder = Path(name)
        for file, text in texts.items():
            (folder / file).write_text(text, encoding="utf-8")
        units: Sequence[str] = ("scene.c", "page.c", str(core))
        run_compiler([*compiler.command, *FLAGS, *LINK, "-o", MODULE, *units], folder, folder / LOG)
        return (folder / MODULE).read_bytes()
