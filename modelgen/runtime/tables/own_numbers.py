"""An mg_system with numbers of its own, for runs that differ from others of the library in numbers alone."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from modelgen.codegen.library import Library
from modelgen.runtime.tables.ctypes_structures import SYSTEM_REALS, Array, address
from modelgen.runtime.tables.library_tables import library_tables


@dataclass(frozen=True, slots=True)
class OwnNumbers:
    """Index tables are those of the library; `arrays` may be written to between two calls of the core."""

    system: Any  # mg_system
    arrays: Mapping[str, Array]  # by the name of a field of mg_system with real numbers (modelgen.h)


def own_numbers(library: Library) -> OwnNumbers:
    """A copy of the numbers of a library; `system` also has its own gravity and scales."""
    shared = library_tables(library)
    by_address = {address(array): array for array in shared.arrays}
    system = type(shared.system).from_buffer_copy(shared.system)
    arrays = {name: by_address[getattr(system, name)].copy() for name in SYSTEM_REALS}
    for name, array in arrays.items():
        setattr(system, name, address(array))
    return OwnNumbers(system, arrays)
