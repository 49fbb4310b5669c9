"""A run as a C program of its own: its tables and its start, without Python."""

from __future__ import annotations

import ctypes
from collections.abc import Mapping
from typing import Any

import numpy as np

from modelgen.codegen.library import Library
from modelgen.runtime.accuracy import Accuracy
from modelgen.runtime.session import CONTINUE, FULL, Session
from modelgen.runtime.tables import Array

CHUNK = 20_000  # steps between two drains of the events
ENTRY = "mg_advance"  # the function that does the work

MAIN = """
static mg_real work[{work}];
static int iwork[{iwork}];

int main(void) {{
  mg_record record = {{0}};
  int code = mg_begin(&the_system, &the_settings, &the_run, &the_events, work, iwork);
  do {{
    the_events.count = 0;
    code = {entry}(&the_system, &the_settings, &the_run, {until}, {chunk}, &record, &the_events, work, iwork);
  }} while (code == {again} || code == {full});
  return code;
}}
"""


def driver_text(library: Library, accuracy: Accuracy, until: float) -> str:
    """C99 text that, linked with the library's `model.c`, runs the scene to `until`, s."""
    session = Session(library, accuracy)
    arrays = session.arrays()
    numbers = {at: number for number, at in enumerate(arrays)}
    parts = ['#include "modelgen.h"']
    parts += [_array(f"a{numbers[at]}", array) for at, array in arrays.items()]
    for name in ("system", "settings", "run", "events"):
        parts.append(_record(name, getattr(session, name), numbers))
    sizes = {"work": len(session.work) + 1, "iwork": len(session.iwork) + 1}
    loop = {"entry": ENTRY, "until": float(until).hex(), "chunk": CHUNK, "again": CONTINUE, "full": FULL}
    return "\n".join([*parts, MAIN.format(**sizes, **loop)])


def _array(name: str, array: Array) -> str:
    kind = "int" if array.dtype == np.intc else "mg_real"
    return f"static {kind} {name}[] = {{{', '.join(map(_number, array.ravel()))}}};"


def _number(value: Any) -> str:
    if isinstance(value, np.integer):
        return str(int(value))
    exact = float(value)
    return "MG_MAX" if exact == float(np.finfo(type(value)).max) else exact.hex()


def _record(name: str, record: ctypes.Structure, numbers: Mapping[int, int]) -> str:
    """A structure with its values, in the order of the header."""
    values = []
    for field, kind in record._fields_:  # type: ignore[misc]
        value = getattr(record, field)
        if kind is ctypes.c_void_p:
            values.append(f"a{numbers[value]}" if value else "0")
        elif isinstance(value, ctypes.Array):
            values.append("{" + ", ".join(float(each).hex() for each in value) + "}")
        else:
            values.append(float(value).hex() if isinstance(value, float) else str(value))
    return f"static mg_{name} the_{name} = {{{', '.join(values)}}};"
