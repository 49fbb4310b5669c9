"""The table of a scene's kernels in C: sizes by kind, and one function a role that dispatches on the kind."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import casadi as ca

from modelgen.assembly import Q_SIZE, U_SIZE
from modelgen.assembly.shared_pair_content import eta_size
from modelgen.codegen.bounds_programs import programs_text
from modelgen.codegen.hidden_oscillations import may_oscillate
from modelgen.codegen.manifest import FEET, FLAT, SPINES, have_spines
from modelgen.codegen.manifest_model import J_SIZE
from modelgen.codegen.scene_step import scene_step_text
from modelgen.contact.form_table import eta_layout
from modelgen.derivation import Derivation, Formula
from modelgen.dynamics.sensors import need_rates
from modelgen.geometry.coordinate_domains import dimension_of
from modelgen.geometry.curves import may_bend
from modelgen.joint.joint_actuators import law_of
from modelgen.joint.joint_equations import FORMS
from modelgen.joint.joint_kernels import inertial_row_count, row_count
from modelgen.joint.joint_limits import is_turn
from modelgen.model import ContactKind, JointKind, LoadKind, Model
from modelgen.scene.sensors import sensor_sizes

HEAD = """#ifndef MG_HASH
#define MG_HASH ""
#endif

MG_API const char *mg_hash(void) { return MG_HASH; }
"""


@dataclass(frozen=True)
class Dispatcher:
    """One function of kernels.h: its name and arguments; the first of them are inputs of the kernel."""

    roles: tuple[str, ...]
    function: str
    inputs: tuple[str, ...]  # names as the kernels have them, or as ALIASES has them
    outputs: tuple[str, ...]
    optional: bool = False  # absent where no kernel has one of the roles


TURN = 6  # MG_TURN
KIND_GROUPS = ("body", "contact", "joint", "load", "shape")
PARAMETRISATIONS = {"none": 0, "point": 1, "chart": 2, "curve": 3, "signed_curve": 4, "sign": 5}  # MG_NONE ..

ALIASES = {"s": "uv", "x": "point", "n": "direction", "tangent": "direction"}  # of the kernels of shapes

DISPATCHERS = (
    Dispatcher(("pose",), "body_pose", ("q",), ("pose",)),
    Dispatcher(
        ("motion",), "body_motion", ("q", "u", "wrench", "gravity", "parameters"), ("qdot", "udot")
    ),
    Dispatcher(
        ("energy",), "body_energy", ("q", "u", "gravity", "parameters"),
        ("kinetic", "potential", "momentum", "spin"),
    ),
    Dispatcher(("path",), "body_path", ("t", "parameters", "inputs"), ("pose", "twist", "accel")),
    Dispatcher(
        ("wrench",), "load_wrench", ("t", "pose_a", "twist_a", "pose_b", "twist_b", "parameters", "inputs"),
        ("wrench_a", "wrench_b"),
    ),
    Dispatcher(
        ("branch",), "load_branch",
        ("t", "pose_a", "twist_a", "pose_b", "twist_b", "parameters", "inputs", "branch", "quaternion"),
        ("wrench_a", "wrench_b"),
    ),
    Dispatcher(
        ("switches",), "load_switches",
        ("t", "pose_a", "twist_a", "pose_b", "twist_b", "parameters", "inputs", "branch", "quaternion"),
        ("switching", "gradient", "input_gradient", "second_rate"),
    ),
    Dispatcher(
        ("deflection",), "load_deflection", ("pose_a", "pose_b", "parameters"), ("deflection", "J")
    ),
    Dispatcher(
        ("rates",), "contact_rates", ("pose_o", "twist_o", "pose_f", "twist_f", "eta", "parameters"),
        ("d", "J_o", "J_f", "gamma", "eta_dot", "normal", "tangents"),
    ),
    Dispatcher(
        ("place",), "contact_place", ("pose_o", "pose_f", "eta", "parameters"),
        ("eta_next", "d", "residual", "margin", "normal", "point_o", "point_f"),
    ),
    Dispatcher(
        ("rows",), "joint_rows", ("t", "pose_a", "twist_a", "pose_b", "twist_b", "parameters", "inputs"),
        ("value", "J", "gamma1", "bias"),
    ),
    Dispatcher(
        ("coordinates",), "joint_coordinates", ("pose_a", "pose_b", "parameters"), ("coordinate",)
    ),
    Dispatcher(
        ("surface", "curve", "point"), "shape_point", ("uv", "parameters"), ("point", "direction")
    ),
    Dispatcher(
        ("aim",), "contact_aim", ("pose_o", "pose_f", "eta", "parameters"), ("normal", "rounding")
    ),
    Dispatcher(
        ("sensors",), "sense",
        ("t", "pose", "twist", "accel", "pairs", "joints", "gravity", "parameters", "inputs"),
        ("sensors",),
    ),
    Dispatcher(
        ("seek",), "contact_seek", ("pose_o", "pose_f", "normal", "parameters"),
        ("d", "slope", "bend", "tangents", "eta"),
    ),
    Dispatcher(
        ("rhs",), "scene_rhs", ("t", "q", "u", "eta", "gravity", "parameters"),
        ("qdot", "udot", "eta_dot", "force"), optional=True,
    ),
)  # fmt: skip


def table_text(derivation: Derivation, internal: Mapping[str, str]) -> str:
    """The mg_kernels of a scene; `internal` maps a kernel's name to the static function that computes it."""
    parts = [HEAD, *_tables(derivation), programs_text(derivation.model.shape_kinds, _searched(derivation))]
    present = []
    for dispatcher in DISPATCHERS:
        formulas = [
            each for each in derivation.formulas if each.role in dispatcher.roles and each.name in internal
        ]
        if formulas or not dispatcher.optional:
            parts.append(_dispatcher(dispatcher, formulas, internal))
            present.append(dispatcher.function)
    fields = ["  .abi = MG_ABI,", "  .real_size = sizeof(mg_real),", "  .hash = MG_HASH,"]
    sensors = derivation.model.scene.sensors
    fields.append(f"  .n_sensor = {sum(size for _, size in sensor_sizes(sensors))},")
    fields.append(f"  .sensors_need_forces = {int(need_rates(sensors))},")
    fields += [f"  .{group}_kinds = mg_{group}_kinds," for group in KIND_GROUPS]
    fields.append("  .shape_bounds = mg_shape_bounds,")
    fields += [f"  .{function} = {function}," for function in present]
    if "scene_rhs" in present:
        parts.append(scene_step_text(derivation.function("mg_rhs"), internal["mg_rhs"]))
        fields.append("  .scene_step = scene_step,")
    fields.append("  .derivatives = MG_DERIVATIVES,")
    parts.append("\n".join(["static const mg_kernels mg_table = {", *fields, "};\n"]))
    parts.append("MG_API const mg_kernels *mg_kernel_table(void) { return &mg_table; }\n")
    return "\n".join(parts)


def _tables(derivation: Derivation) -> list[str]:
    model = derivation.model
    sizes = {
        (formula.role, formula.kind): int(formula.function.numel_in("parameters"))
        for formula in derivation.formulas
        if formula.role in ("motion", "wrench", "rates")
    }
    parameters_of_joints = {
        formula.kind: int(formula.function.numel_in("parameters"))
        for formula in derivation.formulas
        if formula.role == "rows"
    }
    switches = {
        formula.kind: int(formula.function.numel_in("branch"))
        for formula in derivation.formulas
        if formula.role == "switches"
    }
    seeking = {formula.kind for formula in derivation.formulas if formula.role == "seek"}
    bodies = [
        f"MG_{motion.upper()}, {Q_SIZE[motion]}, {U_SIZE[motion]}, {sizes.get(('motion', index), 12)}"
        for index, motion in enumerate(kind.motion for kind in model.body_kinds)
    ]
    contacts = [
        _row(
            *_contact_sizes(kind),
            sizes["rates", index],
            *_parametrisations(kind),
            int(index in seeking),
            kind.rows,
        )
        for index, kind in enumerate(model.contact_kinds)
    ]
    contacts += [
        _row(6, 6, turn, sizes["rates", index], TURN if turn else 0, 0, 0, 1)
        for index, turn in enumerate(_limit_turns(model), start=len(model.contact_kinds))
    ]
    contact_names = [kind.name for kind in model.contact_kinds] + [kind.name for kind in model.limit_kinds]
    shapes = [
        _row(
            dimension_of(kind),
            FEET.get(kind.kind, 0),
            int(may_bend(kind)),
            SPINES.get(kind.kind, 0),
            (-1 if kind.cavity else 1) if kind.kind in FLAT else 0,
        )
        for kind in model.shape_kinds
    ]
    joints = [
        _joint_sizes(kind, parameters_of_joints.get(index, 0)) for index, kind in enumerate(model.joint_kinds)
    ]
    loads = [
        _row(
            sizes["wrench", formula.kind],
            *_hidden(formula.function, model.load_kinds[formula.kind]),
            int(model.load_kinds[formula.kind].is_spring),
            switches.get(formula.kind, 0),
        )
        for formula in derivation.formulas
        if formula.role == "wrench"
    ]
    return [
        _table("mg_body_kind", bodies, [kind.name for kind in model.body_kinds], "0, 0, 0, 0, 0"),
        _table("mg_contact_kind", contacts, contact_names, _row(*[0] * 8)),
        _table("mg_joint_kind", joints, [kind.name for kind in model.joint_kinds], _row(*[0] * 5)),
        _table("mg_load_kind", loads, [kind.name for kind in model.load_kinds], _row(*[0] * 5)),
        _table("mg_shape_kind", shapes, [kind.name for kind in model.shape_kinds], "0, 0, 0, 0"),
    ]


def _searched(derivation: Derivation) -> list[bool]:
    """Whether closest points of each kind of shape are searched by cells: in a kind of contact that has
    parameters, and neither a separation function nor two spines."""
    model = derivation.model
    convex = {formula.kind for formula in derivation.formulas if formula.role == "seek"}
    shapes = {
        side.shape
        for index, kind in enumerate(model.contact_kinds)
        if index not in convex and eta_size(kind) and not have_spines((kind.o.shape.kind, kind.f.shape.kind))
        for side in (kind.o, kind.f)
    }
    return [kind in shapes for kind in model.shape_kinds]


def _hidden(wrench: ca.Function, kind: LoadKind) -> tuple[int, int]:
    """Whether a load may oscillate between samples of a step with time, and with the state of its bodies;
    springs do not."""
    if kind.kind == "actuator":
        law = law_of(kind)
        return int(may_oscillate(law, "t")), int(may_oscillate(law, "state"))
    given = kind.kind in ("force", "torque")
    return int(may_oscillate(wrench, "t")), int(given and may_oscillate(wrench, "pose_a", "twist_a"))


def _limit_turns(model: Model) -> list[int]:
    """Whether each kind of limit bounds an angle, which then is its eta."""
    return [int(is_turn(kind.kind)) for kind in model.limit_kinds]


def _joint_sizes(kind: JointKind, parameters: int) -> str:
    """Number of rows and of coordinates of a kind of joint, whether its rows depend on time, numbers of their
    parameters and of rows of armature."""
    moved, coordinates = int(kind.motion is not None), len(FORMS[kind.kind].coordinates)
    return _row(row_count(kind), coordinates, moved, parameters, inertial_row_count(kind))


def _row(*numbers: int) -> str:
    return ", ".join(map(str, numbers))


def _contact_sizes(kind: ContactKind) -> tuple[int, int, int]:
    return J_SIZE[kind.o.motion], J_SIZE[kind.f.motion], eta_size(kind)


def _parametrisations(kind: ContactKind) -> tuple[int, int]:
    layout_o, layout_f = eta_layout(kind)
    return PARAMETRISATIONS[layout_o], PARAMETRISATIONS[layout_f]


def _table(struct: str, rows: list[str], names: list[str], empty: str) -> str:
    lines = [f"  {{{row}}}, /* {name} */" for row, name in zip(rows, names, strict=True)]
    body = "\n".join(lines or [f"  {{{empty}}}, /* none */"])
    return f"static const {struct} {struct}s[] = {{\n{body}\n}};\n"


def _dispatcher(dispatcher: Dispatcher, formulas: list[Formula], internal: Mapping[str, str]) -> str:
    arguments = ["int kind", *(f"const mg_real *{name}" for name in dispatcher.inputs)]
    arguments += [f"mg_real *{name}" for name in dispatcher.outputs]
    cases = [line for formula in formulas for line in _case(formula, internal[formula.name])]
    used = {name for formula in formulas for name in _given(formula) + _wanted(formula)}
    unused = [name for name in (*dispatcher.inputs, *dispatcher.outputs) if name not in used]
    lines = [f"static void {dispatcher.function}({', '.join(arguments)}) {{"]
    lines += [f"  (void){name};" for name in unused]
    lines += [
        "  switch (kind) {",
        *cases,
        "    default: /* no kind of this scene */",
        "      break;",
        "  }",
    ]
    return "\n".join([*lines, "}"]) + "\n"


def _given(formula: Formula) -> list[str]:
    function = formula.function
    return [ALIASES.get(name, name) if function.numel_in(name) else "0" for name in function.name_in()]


def _wanted(formula: Formula) -> list[str]:
    function = formula.function
    return [ALIASES.get(name, name) if function.numel_out(name) else "0" for name in function.name_out()]


def _case(formula: Formula, internal: str) -> list[str]:
    given, wanted = _given(formula), _wanted(formula)
    return [
        f"    case {formula.kind}: {{ /* {formula.name} */",
        f"      const mg_real *arg[] = {{{', '.join(given)}}};",
        f"      mg_real *res[] = {{{', '.join(wanted)}}};",
        f"      {internal}(arg, res, 0, 0, 0);",
        "      break;",
        "    }",
    ]
