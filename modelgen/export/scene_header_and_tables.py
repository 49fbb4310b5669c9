"""A scene as two C files: `scene.h` with its sizes, names and functions, `scene.c` with its tables."""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence
from functools import cache
from importlib import resources

from modelgen.notation import component_names
from modelgen.runtime.c_initialisers import RunArray, SceneTables, number_text, scene_tables
from modelgen.runtime.core_session import Session
from modelgen.runtime.tables.scratch_memory import EXPORTED, fit_scratch

KERNELS = "&mg_table"  # of model.c

HEAD = """/* {name}: one scene, its tables and its runs.

   A scene_instance is one run; there may be several. scene_init puts it at the start of the scene,
   scene_begin settles that start, scene_advance goes on. Outcomes are those of modelgen.h: MG_DONE, or what
   ended the run. What the core offers beyond these functions is called with &scene_system, &scene_settings
   and &instance.run. */
#ifndef SCENE_H
#define SCENE_H

#include "modelgen.h"

#define SCENE_NAME "{name}"
#define SCENE_UNTIL ((mg_real){until!r}) /* end of the run of the scene file, s */
#define SCENE_N_BODY {n_body}
#define SCENE_N_CONTACT {n_contact} /* with shapes, and limits of joints */
#define SCENE_N_STATE {n_state} /* numbers of run.x */
#define SCENE_N_INPUT {n_input}
#define SCENE_N_SENSOR {n_sensor} /* components of all sensors */
#define SCENE_WORK {work}L /* mg_work_size */
#define SCENE_IWORK {iwork}L /* mg_iwork_size */
#define SCENE_SAVE_SIZE {save}L /* bytes of a saved state, at most */
"""
SOURCE = """/* {name}: tables, settings and functions of scene.h. */
#include <string.h>

#include "scene.h"

#define MG_HASH "{hash}" /* of the library of the scene: its saved states are those of this program */
#include "model.c"

{constants}

const mg_system scene_system = {system};
const mg_settings scene_settings = {settings};

{names}

void scene_init(scene_instance *scene) {{
  memset(scene, 0, sizeof *scene);
{init}
}}

"""


@cache
def source(name: str) -> str:
    """The text of a hand-written file that exports are made with."""
    return (resources.files("modelgen.export") / "sources" / name).read_text(encoding="utf-8")


def scene_files(session: Session) -> dict[str, str]:
    """The texts of `scene.h` and `scene.c`, of a session that has not begun."""
    system = type(session.system).from_buffer_copy(session.system)
    sizes = fit_scratch(session.library.cdll, system, session.tables.dtype, EXPORTED)
    tables = scene_tables(session, KERNELS, system)
    return {"scene.h": _header(session, tables, sizes), "scene.c": _source(session, tables)}


def _header(session: Session, tables: SceneTables, sizes: tuple[int, int]) -> str:
    instance, shared = session.instance, session.shared
    head = HEAD.format(
        name=instance["name"],
        until=float(instance["run"]["until"]),
        n_body=session.n_body,
        n_contact=session.n_shown,
        n_state=session.n_x,
        n_input=len(instance["inputs"]),
        n_sensor=shared.n_sensor,
        work=sizes[0] + 1,
        iwork=sizes[1] + 1,
        save=shared.checkpoint_size,
    )
    for group, names in _named(session).items():
        head += _numbers(group, names)
    arrays = [f"  {each.type} {field_of(each)}[{max(each.start.size, 1)}];" for each in tables.arrays]
    return head + "\n" + source("scene_interface.h").replace("@ARRAYS@", "\n".join(arrays))


def _named(session: Session) -> dict[str, Sequence[str]]:
    instance = session.instance
    return {
        "body": [body["name"] for body in instance["bodies"]],
        "contact": session.contact_labels,
        "input": [each["name"] for each in instance["inputs"]],
        "sensor": component_names(instance["sensors"]["names"]),
    }


def _numbers(group: str, names: Sequence[str]) -> str:
    """An enumeration of names that C does not have; two that would be alike get their numbers."""
    words = [re.sub(r"\W", "_", name).upper() for name in names]
    told = [f"{word}_{k}" if words.count(word) > 1 else word for k, word in enumerate(words)]
    if group == "contact" or not told:
        return ""
    entries = ", ".join(f"SCENE_{group.upper()}_{word} = {k}" for k, word in enumerate(told))
    return f"\nenum {{ {entries} }};\n"


def _source(session: Session, tables: SceneTables) -> str:
    text = SOURCE.format(
        name=session.instance["name"],
        hash=session.library.record.hash,
        constants=tables.constants,
        system=tables.system,
        settings=tables.settings,
        names=_name_arrays(session),
        init="\n".join(_init(session, tables.arrays)),
    )
    return text + source("scene_functions.c")


def _name_arrays(session: Session) -> str:
    instance = session.instance
    lines = []
    for group, names in _named(session).items():
        quoted = ", ".join([*(f'"{name}"' for name in names), "0"])
        lines.append(f"const char *const scene_{group}_names[] = {{{quoted}}};")
    moves = [int(body["motion"] != "fixed") for body in instance["bodies"]]
    defaults = [float(each["default"]).hex() for each in instance["inputs"]]
    linear = [int(each["hold"] == "linear") for each in instance["inputs"]]
    lines.append(f"const int scene_body_moves[] = {{{_list(moves)}}};")
    lines.append(f"const mg_real scene_input_defaults[] = {{{_list(defaults)}}};")
    lines.append(f"const int scene_input_is_linear[] = {{{_list(linear)}}};")
    return "\n".join(lines)


def _list(values: Iterable[object]) -> str:
    return ", ".join([*map(str, values), "0"])


def _init(session: Session, arrays: Sequence[RunArray]) -> list[str]:
    """The statements that set the pointers and the entries that are not zero."""
    lines = ["  scene->system = &scene_system;", f"  scene->events.capacity = {session.events.capacity};"]
    lines += [f"  scene->{each.owner}.{each.field} = scene->{field_of(each)};" for each in arrays]
    for each in arrays:
        if each.start.any():
            name, values = field_of(each), ", ".join(map(number_text, each.start.ravel()))
            lines.append(f"  static const {each.type} start_of_{name}[] = {{{values}}};")
            lines.append(f"  memcpy(scene->{name}, start_of_{name}, sizeof start_of_{name});")
    return lines


def field_of(array: RunArray) -> str:
    """The name of an array of a run in a scene_instance."""
    return array.field if array.owner == "run" else f"event_{array.field}"
