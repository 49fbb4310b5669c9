"""The C core's records as ctypes structures, filled from a manifest's sentence."""

from __future__ import annotations

import ctypes
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from modelgen.codegen.manifest import Manifest
from modelgen.runtime.accuracy import RESOLVED
from modelgen.runtime.sides import Sides, append

Array = np.ndarray[Any, Any]

SYSTEM_INTEGERS = (
    *("n_body", "n_contact", "n_load", "n_pair", "n_link"),
    *("n_q", "n_u", "n_eta", "n_closed", "n_joint", "n_row"),
)
SYSTEM_INDICES = (
    *("body_kind", "body_q", "body_u", "body_parameters"),
    *("contact_pair", "contact_eta", "contact_link"),
    *("pair_contact", "pair_link", "pair_search"),
    *("link_kind", "link_o", "link_f", "link_parameters", "link_pair", "link_group", "link_condition"),
    *("side_shape", "side_parameters", "side_numbers"),
    *("condition_kind", "condition_side", "condition_next", "condition_numbers"),
    *("load_kind", "load_a", "load_b", "load_parameters"),
    *("joint_kind", "joint_a", "joint_b", "joint_parameters", "joint_row"),
)
SYSTEM_REALS = ("mass_inverse", "restitution", "parameters", "numbers", "pair_normal", "scale")
SETTINGS_INTEGERS = ("method", "use_gamma", "newton", "project")
SETTINGS_REALS = (
    *("step", "tolerance", "gap", "start_gap", "start_joint", "drift", "rest_speed", "rest_acceleration"),
    *("event", "residual", "leave", "polish", "dependent", "depth", "step_min"),
    *("margin_refuse", "lost", "apart", "reach", "search", "flat", "border"),
)
SETTINGS_COUNTS = ("lcp_iterations", "scan", "events_at_once")
RUN_ARRAYS = ("x", "link", "moved", "closed", "active", "force", "margin")
RUN_COUNTS = (
    "steps",
    "rejected",
    "rhs_evals",
    "lcp_solves",
    "since_projection",
    "events_at_t",
    "redundant_max",
)
RUN_REALS = (
    *("t_event", "energy_0", "energy_error_max", "kinetic_max"),
    *("gap_max", "complementarity_max", "margin_min", "lcp_residual_max"),
    *("joint_error_max", "joint_speed", "dead_centre_t", "joint_margin_min", "joint_margin_t"),
)
RUN_INTEGERS = (
    *("failed_contact", "failed_joint", "joint_margin", "rank_min", "rank_max"),
    *("dead_centres", "dead_centre"),
)
RECORD_ARRAYS = (
    *("t", "pose", "twist", "eta", "force", "gap", "normal", "point_o", "point_f", "link"),
    *("joint_wrench", "coordinate", "energy", "work"),
)
QUERY_GIVEN = ("parameters", "pose_o", "pose_f", "reach")
QUERY_FOUND = ("eta", "d", "normal", "point_o", "point_f", "margin", "outcome")
ROOM, ROOM_PER_BODY = 64, 12
METHODS = {"rk4": 0, "dop853": 1}
SEARCHES = ("never", "moved", "always")  # MG_SEARCH_NEVER ..


class Tables:
    """The structures of one library's real type (modelgen.h)."""

    def __init__(self, dtype: np.dtype[Any]) -> None:
        self.dtype = np.dtype(dtype)
        real: Any = {4: ctypes.c_float, 8: ctypes.c_double}.get(self.dtype.itemsize, ctypes.c_longdouble)
        pointer = ctypes.c_void_p
        integer = ctypes.c_int
        self.real = real
        self.System = _structure(
            "System",
            [(n, integer) for n in SYSTEM_INTEGERS]
            + [(n, pointer) for n in SYSTEM_INDICES + SYSTEM_REALS]
            + [("gravity", real * 3), ("length", real), ("mass", real), ("time", real)],
        )
        self.Settings = _structure(
            "Settings",
            [(n, integer) for n in SETTINGS_INTEGERS]
            + [(n, real) for n in SETTINGS_REALS]
            + [(n, integer) for n in SETTINGS_COUNTS],
        )
        self.Run = _structure(
            "Run",
            [("t", real), ("h", real)]
            + [(n, pointer) for n in RUN_ARRAYS]
            + [(n, ctypes.c_long) for n in RUN_COUNTS]
            + [(n, real) for n in RUN_REALS]
            + [(n, integer) for n in RUN_INTEGERS],
        )
        self.Record = _structure(
            "Record",
            [("capacity", integer), ("count", integer)] + [(n, pointer) for n in RECORD_ARRAYS],
        )
        self.Events = _structure(
            "Events",
            [("capacity", integer), ("count", integer)]
            + [(n, pointer) for n in ("t", "kind", "contact", "link", "speed")],
        )
        self.Queries = _queries(real)


def _queries(real: Any) -> Any:
    return _structure(
        "Queries",
        [(n, ctypes.c_int) for n in ("kind", "n", "warm")]
        + [("stride", ctypes.c_long)]
        + [(n, ctypes.c_void_p) for n in QUERY_GIVEN]
        + [("length", real), ("residual", real)]
        + [(n, ctypes.c_void_p) for n in QUERY_FOUND],
    )


def _structure(name: str, fields: list[tuple[str, Any]]) -> Any:
    return type(name, (ctypes.Structure,), {"_fields_": fields})


def address(array: Array) -> int:
    """The address of a contiguous array's data."""
    return int(array.ctypes.data)


def fill_system(tables: Tables, manifest: Manifest, scale: Array) -> tuple[Any, list[Array]]:
    """The mg_system of a manifest's sentence, and the arrays that it points into, which must outlive it."""
    sentence = manifest.sentence
    bodies, loads, joints, limits = (sentence[key] for key in ("bodies", "loads", "joints", "limits"))
    links, contacts, pairs = sentence["links"], sentence["contacts"], sentence["pairs"]
    parameters: list[float] = []
    of_bodies, of_links, of_loads, of_joints, of_limits = (
        [append(parameters, entry["parameters"]) for entry in group]
        for group in (bodies, links, loads, joints, limits)
    )
    sides = Sides(links, parameters, float(np.finfo(tables.dtype).max))
    integers: dict[str, list[int]] = {
        "body_kind": [b["kind"] for b in bodies],
        "body_q": [b["q"] for b in bodies],
        "body_u": [b["u"] for b in bodies],
        "body_parameters": of_bodies,
        **{f"contact_{key}": [c[key] for c in contacts] for key in ("pair", "eta", "link")},
        "pair_contact": [*(p["contacts"][0] for p in pairs), len(contacts)],
        "pair_link": [*(p["links"][0] for p in pairs), len(links)],
        "pair_search": [SEARCHES.index(p["search"]) for p in pairs],
        **{f"link_{key}": [entry[key] for entry in links] for key in ("kind", "o", "f", "pair", "group")},
        "link_parameters": of_links,
        **sides.integers,
        "load_kind": [entry["kind"] for entry in loads],
        "load_a": [entry["bodies"][0] for entry in loads],
        "load_b": [entry["bodies"][1] if len(entry["bodies"]) > 1 else -1 for entry in loads],
        "load_parameters": of_loads,
        **{f"joint_{key}": [entry[key] for entry in joints] for key in ("kind", "a", "b", "row")},
        "joint_parameters": of_joints,
    }
    _add_limits(integers, limits, of_limits)
    reals = {
        "mass_inverse": [value for b in bodies for value in b["mass_inverse"]],
        "restitution": [
            *(pairs[c["pair"]]["restitution"] for c in contacts),
            *(limit["restitution"] for limit in limits),
        ],
        "parameters": parameters,
        "numbers": sides.numbers,
        "pair_normal": [value for p in (*pairs, *limits) for value in p.get("normal") or (0.0, 0.0, 0.0)],
    }
    arrays = {name: np.array(values or [0], dtype=np.intc) for name, values in integers.items()}
    arrays |= {name: np.array(values or [0.0], dtype=tables.dtype) for name, values in reals.items()}
    arrays["scale"] = scale
    n = len(limits)
    sizes = (len(bodies), len(contacts) + n, len(loads), len(pairs) + n, len(links) + n)
    states = (sentence["n_q"], sentence["n_u"], sentence["n_eta"])
    system = tables.System(*sizes, *states, _room(sentence), len(joints), row_count(manifest))
    for name, array in arrays.items():
        setattr(system, name, address(array))
    system.gravity = (tables.real * 3)(*sentence["gravity"])
    for name, value in sentence["scales"].items():
        setattr(system, name, value)
    return system, list(arrays.values())


def _room(sentence: Mapping[str, Any]) -> int:
    """How many contacts may be closed at a time: all of a small scene, 12 a moving body of a large one."""
    moving = sum(body["motion"] in ("point", "free") for body in sentence["bodies"])
    many = len(sentence["contacts"]) + len(sentence["limits"])
    return min(many, max(ROOM, ROOM_PER_BODY * moving))


def row_count(manifest: Manifest) -> int:
    """Rows of all joints."""
    kinds = manifest.kinds["joint"]
    return sum(int(kinds[joint["kind"]]["rows"]) for joint in manifest.sentence["joints"])


def _add_limits(
    integers: dict[str, list[int]], limits: Sequence[Mapping[str, Any]], parameters: list[int]
) -> None:
    """Each limit is a contact, with a pair and a link of its own behind those with shapes."""
    for limit, start in zip(limits, parameters, strict=True):
        pair, link = len(integers["pair_search"]), len(integers["link_kind"])
        rows = {
            **{"contact_pair": pair, "contact_eta": limit["eta"], "contact_link": link},
            **{"pair_contact": len(integers["contact_pair"]) + 1, "pair_link": link + 1, "pair_search": 0},
            **{"link_kind": limit["kind"], "link_o": limit["o"], "link_f": limit["f"], "link_pair": pair},
            **{"link_group": -1, "link_parameters": start},
            "link_condition": integers["link_condition"][-1],
        }
        for name, value in rows.items():
            integers[name].append(value)
        for name in ("side_shape", "side_parameters", "side_numbers"):
            integers[name] += [0, 0]


def fill_settings(tables: Tables, accuracy: Any) -> Any:
    """The mg_settings of an Accuracy, no tolerance finer than the real type resolves."""
    settings = tables.Settings()
    epsilon = float(np.finfo(tables.dtype).eps)
    for name in ("newton", "project", *SETTINGS_COUNTS):
        setattr(settings, name, int(getattr(accuracy, name)))
    for name in SETTINGS_REALS[1:]:
        setattr(settings, name, max(float(getattr(accuracy, name)), RESOLVED.get(name, 0) * epsilon))
    settings.method = METHODS[accuracy.method]
    settings.use_gamma = int(accuracy.use_gamma)
    settings.step = accuracy.step or 0.0
    return settings
