"""`--to browser`: one page that runs the scene: the core and the scene as WebAssembly, and the viewer."""

from __future__ import annotations

import importlib.util
import sys
from base64 import b64encode
from collections.abc import Collection, Mapping, Sequence
from typing import Any

import numpy as np

from modelgen.assembly import require
from modelgen.codegen.built_files import cache_folder
from modelgen.codegen.compiler import LEVEL, Compiler, compiler_version, run_compiler
from modelgen.codegen.core_cache import runtime_object
from modelgen.codegen.emit import Package
from modelgen.codegen.library import Library
from modelgen.errors import ModelgenError, install
from modelgen.export.c_folder import program_files
from modelgen.export.numbers_by_parameters import Numbers, Slider, arrays_of, numbers_of, sliders_of
from modelgen.export.scene_header_and_tables import KERNELS, field_of, source
from modelgen.file_writing import scratch_folder
from modelgen.report.run_record import record_of
from modelgen.runtime.arguments import input_range
from modelgen.runtime.c_initialisers import array_text, values_text
from modelgen.runtime.core_session import CONTINUE, FULL, Session
from modelgen.runtime.recording import INTEGERS, Recording
from modelgen.runtime.settings import accuracy_of
from modelgen.runtime.simulate import simulate
from modelgen.runtime.tables.ctypes_structures import RECORD_ARRAYS, Array, address
from modelgen.runtime.tables.planar_contacts import SUPPORT_POINTS
from modelgen.runtime.trajectory import EVENT_KINDS, LOAD_SWITCH, OUTCOME_OF_CODE
from modelgen.scene.scene_types import Scene
from modelgen.view.packing import packed_doubles
from modelgen.view.page import TOLERANCE, running_page_text
from modelgen.view.self_running_page_data import Shapes, self_running_page_data
from modelgen.view.slider_range import slider_range

MACHINE = ("-target", "wasm32-wasi")
FLAGS = (f"-{LEVEL}", "-std=c99", "-fno-math-errno", "-ffp-contract=off")
LINK = ("-mexec-model=reactor", "-Wl,--strip-all")
MODULE, LOG = "page.wasm", "page.log"
MOST, LEAST = 1500, 200  # samples of a page


def wasm_compiler() -> Compiler:
    """Zig, which compiles for WebAssembly; ModelgenError where it is not installed."""
    if importlib.util.find_spec("ziglang") is None:
        raise ModelgenError("--to browser", "no package 'ziglang'", "", install("compiler"))
    command = (sys.executable, "-m", "ziglang", "cc", *MACHINE)
    return Compiler(command, compiler_version(command))


def browser_page(scene: Scene, library: Library, package: Package, fixed: Collection[str]) -> str:
    """The text of the page.

    Args:
        scene: as written.
        library: what `build` returned, with values of the parameters that are fixed.
        package: what `emit` returned.
        fixed: parameters that get no slider.

    Raises ModelgenError where zig is missing, the real type is not double, or a parameter cannot be set in a
    page.
    """
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
    model = require(record.scene_again("export"))
    page = self_running_page_data(record, model, library, TOLERANCE)
    ranges = {
        each["name"]: (float(each["value"]), *slider_range(*input_range(each), each["value"]))
        for each in instance.get("parameters", ())
        if each["name"] not in fixed
    }
    sliders = sliders_of(ranges)
    shapes = Shapes(record, page)
    numbers = numbers_of(library, accuracy, sliders, shapes.look) if sliders else None
    texts["numbers.h"] = _numbers_text(session, numbers)
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
        "contact_names": session.contact_labels,
        "load_switch": LOAD_SWITCH,
        "switching_loads": session.switching_loads,
        "face_names": [str(patch["name"]).rpartition(":")[0] for patch in instance["patches"]],
        "feature_pairs": len(session.feature_pair_names),
        "support_points": SUPPORT_POINTS,
        "parameters": [_positions(each, instance["parameters"]) for each in sliders],
        "meshes": shapes.meshes,
        "numbers": None if numbers is None else _packed(numbers),
        "inputs": [_slider(each, each["default"]) for each in instance["inputs"]],
    }
    return running_page_text(page, run)


def _positions(slider: Slider, parameters: Sequence[Mapping[str, Any]]) -> dict[str, Any]:
    unit = next(each["unit"] for each in parameters if each["name"] == slider.name)
    values = slider.values
    return {"name": slider.name, "unit": unit or "", "own": values.index(slider.own), "values": list(values)}


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


def _numbers_text(session: Session, numbers: Numbers | None) -> str:
    """The arrays into which numbers are written, and the system that points to them."""
    if numbers is None:
        return "#define page_system scene_system\nstatic void *const number_place[] = {0};\n"
    tables, of_run = arrays_of(session)
    names = {address(array): f"table_{k}" for k, array in enumerate(tables)}
    copies, places = [], []
    for k in sorted(set(numbers.entries[:, 0].tolist())):
        if k < len(tables):
            names[address(tables[k])] = f"own_{k}"
            copies.append(
                array_text(f"own_{k}", tables[k], "static  ")
            )  # with its numbers, though all are zero
            places.append(f"own_{k}")
        else:
            places.append(f"scene.{field_of(of_run[k - len(tables)])}")
    system = values_text(session.system, names, KERNELS)
    return "\n".join(
        [
            *copies,
            f"static const mg_system page_system = {system};",
            f"static void *const number_place[] = {{{', '.join([*places, '0'])}}};\n",
        ]
    )


def _packed(numbers: Numbers) -> dict[str, Any]:
    """The numbers for the page."""
    arrays = sorted(set(numbers.entries[:, 0].tolist()))
    return {
        "place": [arrays.index(k) for k in numbers.entries[:, 0].tolist()],
        "offset": numbers.entries[:, 1].tolist(),
        "table": packed_doubles(numbers.table),
    }


def _module(compiler: Compiler, texts: Mapping[str, str]) -> bytes:
    core = runtime_object(compiler, FLAGS)
    with scratch_folder() as folder:
        for file, text in texts.items():
            (folder / file).write_text(text, encoding="utf-8")
        units: Sequence[str] = ("page.c", str(core))
        command = [*compiler.command, *FLAGS, *LINK, "-o", MODULE, *units]
        run_compiler(command, folder, cache_folder() / LOG)
        return (folder / MODULE).read_bytes()
