"""Pairs of shapes of the catalogue with the same shapes as plain expressions, for the brute force search."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache

import casadi as ca
import numpy as np
from scipy.spatial.transform import Rotation

from modelgen.codegen.library import Library
from modelgen.scene import python_scenes as make
from modelgen.scene.scene_types import Shape
from tests.laws.exhaustive_minima import Array, Parametrised
from tests.running import library_of

TURN = 2 * np.pi
ROUND = ((0.0, np.pi), (0.0, TURN))
EACH_TURN = ((0.0, TURN), (0.0, TURN))
WAVY = "(1 + 0.18*cos(3*u)*cos(2*v) + 0.1*sin(u + v))"
KNOT = ("(2 + cos(3*t))*cos(2*t)*0.4", "(2 + cos(3*t))*sin(2*t)*0.4", "0.4*sin(3*t)")


def _waist(t: ca.SX, turn: ca.SX) -> tuple[ca.SX, ...]:
    r = ca.sin(t) * (1.2 + 0.5 * ca.cos(2 * t))
    return r * ca.cos(turn), r * ca.sin(turn), -1.2 * ca.cos(t)


def _pear(t: ca.SX, turn: ca.SX) -> tuple[ca.SX, ...]:
    r = ca.sin(t) * (0.8 + 0.3 * ca.cos(3 * t))
    return r * ca.cos(turn), r * ca.sin(turn), -ca.cos(t)


def _wavy(u: ca.SX, v: ca.SX) -> tuple[ca.SX, ...]:
    tube = 0.35 * (1 + 0.18 * ca.cos(3 * u) * ca.cos(2 * v) + 0.1 * ca.sin(u + v))
    return (1 + tube * ca.cos(v)) * ca.cos(u), (1 + tube * ca.cos(v)) * ca.sin(u), tube * ca.sin(v)


def _torus(u: ca.SX, v: ca.SX) -> tuple[ca.SX, ...]:
    return (1 + 0.3 * ca.cos(v)) * ca.cos(u), (1 + 0.3 * ca.cos(v)) * ca.sin(u), 0.3 * ca.sin(v)


def _duct(u: ca.SX, v: ca.SX) -> tuple[ca.SX, ...]:
    return (3 + 1.6 * ca.cos(v)) * ca.cos(u), (3 + 1.6 * ca.cos(v)) * ca.sin(u), 1.6 * ca.sin(v)


def _ellipsoid(a: float, b: float, c: float, outward: float = 1.0) -> Parametrised:
    def at(t: ca.SX, turn: ca.SX) -> tuple[ca.SX, ...]:
        return a * ca.sin(t) * ca.cos(turn), b * ca.sin(t) * ca.sin(turn), c * ca.cos(t)

    return Parametrised(f"ellipsoid {a} {b} {c}", at, ROUND, (False, True), outward)


def _knot(t: ca.SX) -> tuple[ca.SX, ...]:
    return (
        (2 + ca.cos(3 * t)) * ca.cos(2 * t) * 0.4,
        (2 + ca.cos(3 * t)) * ca.sin(2 * t) * 0.4,
        0.4 * ca.sin(3 * t),
    )


def _round(radius: float, outward: float) -> Parametrised:
    """A cylinder up to 200 m from its middle: axes that are almost parallel come nearest far away."""

    def at(turn: ca.SX, along: ca.SX) -> tuple[ca.SX, ...]:
        return radius * ca.cos(turn), radius * ca.sin(turn), ca.sinh(along)

    return Parametrised(f"cylinder {radius}", at, ((0.0, TURN), (-6.0, 6.0)), (True, False), outward)


def _ring(t: ca.SX) -> tuple[ca.SX, ...]:
    return 0.8 * ca.cos(t), 0.8 * ca.sin(t), 0 * t


def _ellipse(t: ca.SX) -> tuple[ca.SX, ...]:
    return ca.cos(t), 0.5 * ca.sin(t), 0 * t


@dataclass(frozen=True)
class Side:
    """One shape, as the scene format and as the brute force search take it."""

    shape: Shape
    plain: Parametrised


@cache
def sides() -> dict[str, Side]:
    """The shapes by name."""
    waist, pear = ("sin(t)*(1.2 + 0.5*cos(2*t))", "-1.2*cos(t)"), ("sin(t)*(0.8 + 0.3*cos(3*t))", "-cos(t)")
    curve = ((0.0, TURN),)
    return {
        "torus": Side(make.torus(1.0, 0.3), Parametrised("torus", _torus, EACH_TURN, (True, True))),
        "wavy": Side(
            make.chart(
                f"(1 + 0.35*{WAVY}*cos(v))*cos(u)", f"(1 + 0.35*{WAVY}*cos(v))*sin(u)", f"0.35*{WAVY}*sin(v)",
                domain=[[0.0, TURN], [0.0, TURN]], periodic=[True, True],
            ),
            Parametrised("wavy", _wavy, EACH_TURN, (True, True)),
        ),
        "waist": Side(
            make.revolution(*waist, domain=[0.0, float(np.pi)]),
            Parametrised("waist", _waist, ROUND, (False, True), -1.0),
        ),
        "pear": Side(
            make.revolution(*pear, domain=[0.0, float(np.pi)]),
            Parametrised("pear", _pear, ROUND, (False, True), -1.0),
        ),
        "egg": Side(make.ellipsoid(1.0, 0.7, 0.4), _ellipsoid(1.0, 0.7, 0.4)),
        "hollow": Side(make.ellipsoid(3.0, 2.4, 2.0, cavity=True), _ellipsoid(3.0, 2.4, 2.0, -1.0)),
        "knot": Side(make.curve(*KNOT, domain=[0.0, TURN]), Parametrised("knot", _knot, curve, (True,), 0.0)),
        "rod": Side(make.cylinder(0.4), _round(0.4, 1.0)),
        "bore": Side(make.cylinder(1.6, cavity=True), _round(1.6, -1.0)),
        "duct": Side(
            make.torus(3.0, 1.6, cavity=True), Parametrised("duct", _duct, EACH_TURN, (True, True), -1.0)
        ),
        "ring": Side(make.circle(0.8), Parametrised("ring", _ring, curve, (True,), 0.0)),
        "ellipse": Side(make.ellipse_curve(1.0, 0.5), Parametrised("ellipse", _ellipse, curve, (True,), 0.0)),
    }  # fmt: skip


PAIRS = (
    ("torus", "torus"), ("wavy", "egg"), ("wavy", "wavy"), ("waist", "torus"), ("waist", "pear"),
    ("pear", "egg"), ("hollow", "egg"), ("hollow", "wavy"), ("hollow", "waist"), ("torus", "knot"),
    ("wavy", "knot"), ("waist", "ellipse"), ("knot", "ellipse"), ("torus", "rod"), ("rod", "rod"),
    ("bore", "torus"), ("bore", "ring"), ("rod", "ring"), ("bore", "egg"), ("torus", "egg"),
    ("torus", "ring"), ("hollow", "torus"), ("wavy", "rod"), ("bore", "waist"), ("duct", "egg"),
    ("duct", "torus"), ("duct", "waist"), ("duct", "knot"), ("duct", "rod"), ("duct", "ring"),
    ("ring", "ring"),
)  # fmt: skip


@cache
def library(o: str, f: str) -> Library:
    """The library of two bodies with these shapes, named a and b, whose centres of mass are their origins."""
    bodies = [
        make.dynamic(name, sides()[key].shape, mass=1.0, inertia=[1.0, 1.0, 1.0])
        for name, key in (("a", o), ("b", f))
    ]
    return library_of(make.scene("pair", bodies, contact=[{"between": ["a", "b"]}]))


def random_pose(o: str, rng: np.random.Generator) -> Array:
    """A pose of the second body in the axes of the first."""
    spread = {"hollow": 0.5, "bore": 0.3, "duct": 0.3}.get(o, 1.2)
    middle = [3.0, 0.0, 0.0] if o == "duct" else [0.0, 0.0, 0.0]
    rotation = Rotation.random(random_state=rng.integers(2**31)).as_matrix()
    return np.append(middle + spread * rng.normal(size=3), rotation.ravel(order="F"))
