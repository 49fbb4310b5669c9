"""The C core's records as ctypes structures, filled from a manifest's sentence."""

from __future__ import annotations

import ctypes
from collections.abc import Mapping
from typing import Any

import numpy as np

from modelgen.codegen.manifest import Manifest
from modelgen.runtime.accuracy import RESOLVED
from modelgen.runtime.tables.feature_sides import Sides, append
from modelgen.runtime.tables.friction_rows import Grips
from modelgen.runtime.tables.joint_limits import add_limits
from modelgen.runtime.tables.planar_contacts import PADS, add_patches, point_restitutions, slot_count

Array = np.ndarray[Any, Any]

KERNELS = "kernels"  # the table of the scene's library, first field of what the core is given
SYSTEM_INTEGERS = (
    *("n_body", "n_contact", "n_load", "n_pair", "n_link"),
    *("n_q", "n_u", "n_eta", "n_closed", "n_joint", "n_row"),
    *("n_patch", "n_slot", "n_table", "n_grip", "n_below"),
)
SYSTEM_INDICES = (
    *("body_kind", "body_q", "body_u", "body_parameters"),
    *("contact_pair", "contact_eta", "contact_link"),
    *("pair_contact", "pair_link", "pair_search"),
    *("link_kind", "link_o", "link_f", "link_parameters", "link_pair", "link_group", "link_condition"),
    *("side_shape", "side_parameters", "side_numbers", "side_table", "table_first"),
    *("condition_kind", "condition_side", "condition_next", "condition_numbers"),
    *("load_kind", "load_a", "load_b", "load_parameters"),
    *("joint_kind", "joint_a", "joint_b", "joint_parameters", "joint_row"),
    *("patch_pair", "patch_slots", "patch_arc", "patch_arc_f", "patch_numbers", "patch_cover", "covered"),
    *("arc_shape", "arc_parameters", "arc_numbers", "arc_loop"),
    *("contact_below", "contact_grip", "impact_law", "grip_aspect", "grip_row", "grip_body"),
)
SYSTEM_REALS = (
    *("mass_inverse", "restitution", "parameters", "numbers"),
    *("grip_static", "grip_kinetic", "grip_direction", "patch_friction", "pair_normal", "pair_ball", "scale"),
)
SETTINGS_INTEGERS = (
    *("method", "scheme", "law", "fallback", "use_gamma", "newton", "project"),
    *("sequential", "planar"),
)
SETTINGS_REALS = (
    *(
        "step",
        "theta",
        "loose",
        "fallback_step",
        "crawl",
        "tolerance",
        "gap",
        "start_gap",
        "start_joint",
        "drift",
        "rest_speed",
    ),
    *("slip_speed", "cone", "rest_acceleration"),
    *("event", "residual", "arrest", "leap", "leave", "polish", "dependent", "singular", "depth", "step_min"),
    *("margin_warn", "margin_refuse", "margin_appear", "lean", "lost", "apart", "reach", "search"),
    *("flat", "imaginary_edge", "shared", "border", "look", "stride"),
)
SETTINGS_COUNTS = ("lcp_iterations", "scan", "events_at_once")
RUN_ARRAYS = (
    *(
        "x",
        "link",
        "point",
        "moved",
        "closed",
        "active",
        "grip",
        "slip_direction",
        "patch_mode",
        "patch_slip_direction",
        "reference_force",
    ),
    *("force", "margin", "fresh", "outward"),
)
RUN_COUNTS = (
    "steps",
    "rejected",
    "rhs_evals",
    "lcp_solves",
    "since_projection",
    "events_at_t",
    *(
        "progress_tries",
        "progress_rejected",
        "fallbacks",
        "fallback_steps_left",
        "loose_solutions",
        "relaxed_solutions",
    ),
    "singular_passages",
    "redundant_max",
)
RUN_REALS = (
    *("t_event", "t_roundoff", "energy_0", "energy_error_max", "kinetic_max"),
    *("gap_max", "complementarity_max", "margin_min", "lcp_residual_max"),
    *("joint_error_max", "joint_speed", "dead_centre_t", "joint_margin_min", "joint_margin_t"),
    *("progress_t", "fallback_first", "fallback_end", "fallback_time"),
    *("gain_max", "gain_t", "chain_t", "paradox_t"),
)
RUN_INTEGERS = (
    *("failed_contact", "failed_joint", "joint_margin", "rank_min", "rank_max"),
    *("dead_centres", "dead_centre", "gain_contact", "chain_contact", "paradox_contact"),
    *("fallback_cause", "fallback_doublings", "passage_contact", "forces_redundant"),
)
RECORD_ARRAYS = (
    *("t", "pose", "twist", "eta", "force", "gap", "normal", "point_o", "point_f", "link"),
    *("patch", "pressure", "rub", "friction", "torque", "slip"),
    *("joint_wrench", "coordinate", "energy", "work"),
)
QUERY_GIVEN = ("parameters", "pose_o", "pose_f", "reach")
QUERY_FOUND = ("eta", "d", "normal", "point_o", "point_f", "margin", "outcome")
PARAMETRISED = ("bodies", "links", "loads", "joints", "limits")
ROOM, ROOM_PER_BODY = 2048, 12  # rows that may be held at a time: memory grows with its square, once used
METHODS = {"rk4": 0, "dop853": 1, "time-stepping": 2}
SCHEMES = {"stewart-trinkle": 0, "anitescu-potra": 1, "moreau": 2}
LAWS = {"coulomb": 0, "relaxation": 1}
IMPACT_LAWS = {"newton": 0, "poisson": 1, "stronge": 2}
SEARCHES = ("never", "moved", "always", "ahead")  # MG_SEARCH_NEVER ..


class Tables:
    """The structures of one library's real type (modelgen.h)."""

    def __init__(self, dtype: np.dtype[Any]) -> None:
        self.dtype = np.dtype(dtype)
        real: Any = {4: ctypes.c_float, 8: ctypes.c_double}.get(self.dtype.itemsize, ctypes.c_longdouble)
        pointer = ctypes.c_void_p
        integer = ctypes.c_int
        self.real = real
        self.System = structure(
            "System",
            [(KERNELS, pointer)]
            + [(n, integer) for n in SYSTEM_INTEGERS]
            + [(n, pointer) for n in SYSTEM_INDICES + SYSTEM_REALS]
            + [("gravity", real * 3), ("length", real), ("mass", real), ("time", real)],
        )
        self.Settings = structure(
            "Settings",
            [(n, integer) for n in SETTINGS_INTEGERS]
            + [(n, real) for n in SETTINGS_REALS]
            + [(n, integer) for n in SETTINGS_COUNTS],
        )
        self.Run = structure(
            "Run",
            [("t", real), ("h", real)]
            + [(n, pointer) for n in RUN_ARRAYS]
            + [(n, ctypes.c_long) for n in RUN_COUNTS]
            + [(n, real) for n in RUN_REALS]
            + [(n, integer) for n in RUN_INTEGERS],
        )
        self.Record = structure(
            "Record",
            [("capacity", integer), ("count", integer)] + [(n, pointer) for n in RECORD_ARRAYS],
        )
        self.Events = structure(
            "Events",
            [("capacity", integer), ("count", integer)]
            + [(n, pointer) for n in ("t", "kind", "contact", "link", "speed")],
        )
        self.Queries = _queries(real)


def _queries(real: Any) -> Any:
    return structure(
        "Queries",
        [(KERNELS, ctypes.c_void_p)]
        + [(n, ctypes.c_int) for n in ("kind", "n", "warm")]
        + [("stride", ctypes.c_long)]
        + [(n, ctypes.c_void_p) for n in QUERY_GIVEN]
        + [("length", real), ("residual", real)]
        + [(n, ctypes.c_void_p) for n in QUERY_FOUND],
    )


def structure(name: str, fields: list[tuple[str, Any]]) -> Any:
    """A C structure as ctypes knows it."""
    return type(name, (ctypes.Structure,), {"_fields_": fields})


def address(array: Array) -> int:
    """The address of a contiguous array's data."""
    return int(array.ctypes.data)


def fill_system(tables: Tables, manifest: Manifest, kernels: int, scale: Array) -> tuple[Any, list[Array]]:
    """The mg_system of a manifest's sentence over the kernels at an address, and its arrays, which must
    outlive it."""
    sentence = manifest.sentence
    parameters: list[float] = []
    starts = {
        group: [append(parameters, entry["parameters"]) for entry in sentence[group]]
        for group in PARAMETRISED
    }
    sides = Sides(manifest, parameters, float(np.finfo(tables.dtype).max))
    integers = _bodies_and_contacts(sentence, starts) | sides.integers | _loads_and_joints(sentence, starts)
    add_limits(integers, sentence["limits"], starts["limits"])
    add_patches(integers, sides.numbers, parameters, sentence)
    grips = Grips(sentence)
    integers |= grips.integers
    reals = _reals(sentence) | {"parameters": parameters, "numbers": sides.numbers} | grips.reals
    arrays = {name: np.array(values or [0], dtype=np.intc) for name, values in integers.items()}
    arrays |= {name: np.array(values or [0.0], dtype=tables.dtype) for name, values in reals.items()}
    arrays["scale"] = scale
    states = (sentence["n_q"], sentence["n_u"], sentence["n_eta"])
    rows = _room(manifest), len(sentence["joints"]), _row_count(manifest)
    patches = len(sentence["patches"]), slot_count(sentence)
    counts = *rows, *patches, len(integers["table_first"]) - 1, grips.count, grips.rows
    system = tables.System(kernels, *_sizes(sentence, integers), *states, *counts)
    for name, array in arrays.items():
        setattr(system, name, address(array))
    system.gravity = (tables.real * 3)(*sentence["gravity"])
    for name, value in sentence["scales"].items():
        setattr(system, name, value)
    return system, list(arrays.values())


def _sizes(sentence: Mapping[str, Any], integers: Mapping[str, list[int]]) -> tuple[int, ...]:
    """Numbers of bodies, contacts, loads, pairs and links; limits and points of patches are contacts too."""
    counted = (integers[name] for name in ("contact_pair", "load_kind", "pair_search", "link_kind"))
    return len(sentence["bodies"]), *(len(entries) for entries in counted)


def _bodies_and_contacts(
    sentence: Mapping[str, Any], starts: Mapping[str, list[int]]
) -> dict[str, list[int]]:
    bodies, links, contacts, pairs = (sentence[key] for key in ("bodies", "links", "contacts", "pairs"))
    return {
        **{f"body_{key}": [b[key] for b in bodies] for key in ("kind", "q", "u")},
        "body_parameters": starts["bodies"],
        **{f"contact_{key}": [c[key] for c in contacts] for key in ("pair", "eta", "link")},
        "impact_law": _impact_laws(sentence),
        "pair_contact": [*(p["contacts"][0] for p in pairs), len(contacts)],
        "pair_link": [*(p["links"][0] for p in pairs), len(links)],
        "pair_search": [SEARCHES.index(p["search"]) for p in pairs],
        **{f"link_{key}": [entry[key] for entry in links] for key in ("kind", "o", "f", "pair", "group")},
        "link_parameters": starts["links"],
    }


def _impact_laws(sentence: Mapping[str, Any]) -> list[int]:
    """Of contacts, then of limits and the points of patches, which follow Newton's."""
    laws = [IMPACT_LAWS[sentence["pairs"][c["pair"]].get("law", "newton")] for c in sentence["contacts"]]
    return laws + [0] * (len(sentence["limits"]) + PADS * slot_count(sentence))


def _loads_and_joints(sentence: Mapping[str, Any], starts: Mapping[str, list[int]]) -> dict[str, list[int]]:
    loads, joints = sentence["loads"], sentence["joints"]
    return {
        "load_kind": [entry["kind"] for entry in loads],
        "load_a": [entry["bodies"][0] for entry in loads],
        "load_b": [entry["bodies"][1] if len(entry["bodies"]) > 1 else -1 for entry in loads],
        "load_parameters": starts["loads"],
        **{f"joint_{key}": [entry[key] for entry in joints] for key in ("kind", "a", "b", "row")},
        "joint_parameters": starts["joints"],
    }


def _reals(sentence: Mapping[str, Any]) -> dict[str, list[float]]:
    pairs, limits = sentence["pairs"], sentence["limits"]
    of_contacts = [pairs[c["pair"]]["restitution"] for c in sentence["contacts"]]
    return {
        "mass_inverse": [value for b in sentence["bodies"] for value in b["mass_inverse"]],
        "restitution": [
            *of_contacts,
            *(limit["restitution"] for limit in limits),
            *point_restitutions(sentence),
        ],
        "pair_normal": [value for p in (*pairs, *limits) for value in p.get("normal") or (0.0, 0.0, 0.0)],
        "pair_ball": [
            value
            for p in pairs
            for ball in p["balls"]
            for value in (*ball["centre"], -1.0 if ball["radius"] is None else ball["radius"])
        ],
    }


def _room(manifest: Manifest) -> int:
    """How many contacts may be closed at a time: all of a small scene, 12 a moving body of a large one."""
    sentence = manifest.sentence
    moving = sum(body["motion"] in ("point", "free") for body in sentence["bodies"])
    many = len(sentence["contacts"]) + len(sentence["limits"]) + PADS * slot_count(sentence)
    rows = max((kind.get("rows", 1) for kind in manifest.kinds["contact"]), default=1)
    return min(many, max(ROOM // rows, ROOM_PER_BODY * moving))


def _row_count(manifest: Manifest) -> int:
    """Rows of all joints."""
    kinds = manifest.kinds["joint"]
    return sum(int(kinds[joint["kind"]]["rows"]) for joint in manifest.sentence["joints"])


def fill_settings(tables: Tables, accuracy: Any, sentence: Mapping[str, Any]) -> Any:
    """The mg_settings of an Accuracy, no tolerance finer than the real type resolves.

    Patches are of event-driven runs whose contacts are all struck at once.
    """
    settings = tables.Settings()
    epsilon = float(np.finfo(tables.dtype).eps)
    for name in ("newton", "project", "fallback", *SETTINGS_COUNTS):
        setattr(settings, name, int(getattr(accuracy, name)))
    for name in SETTINGS_REALS[1:]:
        setattr(settings, name, max(float(getattr(accuracy, name)), RESOLVED.get(name, 0) * epsilon))
    settings.method, settings.scheme = METHODS[accuracy.method], SCHEMES[accuracy.scheme]
    settings.law = LAWS[accuracy.solver]
    settings.sequential = int(accuracy.impacts == "sequential")
    settings.use_gamma = int(accuracy.use_gamma)
    at_once = not (settings.sequential or any(_impact_laws(sentence)))
    settings.planar = int(accuracy.planar and accuracy.method != "time-stepping" and at_once)
    settings.step = accuracy.step or 0.0
    return settings
