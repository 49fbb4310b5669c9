"""A library with room for more near pairs of equal bodies."""

from __future__ import annotations

from dataclasses import replace

from modelgen.codegen.library import Library


def with_more_slots(library: Library, pool: int) -> Library:
    """The library with twice as many slots in a pool."""
    instance = library.manifest.instance
    pools = [*instance["pools"]]
    pools[pool] = {**pools[pool], "slots": 2 * pools[pool]["slots"]}
    manifest = replace(library.manifest, instance={**instance, "pools": pools})
    return Library(manifest, library.record, library.path.parent)
