"""What all runs of a library share: its mg_system, the names in results, the sizes of the arrays of a run.

Made at the first run of a library and kept as long as the library: the core reads an mg_system and never
writes it, so that runs, also of several threads, may share it.
"""

from __future__ import annotations

import ctypes
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any
from weakref import WeakKeyDictionary

import numpy as np

from modelgen.codegen.library import Library, kernel_table
from modelgen.notation import SETTING_SIZE, component_names
from modelgen.runtime.tables.array_block import ArrayBlock
from modelgen.runtime.tables.ctypes_structures import Array, Tables, fill_system, tables_of
from modelgen.runtime.tables.features import feature_pair_names
from modelgen.runtime.tables.pair_slots import ContactNames, PairSlots
from modelgen.runtime.tables.planar_contacts import shares
from modelgen.runtime.tables.scratch_memory import fit_scratch, memory_of_run

EVENT_PREFIX = "event_"
_MADE: WeakKeyDictionary[Library, LibraryTables] = WeakKeyDictionary()


@dataclass(frozen=True, slots=True)
class LibraryTables:
    """Shared by all runs of a library; arrays are read-only."""

    tables: Tables
    system: Any  # mg_system
    arrays: tuple[Array, ...]  # to which it points
    start: Array  # (n_x,) the state at t = 0, with eta and work zero
    slots: PairSlots
    contact_names: tuple[str, ...] | ContactNames  # contacts with shapes, then the limits of joints
    feature_pair_names: tuple[str, ...]
    body_names: tuple[str, ...]
    patch_names: tuple[str, ...]
    shares: tuple[tuple[int, str], ...]  # number of the patch, and pair, of each share
    joint_names: tuple[str, ...]
    coordinate_names: tuple[str, ...]  # "elbow.angle", of all joints
    sensor_names: tuple[str, ...]  # of their components
    kind_names: tuple[str, ...]
    instructions: Mapping[str, int]  # of each generated function
    n_patch_slot: int
    n_contact: int  # with limits and support points
    n_sensor: int  # components of all sensors
    n_event: int  # events that fit into the list of a run
    reals: ArrayBlock  # of the arrays of an mg_run and of its mg_events, which have EVENT_PREFIX
    integers: ArrayBlock
    work_size: int
    iwork_size: int
    checkpoint_size: int  # bytes


def library_tables(library: Library) -> LibraryTables:
    """The tables of a library, made at the first call."""
    made = _MADE.get(library)
    if made is None:
        made = _MADE[library] = _make(library)
    return made


GROUPS = ("body", "contact", "load", "joint", "limit")  # of kinds, as results list them


def _make(library: Library) -> LibraryTables:
    manifest, instance = library.manifest, library.manifest.instance
    tables = tables_of(library.dtype)
    slots = PairSlots(instance)
    scale = _scales(tables, instance, slots.n_eta)
    system, arrays = fill_system(tables, manifest, kernel_table(library.cdll), scale, slots)
    digest = library.cdll.mg_shapes_digest
    digest.restype = ctypes.c_ulonglong
    system.shapes_digest = digest(ctypes.byref(system))
    for array in arrays:
        array.setflags(write=False)
    limits, patch_slots, n_contact = len(instance["limits"]), len(slots.patch_slot), int(system.n_contact)
    n_event = 64 + 8 * n_contact + 4 * int(system.n_switch)
    reals, integers = _sizes_of_run(instance, system, slots)
    work, iwork = fit_scratch(library.cdll, system, tables.dtype, memory_of_run())
    return LibraryTables(
        tables=tables,
        system=system,
        arrays=tuple(arrays),
        start=_start(tables, instance, slots.n_eta),
        slots=slots,
        contact_names=ContactNames(instance, slots)
        if slots
        else tuple(each["name"] for each in (*instance["contacts"], *instance["limits"])),
        feature_pair_names=(*feature_pair_names(instance), *[""] * limits),
        body_names=tuple(body["name"] for body in instance["bodies"]),
        patch_names=tuple(patch["name"] for patch in instance["patches"]),
        shares=shares(instance),
        joint_names=tuple(joint["name"] for joint in instance["joints"]),
        coordinate_names=tuple(
            f"{joint['name']}.{each['name']}"
            for joint in instance["joints"]
            for each in manifest.kinds["joint"][joint["kind"]]["coordinates"]
        ),
        sensor_names=component_names(instance["sensors"]["names"]),
        kind_names=tuple(kind["name"] for group in GROUPS for kind in manifest.kinds[group]),
        instructions={name: entry["instructions"] for name, entry in manifest.functions.items()},
        n_patch_slot=patch_slots,
        n_contact=n_contact,
        n_sensor=sum(size for _, size in instance["sensors"]["names"]),
        n_event=n_event,
        reals=_block(reals, n_event, ("t", "speed", "after_t")),
        integers=_block(integers, n_event, ("kind", "contact", "told_contact", "feature_pair")),
        work_size=work,
        iwork_size=iwork,
        checkpoint_size=_checkpoint_size(library.cdll, system),
    )


def _start(tables: Tables, instance: Mapping[str, Any], n_eta: int) -> Array:
    n_q, n_u = instance["n_q"], instance["n_u"]
    x = np.zeros(n_q + n_u + n_eta + 1, dtype=tables.dtype)
    x[:n_q], x[n_q : n_q + n_u] = instance["initial_q"], instance["initial_u"]
    x.setflags(write=False)
    return x


def _block(sizes: Mapping[str, int], n_event: int, of_events: tuple[str, ...]) -> ArrayBlock:
    columns = dict.fromkeys((EVENT_PREFIX + name for name in of_events), n_event)
    return ArrayBlock({name: (size,) for name, size in (*sizes.items(), *columns.items())})


def _sizes_of_run(
    instance: Mapping[str, Any], system: Any, of_pairs: PairSlots
) -> tuple[dict[str, int], dict[str, int]]:
    """Lengths of the arrays of an mg_run, with one entry to spare, reals and integers."""
    n_contact, slots, groups = int(system.n_contact), len(of_pairs.patch_slot), int(system.n_friction)
    m, pairs = n_contact + 1, int(system.n_pair) + 1
    states = instance["n_q"] + instance["n_u"] + of_pairs.n_eta + 1
    reals = {
        "x": states,
        "point": 3 * n_contact + 1,
        **dict.fromkeys(("moved_since_search", "watched_movement", "unfollowed_gap"), pairs),
        "withheld_effort": pairs,
        "ball_at": 4 * int(system.n_ball) + 1,
        "slip_direction": 3 * groups + 1,
        "patch_slip_direction": 4 * slots + 1,
        "patch_support_share": 3 * slots + 1,
        "reference_force": m + int(system.n_joint_row) + int(system.n_friction_row),
        "force": m,
        "margin": m,
        "after_t": m,
        "tilt_direction": 3 * n_contact + 3,
        **dict.fromkeys(("input", "applied_input"), SETTING_SIZE * len(instance["inputs"]) + 1),
        "branch": int(system.n_switch) + 1,
        "search_bound": int(system.n_cell_tree) + 1,
        "joint_independence_max": int(system.n_joint) + 1,
        "joint_row_before": 12 * int(system.n_joint_row) + 1,
    }
    integers = {
        **dict.fromkeys(("feature_pair", "closed", "active", "rolling_start"), m),
        **dict.fromkeys(("is_search_due", "is_far"), pairs),
        "slot_balls": 2 * of_pairs.count + 1,
        "stop": 1,
        "struck_by": len(instance["bodies"]) + 1,
        "friction_mode": groups + 1,
        **dict.fromkeys(("switch_mode", "switch_leader"), int(system.n_switch) + 1),
        "patch_mode": slots + 1,
        **dict.fromkeys(("joint_row_independent", "joint_row_ever_independent"), int(system.n_joint_row) + 1),
    }
    return reals, integers


def _scales(tables: Tables, instance: Mapping[str, Any], n_eta: int) -> Array:
    """The scale of each state in the error norm; the core sets that of eta."""
    scales = instance["scales"]
    length, time = scales["length"], scales["time"]
    sizes = np.ones(instance["n_q"] + instance["n_u"] + n_eta + 1, dtype=tables.dtype)
    for body in instance["bodies"]:
        u = instance["n_q"] + body["u"]
        if body["motion"] in ("point", "free"):
            sizes[body["q"] : body["q"] + 3] = length
            sizes[u : u + 3] = length / time
        if body["motion"] == "free":
            sizes[u + 3 : u + 6] = 1.0 / time
    sizes[-1] = scales["mass"] * (length / time) ** 2
    return sizes


def _checkpoint_size(cdll: ctypes.CDLL, system: Any) -> int:
    """Bytes of a saved state."""
    cdll.mg_save_size.restype = ctypes.c_long
    return int(cdll.mg_save_size(ctypes.byref(system)))
