"""The one dictionary of names: what each argument and result of a generated function means.

The paper's letters collide (R: rotation, reflection R_psi, radius; T: torsion, tangent; N: normal, principal
normal; l: lever, arc length), so each name here stands for one thing. Equations: (n.m), Theorem, Lemma and
Corollary of Anitescu, Cremer and Potra, Formulating 3D contact dynamics problems, with the corrections that
the docstrings name.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass

ETA_SIZE: Mapping[str, int] = {  # entries of eta, by what carries the point of one side in it
    "none": 0, "chart": 2, "point": 3, "curve": 1, "signed_curve": 3, "sign": 1
}  # fmt: skip
SETTING_SIZE = 3  # numbers of the setting of an input: value; rate, 1/s; time at which it has that value, s
LETTERS = {3: "xyz", 4: "wxyz"}  # of the components of a sensor


def component_names(slots: Iterable[tuple[str, int]]) -> tuple[str, ...]:
    """The names of all components of sensors with names and sizes: `lean`, `tip_x`, `turn_w`."""
    return tuple(
        name + (f"_{letter}" if letter else "") for name, size in slots for letter in LETTERS.get(size, ("",))
    )


@dataclass(frozen=True, slots=True)
class Notation:
    """One name: its symbol in the paper, meaning, unit (entries in order), shape, frame and equation."""

    name: str
    symbol: str
    meaning: str
    unit: str
    shape: str
    frame: str = ""
    equation: str = ""


_ETA = (
    "point of a surface: 3, chart: 2, curve: 1, plane, centre or no eta: 0, o first; two curves: and two "
    "signs; two straight edges: one sign"
)
_ROW = "6, 3 or 0 a row"
_SIDES = (("o", "o"), ("f", "f"))

_STEPS = (  # what the rates of a contact are made of; shown by inspection, outputs of no kernel
    Notation("t1", "t_1", "first tangent of the frame that both surfaces share", "1", "3", "world"),
    Notation("t2", "t_2", "second tangent of that frame", "1", "3", "world"),
    Notation("A", "A", "K_f + K_o + d K_o K_f, regular where the contact is", "1/m", "2x2",
             "tangent", "(4.1)"),
    Notation("turn", "w^t", "turning of f past o about the tangents, (w_f - w_o) x N", "rad/s", "2",
             "tangent"),
    Notation("V", "V", "velocity of the point of f seen from o", "m/s", "2 or 3", "tangent; spheres: world"),
    Notation("w", "w", "angular velocity of f seen from o, in the contact frame of f", "rad/s", "3",
             "contact frame of f", "Appendix E"),
    Notation("nu", "\\nu", "rate of the normal seen from o", "rad/s", "2", "tangent", "(B.5)"),
    Notation("m", "m", "rate of the normal seen from f, (w_f - w_o) x N", "rad/s", "3", "shape f"),
    Notation("tilt", "", "rate of the normal along the tangents", "rad/s", "2", "tangent"),
    Notation("sigma", "\\sigma", "rate of the tangents about N", "rad/s", "1"),
    Notation("slip", "V^t", "velocity of the material point of f past that of o along the tangents", "m/s",
             "2", "tangent"),
    Notation("spin_past", "\\omega_n", "spin of f past o about N", "rad/s", "1"),
    Notation("rolling", "\\omega^t", "angular velocity of f past o about the tangents", "rad/s", "2",
             "tangent"),
    Notation("n_f", "n_f", "exterior normal of f at its support point", "1", "3", "shape f"),
    Notation("distance", "", "signed distance of the centres", "m", "1"),
    Notation("e", "e", "derivative of the curve in the tangent plane", "m per parameter", "2", "tangent"),
    Notation("beta", "\\beta", "second derivative of the curve along N", "m per parameter^2", "1", "",
             "Theorem 4.6"),
    Notation("h", "h", "of a centre over its surface or beside its curve, d + rho", "m", "1"),
    Notation("l", "l", "from a centre of mass to the partner's centre, or to the point of a curve beside one",
             "m", "3", "shape; of a curve: world"),
    Notation("K", "K", "curvature form of the surface under a centre, positive if convex", "1/m", "2x2",
             "tangent"),
    Notation("E", "E", "derivative of the curve beside a centre by its parameter", "m per parameter", "3",
             "world"),
    Notation("slide", "s", "velocity of the contact point over the surface or curve by a centre", "m/s",
             "2 or 3", "tangent; of a curve: world", "(4.1), (4.26)"),
    Notation("g", "g", "residual of extremality", "m^2, m", "3 or 2"),
    Notation("metric", "I_o", "first fundamental form of o", "m^2", "2x2", "chart of o"),
    Notation("X", "X", "products of the tangents, E_o^T E_f", "m^2", "2x2", "charts"),
    Notation("R_psi", "R_\\psi", "reflection that takes the tangents of f to those of o", "1", "2x2", "",
             "Theorem 4.1"),
    *(entry for side, partner in _SIDES for entry in (
        Notation(f"l_{side}", "l", f"from the centre of mass of {partner} to the contact point", "m", "3",
                 f"shape {partner}"),
        Notation(f"K_{side}", "K", f"curvature form of {partner}, positive if convex", "1/m", "2x2",
                 "tangent"),
        Notation(f"E_{side}", "E", f"derivative of the curve of {partner} by its parameter",
                 "m per parameter", "3", "world"),
        Notation(f"M_{side}", "M", f"metric form of {partner}, [c_u c_v] = [x y] M", "m", "2x2", "tangent"),
        Notation(f"B_{side}", "B", f"second fundamental form of {partner}, positive if convex", "m", "2x2",
                 f"chart of {partner}"),
        Notation(f"velocity_{side}", "V", f"velocity of the material point of {partner}", "m/s", "3",
                 "world"),
        Notation(f"slide_{side}", "s", f"velocity of the contact point over {partner}", "m/s", "2 or 3",
                 "tangent or world", "(4.1), (4.2)"),
        Notation(f"g_{side}", "g", f"residual of extremality of {partner}", "m^2 (o), m (f)", "2"),
    )),
)  # fmt: skip

_TABLE = (
    Notation("t", "t", "time", "s", "1"),
    Notation("q", "q", "position coordinates: p, then quaternion (w, x, y, z)", "m, 1", "7 or 3", "world"),
    Notation("u", "v", "velocity of the centre of mass, then angular velocity", "m/s, rad/s", "6 or 3",
             "world, then body axes"),
    Notation("qdot", "\\dot q", "rate of q", "m/s, 1/s", "7 or 3", "world"),
    Notation("udot", "\\dot v", "rate of u", "m/s^2, rad/s^2", "6 or 3", "world, then body axes", "(2.6)"),
    Notation("pose", "(p, R)", "centre of mass, then rotation body -> world, column by column", "m, 1",
             "12", "world"),
    Notation("twist", "(\\dot p, \\omega)", "velocity of the centre of mass, then angular velocity",
             "m/s, rad/s",
             "6", "world, then body axes"),
    Notation("accel", "(\\ddot p, \\dot\\omega)", "rate of the twist", "m/s^2, rad/s^2", "6",
             "world, then body axes"),
    Notation("wrench", "F", "force, then torque about the centre of mass", "N, N m", "6 or 3",
             "world, then body axes", "(2.6)"),
    Notation("gravity", "g", "acceleration of gravity", "m/s^2", "3", "world"),
    Notation("parameters", "",
             "lengths, masses and placements of the kind, as its shapes and bodies list them",
             "SI", "by kind"),
    Notation("inputs", "", "of each input of the scene: value, rate, and the time of its setting",
             "as the scene says, per s, s", "3 an input"),
    Notation("branch", "", "of a load: the side on which each of its switching functions is, 1, -1 or 0", "1",
             "switches"),
    Notation("quaternion", "", "of the body of a load, with the sign that its state has", "1", "4"),
    Notation("switching", "", "switching functions of a load, which are zero where it jumps or has a kink",
             "as its expressions", "switches"),
    Notation("gradient", "", "derivatives of switching functions by t, poses, twists and parameters",
             "as its expressions", "by kind"),
    Notation("input_gradient", "", "derivatives of switching functions by the settings of inputs",
             "as its expressions", "3 an input"),
    Notation("second_rate", "",
             "of each switching function of t and poses alone: 1, second rate without accelerations; else 0",
             "as its expressions", "2 a switch"),
    Notation("pairs", "", "of each pair that may touch: least gap, sum of the normal forces", "m, N",
             "2 a pair"),
    Notation("joints", "", "wrench of each joint on its second body", "N, N m", "6 a joint",
             "world, then body axes"),
    Notation("sensors", "", "what the sensors of the scene show, in order", "SI", "by scene"),
    Notation("kinetic", "T", "kinetic energy", "J", "1"),
    Notation("potential", "U", "potential energy of gravity", "J", "1"),
    Notation("momentum", "", "linear momentum", "kg m/s", "3", "world"),
    Notation("spin", "", "angular momentum about the world origin", "kg m^2/s", "3", "world"),
    Notation("uv", "\\alpha", "chart coordinates of a surface", "as its chart", "2"),
    Notation("x", "c(\\alpha)", "point of a surface", "m", "3", "shape", "Section 2"),
    Notation("s", "t", "parameter of a curve", "as its curve", "1"),
    Notation("tangent", "c'", "derivative of a curve by its parameter", "m per parameter", "3", "shape"),
    Notation("n", "z", "exterior unit normal of a surface", "1", "3", "shape", "Section 2"),
    Notation("eta", "\\eta", "contact points as their surfaces carry them", "m or as the charts",
             _ETA, "shape",
             "(2.1), corrected"),
    Notation("eta_dot", "\\dot\\eta", "rate of eta on extremal pairs", "unit of eta per s", _ETA, "shape",
             "Theorem 4.1 (4.1), (4.2)"),
    Notation("eta_next", "\\eta", "eta after one Newton step of the extremality system",
             "m or as the charts",
             _ETA, "shape", "(2.1), corrected"),
    Notation("value", "\\Theta", "what a joint keeps at zero, angles times the characteristic length", "m",
             "rows", "", "(2.3)"),
    Notation("J", "\\Psi", "rows of the rate of a joint, each by body a then b", "1, m", "12 a row",
             "world, then body axes", "(2.6)"),
    Notation("gamma1", "\\Gamma_1", "second derivative of a joint's rows without accelerations", "m/s^2",
             "rows", "", "(2.6)"),
    Notation("bias", "", "rate of a joint's rows that its given motion makes", "m/s", "rows"),
    Notation("deflection", "s", "of a spring: length or coordinate less that at rest", "m or rad", "1"),
    Notation("coordinate", "", "angles, within half a turn, and displacements of a joint", "rad or m",
             "by kind"),
    Notation("d", "d", "gap N.(P_f - P_o): positive apart, zero touching, negative overlapping", "m",
             "1", "",
             "(3.1), (3.2)"),
    Notation("gamma", "\\Gamma_2", "second derivative of d, then rate of slip and of w_f - w_o, without "
             "accelerations", "m/s^2", "1, 3 or 6", "",
             "Corollary 3.2 (3.11), corrected"),
    Notation("normal", "N", "unit normal from o to f", "1", "3", "world", "(3.1)"),
    Notation("normal_rate", "\\dot N", "rate of the normal", "1/s", "3", "world", "Lemma 4.2 (4.5)"),
    Notation("residual", "g", "points along and off their surfaces; parallelism of the normals", "m, 1",
             "2"),
    Notation("margin", "(\\mu, \\sigma)",
             "mu = sigma_min(A)/(|K_f| + |K_o| + |d||K_f||K_o|), and sigma_min(A); of curves from S and D",
             "1, 1/m", "2", "", "Section 4.1.1"),
    Notation("rounding", "\\rho", "smallest radii of curvature, o's plus f's", "m", "1"),
    Notation("slope", "", "derivative of the separation function, T^T (P_f - P_o)", "m", "2", "tangent"),
    Notation("bend", "", "minus its second derivative: radii of curvature R_o + R_f + d I as 11, 12, 22", "m",
             "3", "tangent"),
    Notation("tangents", "T", "t1, t2 of a normal", "1", "6", "world"),
    Notation("psi", "\\psi", "angle from the first tangent of f to that of o", "rad", "1", "",
             "Theorem 4.1"),
    Notation("psi_dot", "\\dot\\psi", "rate of psi", "rad/s", "1", "", "Theorem 4.1 (4.3)"),
    *(Notation(f"phi_{side}", "\\phi", f"angle from the Frenet to the contact frame of {partner}", "rad", "1",
               "", "Section 4.2") for side, partner in _SIDES),
    *(Notation(f"phi_{side}_dot", "\\dot\\phi", f"rate of phi of {partner}", "rad/s", "1", "",
               "(4.11), (4.27)") for side, partner in _SIDES),
    Notation("force", "\\lambda", "normal contact force, positive when pushing", "N", "1", "", "(2.6)"),
    *_STEPS,
    *(Notation(f"J_{side}", "J", f"row of d_dot = J u for body {body}, then of slip, spin and rolling",
               "1, m", _ROW, "world, then body axes", "Lemma 3.1 (3.3)") for side, body in _SIDES),
    *(Notation(f"point_{side}", "P", f"contact point of body {body}", "m", "3", "world", "(2.1)")
      for side, body in _SIDES),
)  # fmt: skip

_COPIES = {
    f"{name}_{side}": name for name in ("pose", "twist", "wrench") for side in ("o", "f", "a", "b")
}  # the same quantity of one of two bodies

NAMES: Mapping[str, Notation] = {entry.name: entry for entry in _TABLE}


_TURNING_ROWS = {("gamma", 6): "m/s^2, rad/s^2"}  # units of what is longer where a contact rolls and spins


def unit_of(name: str, size: int) -> str:
    """The unit of a quantity with that many entries; KeyError for an unknown name."""
    return _TURNING_ROWS.get((name, size), notation(name).unit)


def notation(name: str) -> Notation:
    """The entry of a name; `pose_o` and the like have that of `pose`. KeyError for an unknown one."""
    return NAMES[_COPIES.get(name, name)]
