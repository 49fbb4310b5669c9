"""The structures of the core (modelgen.h) as ctypes structures, filled from a manifest's instance."""

from __future__ import annotations

import ctypes
from collections.abc import Mapping
from functools import cache, lru_cache
from itertools import accumulate, pairwise
from typing import Any

import numpy as np

from modelgen.codegen.manifest import Manifest
from modelgen.runtime.accuracy import RESOLVED, Accuracy
from modelgen.runtime.arguments import input_range
from modelgen.runtime.tables.features import FeatureTables, cell_capacity
from modelgen.runtime.tables.friction_rows import FrictionTables
from modelgen.runtime.tables.number_pool import INTEGER as INTEGER
from modelgen.runtime.tables.number_pool import Array as Array
from modelgen.runtime.tables.number_pool import NumberPool, may_share
from modelgen.runtime.tables.pair_slots import PairSlots, with_slots
from modelgen.runtime.tables.planar_contacts import (
    SUPPORT_POINTS,
    add_patches,
    may_patches_open,
    point_restitutions,
    slot_count,
)
from modelgen.runtime.tables.shapes import BallTables, SolidTables

KERNELS = "kernels"  # the table of the scene's library, first field of what the core is given
SYSTEM_INTEGERS = (
    *("n_body", "n_contact", "n_load", "n_pair", "n_feature_pair"),
    *("n_q", "n_u", "n_eta", "closed_capacity", "n_joint", "n_joint_row", "n_stand_in"),
    *("n_patch", "n_patch_slot", "n_cell_tree", "n_cell", "n_face_group", "may_patches_open"),
    *("n_friction", "n_friction_row"),
    *("n_ball", "n_ball_class", "n_pool", "slot_contact_max", "n_solid"),
    *("n_input", "n_switch", "sensor_parameters"),
    *("n_parameters", "n_numbers"),
)
SYSTEM_INDICES = (
    *("body_kind", "body_q", "body_u", "body_parameters"),
    *("contact_pair", "contact_eta", "contact_feature_pair"),
    *("pair_contact", "pair_feature_pair", "pair_search", "pair_is_candidate", "pair_balls"),
    *("ball_body", "ball_partner_begin", "ball_partner", "ball_pair"),
    *("pool_slot", "pool_pattern", "pool_width", "pool_told_pair"),
    *("ball_class", "ball_rank", "class_pool"),
    *("ball_solid", "solid_body", "solid_is_cavity", "solid_numbers", "solid_term"),
    *("term_kind", "term_numbers", "term_size"),
    *(
        "feature_pair_kind",
        "feature_pair_o",
        "feature_pair_f",
        "feature_pair_parameters",
        "feature_pair_owner",
        "feature_pair_group",
        "feature_pair_condition",
    ),
    *("feature_shape", "feature_parameters", "feature_numbers", "feature_tree", "tree_shape"),
    "feature_is_listed",
    *("condition_kind", "condition_feature", "condition_feature_pair", "condition_numbers"),
    "condition_is_line_end",
    *("load_kind", "load_a", "load_b", "load_parameters", "load_switch"),
    *("joint_kind", "joint_a", "joint_b", "joint_parameters", "joint_row"),
    *("patch_pair", "patch_slots", "patch_arc", "patch_arc_f", "patch_numbers", "patch_covered"),
    *("covered_feature_pair", "patch_share", "share_pair", "share_arc"),
    *("arc_shape", "arc_parameters", "arc_numbers", "arc_loop"),
    *(
        "contact_friction_row",
        "contact_friction",
        "impact_law",
        "friction_kind",
        "friction_row",
        "friction_body",
    ),
    "input_is_linear",
)
SYSTEM_REALS = (
    "input_range",
    *("mass_inverse", "restitution", "parameters", "numbers"),
    *(
        "friction_static",
        "friction_kinetic",
        "friction_direction",
        "patch_friction",
        "pair_normal",
        "ball",
        "scale",
    ),
)
SETTINGS_INTEGERS = (
    *("method", "stepping_scheme", "stepping_friction_law", "fallback", "use_gamma", "newton", "project"),
    *("sequential", "planar_contacts"),
)
SETTINGS_REALS = (
    *(
        "step",
        "stepping_theta",
        "stepping_tolerance",
        "stepping_residual",
        "fallback_step",
        "fallback_progress",
        "chatter_step",
        "chatter_work",
        "tolerance",
        "contact_gap",
        "start_gap",
        "start_joint_gap",
        "drift_tolerance",
        "rest_speed",
    ),
    *("slip_speed", "friction_bound_margin", "other_motion", "rest_acceleration"),
    *(
        "event_tolerance",
        "extremality_residual",
        "slip_stop_speed_ratio",
        "separation_speed_factor",
        "derivative_error_factor",
        "derivative_kink_part",
        "derivative_step_min",
        "load_jump_rate",
        "load_jump_span",
        "derivative_reach",
        "derivative_jump_part",
        "derivative_impact_residual",
        "derivative_start_change",
        "sensor_kink_reach",
        "sensor_kink_part",
        "sensor_slope_part",
        "face_force_part",
        "face_centre_part",
        "rest_loss_factor",
        "event_correction_step",
        "contact_rank_tolerance",
        "joint_rank_tolerance",
        "penetration_limit",
        "correction_ratio",
        "appear_depth",
        "step_min",
    ),
    *(
        "margin_warn",
        "margin_refuse",
        "passage_time_max",
        "overlap_clear_gaps",
        "overlap_clear_part",
        "appear_margin",
        "appear_tilt_sine",
        "search_margin",
        "search_merge_distance",
        "search_gap",
        "search_movement",
    ),
    *(
        "flat_angle",
        "parallel_angle",
        "imaginary_edge",
        "boundary_coincidence",
        "feature_border",
        "time_resolution",
        "step_fraction",
    ),
    *("flush_height", "gap_error_max", "energy_error_max", "complementarity_error_max"),
)
OWN = (  # of SETTINGS_REALS: fields of Accuracy itself, the others are its thresholds
    *("tolerance", "contact_gap", "start_gap", "rest_speed", "slip_speed", "imaginary_edge", "flush_height"),
)
SETTINGS_COUNTS = (
    *("lcp_iterations", "event_scan_parts", "events_at_once_max", "sweep_from_last", "chatter_closed"),
)
RUN_ARRAYS = (
    *(
        "x",
        "feature_pair",
        "point",
        "moved_since_search",
        "is_search_due",
        "watched_movement",
        "unfollowed_gap",
        "withheld_effort",
        "is_far",
        "slot_balls",
        "stop",
        "ball_at",
        "closed",
        "active",
        "friction_mode",
        "slip_direction",
        "patch_mode",
        "patch_slip_direction",
        "patch_support_share",
        "reference_force",
    ),
    *("force", "margin", "rolling_start", "after_t", "struck_by", "tilt_direction", "input", "applied_input"),
    *("branch", "switch_mode", "switch_leader"),
    *("search_bound", "joint_independence_max", "joint_row_before"),
    *("joint_row_independent", "joint_row_ever_independent"),
)
RUN_COUNTS = (
    "steps",
    "rejected",
    "rhs_evals",
    "steps_max",
    "since_projection",
    "events_at_t",
    "tiny_bounces",
    "progress_tries",
    "progress_rejected",
    "fallback_transitions",
    "search_effort",
)
RUN_REALS = (
    "t_event",
    "t_roundoff",
    "progress_t",
    "fallback_end",
    "fallback_step",
    "fallback_left",
    "event_work",
    "event_work_t",
)
RUN_INTEGERS = (
    "present_cause",
    "fallback_doublings",
    "forces_redundant",
    "friction_redundant",
    "is_passage_due",
)
REPORT_COUNTS = (
    "qp_solves",
    "friction_solves",
    "relaxed_solves",
    "outer_solves",
    "fallbacks",
    "jams",
    "chatters",
    "loose_solutions",
    "relaxed_solutions",
    "singular_passages",
    "slip_stops",
    "redundant_max",
    "unfollowed_minima",
    "incomplete_searches",
)
CAPACITIES = (  # MG_CAPACITY_
    "closed",
    "stationary",
    "left",
    "segment",
    "slot",
    "region",
    "events",
    "pressure",
    "near",
)
REPORT_REALS = (
    "energy_0",
    "energy_error_max",
    "correction_work",
    "correction_energy",
    "kinetic_max",
    "gap_max",
    "penetration_max",
    "penetration_t",
    "complementarity_max",
    "margin_min",
    "lcp_residual_max",
    "joint_error_max",
    "joint_speed",
    "dead_centre_t",
    "joint_margin_min",
    "joint_margin_t",
    "fallback_first",
    "fallback_time",
    "chatter_first",
    "chatter_time",
    "impact_gain_max",
    "impact_gain_t",
    "chain_impact_t",
    "painleve_t",
    "unfollowed_t",
    "spin_max",
    "force_rounding",
    "spring_rate_max",
    "incomplete_t",
    "indeterminate_t",
    "indeterminate_part",
    "flush_t",
)
REPORT_INTEGERS = (
    "failed_contact",
    "failed_joint",
    "joint_margin",
    "rank_min",
    "rank_max",
    "dead_centres",
    "dead_centre",
    "impact_gain_contact",
    "chain_impact_contact",
    "painleve_contact",
    "fallback_cause",
    "passage_contact",
    "unfollowed_pair",
    "incomplete_pair",
    "penetration_contact",
    "spin_body",
    "overlapping_patch",
    "spring_rate_load",
    "indeterminate",
    "indeterminate_contact",
    "indeterminate_switch",
    "flush_contact",
    "shared_switch",
    "exceeded_pool",
)
RECORD_ARRAYS = (
    *("t", "pose", "twist", "eta", "force", "gap", "normal", "point_o", "point_f", "feature_pair"),
    *("patch", "slot_balls", "pressure", "patch_friction", "patch_share", "friction", "torque", "slip"),
    *("joint_wrench", "coordinate", "energy", "work", "sensors"),
)
DIRECTION_ARRAYS = (
    *("start", "parameters", "gravity", "restitution", "friction_static", "friction_kinetic"),
    *("patch_friction", "input", "moves_borders", "is_permitted"),
)
COTANGENT_ARRAYS = (
    *("x", "parameters", "gravity", "restitution", "friction_static", "friction_kinetic"),
    *("patch_friction", "input"),
)
EVENT_ARRAYS = ("t", "kind", "contact", "told_contact", "feature_pair", "speed", "after_t")
QUERY_GIVEN = ("parameters", "pose_o", "pose_f", "step_limit")
QUERY_FOUND = ("eta", "d", "normal", "point_o", "point_f", "margin", "outcome")
MINIMA = 24  # MG_MINIMA
MINIMA_GIVEN = ("pose_o", "pose_f")
MINIMA_FOUND = (
    *("count", "is_complete", "feature_pair"),
    *("d", "normal", "point_o", "point_f", "eta", "margin"),
)
ROOM, ROOM_PER_BODY = 2048, 12  # rows that may be held at a time: memory grows with its square, once used
METHODS = {"rk4": 0, "dop853": 1, "time-stepping": 2}
SCHEMES = {"stewart-trinkle": 0, "anitescu-potra": 1, "moreau": 2}
LAWS = {"relaxation": 1}  # other solvers: MG_COULOMB, 0
IMPACT_LAWS = {"newton": 0, "poisson": 1, "stronge": 2}
SEARCHES = ("never", "moved", "always", "ahead", "apart")  # MG_SEARCH_NEVER ..


class Tables:
    """The structures of one real type (modelgen.h)."""

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
            + [("gravity", real * 3), ("length", real), ("mass", real), ("time", real)]
            + [("shapes_digest", ctypes.c_ulonglong)],
        )
        self.Settings = structure(
            "Settings",
            [(n, integer) for n in SETTINGS_INTEGERS]
            + [(n, real) for n in SETTINGS_REALS]
            + [(n, integer) for n in SETTINGS_COUNTS]
            + [("outer_solver", pointer)],
        )
        self.Report = structure(
            "Report",
            [(n, ctypes.c_long) for n in REPORT_COUNTS]
            + [("exceeded", ctypes.c_long * len(CAPACITIES))]
            + [(n, real) for n in REPORT_REALS]
            + [("exceeded_t", real * len(CAPACITIES))]
            + [(n, integer) for n in REPORT_INTEGERS],
        )
        self.Run = structure(
            "Run",
            [("t", real), ("h", real)]
            + [(n, pointer) for n in RUN_ARRAYS]
            + [(n, ctypes.c_long) for n in RUN_COUNTS]
            + [(n, real) for n in RUN_REALS]
            + [(n, integer) for n in RUN_INTEGERS]
            + [("report", self.Report)],
        )
        self.Record = structure(
            "Record",
            [("capacity", integer), ("count", integer)] + [(n, pointer) for n in (*RECORD_ARRAYS, "empty")],
        )
        self.Events = structure(
            "Events",
            [("capacity", integer), ("count", integer)] + [(n, pointer) for n in EVENT_ARRAYS],
        )
        self.Directions = structure(
            "Directions", [("n", integer)] + [(n, pointer) for n in (*DIRECTION_ARRAYS, "given")]
        )
        self.Tangent = structure(
            "Tangent",
            [
                *[("x", pointer), ("capacity", integer), ("count", integer)],
                *[("event_t", pointer), ("event_contact", pointer), ("event_t_dot", pointer)],
                *[("verdict", integer), ("reason", integer), ("reason_t", real), ("reason_contact", integer)],
                *[("work", pointer), ("iwork", pointer), ("tape", pointer), ("is_lost", integer)],
                ("sides", pointer),
            ],
        )
        self.Tape = structure(
            "Tape",
            [(n, ctypes.c_long) for n in ("capacity", "count")]
            + [(n, pointer) for n in ("bytes", "slopes", "crossing")]
            + [("lost", ctypes.c_long)],
        )
        self.Adjoint = structure(
            "Adjoint", [(n, pointer) for n in (*COTANGENT_ARRAYS, "work", "iwork", "given")]
        )
        self.Controller = structure(
            "Controller",
            [
                *[("call", pointer), ("data", pointer), ("period", real), ("start", real)],
                *[("calls", ctypes.c_long), ("sensors", pointer), ("command", pointer)],
            ],
        )
        self.Control = ctypes.CFUNCTYPE(None, pointer, real, pointer, pointer)
        self.Queries = _queries(real)
        self.MinimaQueries = structure(
            "MinimaQueries",
            [(n, integer) for n in ("first", "end", "body_o", "body_f", "n", "is_nearest")]
            + [("effort", ctypes.c_long), ("gap", real), ("depth", real)]
            + [(n, pointer) for n in MINIMA_GIVEN + MINIMA_FOUND],
        )


@cache
def tables_of(dtype: np.dtype[Any]) -> Tables:
    """The structures of a real type, made once."""
    return Tables(dtype)


def _queries(real: Any) -> Any:
    return structure(
        "Queries",
        [(KERNELS, ctypes.c_void_p)]
        + [(n, ctypes.c_int) for n in ("kind", "n", "is_warm_start")]
        + [("stride", ctypes.c_long)]
        + [(n, ctypes.c_void_p) for n in QUERY_GIVEN]
        + [("length", real), ("residual", real)]
        + [(n, ctypes.c_void_p) for n in QUERY_FOUND],
    )


def structure(name: str, fields: list[tuple[str, Any]]) -> Any:
    """A ctypes structure with the given fields."""
    return type(name, (ctypes.Structure,), {"_fields_": fields})


def address(array: Array) -> int:
    """The address of a contiguous array's data."""
    return int(array.ctypes.data)


def packed(
    columns: Mapping[str, Array | list[Any]], dtype: np.dtype[Any]
) -> tuple[dict[str, Array], dict[str, int]]:
    """Columns of numbers as read-only arrays in one piece of memory, and their addresses; an empty column is
    one 0."""
    filled = [np.asarray(values if len(values) else [0], dtype=dtype) for values in columns.values()]
    block = np.concatenate(filled)
    block.setflags(write=False)
    starts = [*accumulate(map(len, filled), initial=0)]
    first, spans = address(block), dict(zip(columns, pairwise(starts), strict=True))
    arrays = {name: block[start:end] for name, (start, end) in spans.items()}
    return arrays, {name: first + start * dtype.itemsize for name, (start, _) in spans.items()}


def fill_system(
    tables: Tables, manifest: Manifest, kernels: int, scale: Array, slots: PairSlots
) -> tuple[Any, list[Array]]:
    """The mg_system of a manifest's instance over the kernels at an address, and its arrays, which must
    outlive it."""
    instance = manifest.instance
    shares = may_share(instance, manifest.functions)
    parameters, numbers = NumberPool(shares), NumberPool(shares)
    starts = {"bodies": [parameters.append(body["parameters"]) for body in instance["bodies"]]}
    sides = FeatureTables(manifest, parameters, numbers, float(np.finfo(tables.dtype).max))
    for group in ("loads", "joints", "limits"):
        starts[group] = [parameters.append(entry["parameters"]) for entry in instance[group]]
    listed = _bodies_and_contacts(instance, starts) | _loads_and_joints(instance, starts)
    listed["load_switch"] = _switches(manifest)
    integers = {name: np.array(values, dtype=INTEGER) for name, values in listed.items()} | sides.integers
    if instance["limits"]:
        from modelgen.runtime.tables.joint_limits import add_limits  # many scenes have none

        add_limits(integers, instance["limits"], starts["limits"])
    add_patches(integers, numbers, parameters, instance)
    of_inputs = (
        len(instance["inputs"]),
        int(integers["load_switch"][-1]),
        parameters.append(instance["sensors"]["parameters"]),
    )
    constraints, balls = FrictionTables(instance), BallTables(instance)
    solids = SolidTables(instance, balls.index, numbers)
    others: dict[str, list[int]] = (
        constraints.integers
        | balls.integers
        | solids.integers
        | slots.index_tables(balls.index)
        | {"input_is_linear": [int(each["hold"] == "linear") for each in instance["inputs"]]}
    )
    reals = (
        _reals(instance)
        | {"input_range": _input_ranges(tables, instance)}
        | {"parameters": parameters.values, "numbers": numbers.values}
        | constraints.reals
        | balls.reals
    )
    whole = integers | {name: np.array(values, dtype=INTEGER) for name, values in others.items()}
    columns = {name: np.array(values, dtype=tables.dtype) for name, values in reals.items()}
    if slots:
        whole, columns = with_slots(whole, columns, slots)
    arrays, at = packed(whole, INTEGER)
    real_arrays, real_at = packed(columns, tables.dtype)
    arrays |= real_arrays | {"scale": scale}
    at |= real_at | {"scale": address(scale)}
    states = (instance["n_q"], instance["n_u"], slots.n_eta)
    held = len(slots.patch), len(slots.patch_slot)
    n_joints = len(instance["joints"]), _row_count(manifest), len(instance.get("stand_ins", ()))
    trees = int(integers["feature_tree"].max(initial=-1)) + 1
    groups = int(integers["feature_pair_group"].max(initial=-1)) + 1
    of_searches = trees, cell_capacity(trees), groups, int(may_patches_open(integers, numbers.values))
    of_friction = len(whole["friction_kind"]), int(whole["contact_friction_row"][-1])
    of_shapes = balls.count, len(slots.classes), len(slots.pools), slots.told_stride - 1, solids.count
    room = _room(manifest, len(whole["contact_pair"]))
    counts = room, *n_joints, *held, *of_searches, *of_friction, *of_shapes, *of_inputs
    pools = len(parameters.values), len(numbers.values)
    system = tables.System(kernels, *_sizes(instance, whole), *states, *counts, *pools)
    for name, place in at.items():
        setattr(system, name, place)
    system.gravity = (tables.real * 3)(*instance["gravity"])
    for name, value in instance["scales"].items():
        setattr(system, name, value)
    return system, list(arrays.values())


def _sizes(instance: Mapping[str, Any], integers: Mapping[str, Array]) -> tuple[int, ...]:
    """The numbers of bodies, contacts (with limits and support points), loads, pairs and feature pairs."""
    counted = (integers[name] for name in ("contact_pair", "load_kind", "pair_search", "feature_pair_kind"))
    return len(instance["bodies"]), *(len(entries) for entries in counted)


def _bodies_and_contacts(
    instance: Mapping[str, Any], starts: Mapping[str, list[int]]
) -> dict[str, list[int]]:
    bodies, contacts, pairs = (instance[key] for key in ("bodies", "contacts", "pairs"))
    return {
        **{f"body_{key}": [b[key] for b in bodies] for key in ("kind", "q", "u")},
        "body_parameters": starts["bodies"],
        **{f"contact_{key}": [c[key] for c in contacts] for key in ("pair", "eta", "feature_pair")},
        "impact_law": _impact_laws(instance),
        "pair_contact": [*(p["contacts"][0] for p in pairs), len(contacts)],
        "pair_search": [SEARCHES.index(p["search"]) for p in pairs],
    }


def _impact_laws(instance: Mapping[str, Any]) -> list[int]:
    """Impact laws of contacts, then of limits and support points, for which it is Newton's."""
    laws = [IMPACT_LAWS[instance["pairs"][c["pair"]].get("law", "newton")] for c in instance["contacts"]]
    return laws + [0] * (len(instance["limits"]) + SUPPORT_POINTS * slot_count(instance))


def _loads_and_joints(instance: Mapping[str, Any], starts: Mapping[str, list[int]]) -> dict[str, list[int]]:
    loads, joints = instance["loads"], instance["joints"]
    return {
        "load_kind": [entry["kind"] for entry in loads],
        "load_a": [entry["bodies"][0] for entry in loads],
        "load_b": [entry["bodies"][1] if len(entry["bodies"]) > 1 else -1 for entry in loads],
        "load_parameters": starts["loads"],
        **{f"joint_{key}": [entry[key] for entry in joints] for key in ("kind", "a", "b", "row")},
        "joint_parameters": starts["joints"],
    }


def _switches(manifest: Manifest) -> list[int]:
    """The first switching function of each load, and the one after the last."""
    kinds, loads = manifest.kinds["load"], manifest.instance["loads"]
    return [*accumulate((int(kinds[load["kind"]].get("switches", 0)) for load in loads), initial=0)]


def _reals(instance: Mapping[str, Any]) -> dict[str, list[float]]:
    pairs, limits = instance["pairs"], instance["limits"]
    of_contacts = [pairs[c["pair"]]["restitution"] for c in instance["contacts"]]
    return {
        "mass_inverse": [value for b in instance["bodies"] for value in b["mass_inverse"]],
        "restitution": [
            *of_contacts,
            *(limit["restitution"] for limit in limits),
            *point_restitutions(instance),
        ],
        "pair_normal": [value for p in (*pairs, *limits) for value in p.get("normal") or (0.0, 0.0, 0.0)],
    }


def _input_ranges(tables: Tables, instance: Mapping[str, Any]) -> list[float]:
    """Least and largest value of each input; the largest number where there is no bound."""
    most = float(np.finfo(tables.dtype).max)
    ends = (end for each in instance["inputs"] for end in input_range(each))
    return [min(max(end, -most), most) for end in ends]


def _room(manifest: Manifest, many: int) -> int:
    """The bound on contacts closed at a time: all, `many`, in a small scene, 12 per moving body in a large
    one."""
    instance = manifest.instance
    moving = sum(body["motion"] in ("point", "free") for body in instance["bodies"])
    rows = max((kind.get("rows", 1) for kind in manifest.kinds["contact"]), default=1)
    return min(many, max(ROOM // rows, ROOM_PER_BODY * moving))


def _row_count(manifest: Manifest) -> int:
    """The number of rows of all joints, those of armature included."""
    kinds = [manifest.kinds["joint"][joint["kind"]] for joint in manifest.instance["joints"]]
    return sum(int(kind["rows"]) + int(kind.get("inertial_rows", 0)) for kind in kinds)


def settings_of(tables: Tables, accuracy: Accuracy, instance: Mapping[str, Any]) -> Any:
    """The mg_settings of an Accuracy for a scene, shared by the runs that ask for the same: the core reads
    them and never writes them.

    Patches are of event-driven runs whose contacts are all struck at once.
    """
    return _settings(tables, accuracy, any(_impact_laws(instance)))


@lru_cache(maxsize=64)
def _settings(tables: Tables, accuracy: Accuracy, has_impact_law: bool) -> Any:
    """Tolerances below the resolution of the real type are raised to it."""
    settings = tables.Settings()
    epsilon = float(np.finfo(tables.dtype).eps)
    for name in ("newton", "project", "fallback"):
        setattr(settings, name, int(getattr(accuracy, name)))
    for name in SETTINGS_COUNTS:
        setattr(settings, name, int(getattr(accuracy.thresholds, name)))
    for name in SETTINGS_REALS[1:]:
        value = getattr(accuracy, name) if name in OWN else getattr(accuracy.thresholds, name)
        setattr(settings, name, max(float(value), RESOLVED.get(name, 0) * epsilon))
    settings.method, settings.stepping_scheme = METHODS[accuracy.method], SCHEMES[accuracy.scheme]
    settings.stepping_friction_law = LAWS.get(accuracy.solver, 0)
    settings.sequential = int(accuracy.impacts == "sequential")
    settings.use_gamma = int(accuracy.use_gamma)
    at_once = not (settings.sequential or has_impact_law)
    settings.planar_contacts = int(
        accuracy.planar_contacts and accuracy.method != "time-stepping" and at_once
    )
    settings.step = accuracy.step or 0.0
    return settings
