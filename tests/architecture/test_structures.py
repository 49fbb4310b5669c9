"""The structures that Python fills are those of the public headers, field by field."""

from __future__ import annotations

import ctypes
import re
from typing import Any

import numpy as np
import pytest

from modelgen.runtime import area_friction, region_overlap
from modelgen.runtime.tables.ctypes_structures import Tables
from tests.core.compiling import CORE

HEADERS = ("modelgen.h", "region/region_queries.h")
SCALARS = {
    "int": ctypes.c_int,
    "long": ctypes.c_long,
    "mg_real": ctypes.c_double,
    "mg_digest": ctypes.c_ulonglong,
}
TABLES = Tables(np.dtype(float))
SCALARS["mg_run_report"] = TABLES.Report
OUTLINE, REGIONS = region_overlap._structures(np.dtype(float))
STRUCTURES = {
    "mg_system": TABLES.System,
    "mg_settings": TABLES.Settings,
    "mg_run_report": TABLES.Report,
    "mg_run": TABLES.Run,
    "mg_record": TABLES.Record,
    "mg_events": TABLES.Events,
    "mg_closest_queries": TABLES.Queries,
    "mg_minima_queries": TABLES.MinimaQueries,
    "mg_outline": OUTLINE,
    "mg_region_query": REGIONS,
    "mg_patch_friction_query": area_friction._structure(),
}


def declared(name: str) -> list[tuple[str, Any]]:
    """Names and ctypes of the fields of a structure of the public headers, in order."""
    headers = "".join((CORE / name).read_text() for name in HEADERS)
    text = re.sub(r"/\*.*?\*/", "", headers, flags=re.DOTALL)
    text = re.sub(r"struct (\w+) (\{[^{}]*\});", r"typedef struct \2 \1;", text)
    text = re.sub(r"void \(\*(\w+)\)\([^()]*\);", r"void *\1;", text)  # a pointer to a function
    (body,) = re.findall(r"typedef struct \{([^{}]*)\} " + name + ";", text)
    fields: list[tuple[str, Any]] = []
    for statement in filter(None, map(str.strip, body.split(";"))):
        kind, names = re.fullmatch(r"(?:const )?(\w+)\s+(.*)", statement, re.DOTALL).groups()
        for each in (part.strip() for part in names.split(",")):
            field, size = re.fullmatch(r"\**(\w+)(?:\[(\d+)\])?", each).groups()
            scalar = ctypes.c_void_p if "*" in each else SCALARS[kind]
            fields.append((field, scalar * int(size) if size else scalar))
    return fields


@pytest.mark.parametrize("name", STRUCTURES)
def test_python_fills_the_fields_of_the_header_in_its_order(name: str) -> None:
    assert [field for field, _ in STRUCTURES[name]._fields_] == [field for field, _ in declared(name)]


@pytest.mark.parametrize("name", STRUCTURES)
def test_fields_have_the_offsets_and_sizes_of_the_header(name: str) -> None:
    twin = type(name, (ctypes.Structure,), {"_fields_": declared(name)})
    mine = STRUCTURES[name]
    offsets = [(getattr(mine, field).offset, getattr(mine, field).size) for field, _ in mine._fields_]
    assert offsets == [(getattr(twin, field).offset, getattr(twin, field).size) for field, _ in twin._fields_]
    assert ctypes.sizeof(mine) == ctypes.sizeof(twin)
