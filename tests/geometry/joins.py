"""One contact told on two pieces of the same surface or curve: what a change from one to the other keeps."""

from __future__ import annotations

from functools import cache

import casadi as ca
import numpy as np

from modelgen.contact.form_table import FORMS, contact_kernels, eta_layout
from modelgen.geometry.curves import curve_of, is_curve
from modelgen.geometry.frames import cross
from modelgen.geometry.shape_features import features_of
from modelgen.geometry.surface_catalogue import surface_of
from modelgen.model import ContactKind, ShapeKind, Side
from modelgen.scene.scene_types import Feature, Shape
from tests.laws.configurations import Array, columns, pose_of, rotation_taking, turned

EGG = (0.5, 0.35, 0.3)
EGG_KIND = ShapeKind("ellipsoid", "ellipsoid", ("a", "b", "c"))
COUNT = 20


def features(shape: Shape) -> dict[str, Feature]:
    return {feature.name: feature for feature in features_of(shape).features}


def kind_of(shape: Shape) -> ShapeKind:
    names = tuple(name for name, _ in shape.parameters)
    return ShapeKind("piece", shape.kind, names, shape.cavity, shape.chart, shape.curve)


def numbers_of(shape: Shape) -> Array:
    return np.array([value for _, value in shape.parameters])


def jets(shape: Shape, at: Array) -> tuple[Array, Array, Array]:
    """Points (n,3), first (n,3,2) and second derivatives (n,3,3) at coordinates (2,n); of curves (n,3,1)."""
    n = at.shape[1]
    x, first, second = columns(_jet(kind_of(shape)), at, np.tile(numbers_of(shape)[:, None], (1, n)))
    return x.T, *(each.reshape(3, n, -1).transpose(1, 0, 2) for each in (first, second))


def curvatures(shape: Shape, at: Array) -> tuple[Array, Array, Array]:
    """Normals (n,3), mean (n,) and Gauss curvature (n,), positive if convex, at coordinates (2,n)."""
    numbers = np.tile(numbers_of(shape)[:, None], (1, at.shape[1]))
    n, mean, gauss = columns(_curvatures(kind_of(shape)), at, numbers)
    return n.T, mean[0], gauss[0]


@cache
def _jet(kind: ShapeKind) -> ca.Function:
    curve = is_curve(kind)
    eta, p = ca.SX.sym("eta", 1 if curve else 2), ca.SX.sym("p", len(kind.parameter_names))
    jet = curve_of(kind).jet(eta, p) if curve else surface_of(kind).jet(eta, p)
    return ca.Function("jet", [eta, p], [ca.densify(each) for each in (jet.x, jet.first, jet.second)])


@cache
def _curvatures(kind: ShapeKind) -> ca.Function:
    uv, p = ca.SX.sym("uv", 2), ca.SX.sym("p", len(kind.parameter_names))
    jet = surface_of(kind).jet(uv, p)
    area = cross(jet.first[:, 0], jet.first[:, 1])
    normal = area / ca.norm_2(area)
    B = -ca.mtimes(normal.T, jet.second)
    S = ca.solve(jet.first.T @ jet.first, ca.blockcat([[B[0], B[1]], [B[1], B[2]]]))
    return ca.Function("curvatures", [uv, p], [normal, ca.trace(S) / 2, ca.det(S)])


def change(one: tuple[Shape, Array], other: tuple[Shape, Array], form: str, seed: int) -> float:
    """The largest relative difference of d, N, J_o, J_f, gamma and o's eta rate on two pieces.

    The ellipsoid o touches the first piece, at random, with gaps to either side.
    """
    (shape, eta), random = one, np.random.default_rng(seed)
    n = eta.shape[1]
    (x_o, n_o, alpha), (x_f, n_f) = _egg(random, n), _point(shape, eta, random)
    start, end = (axis / np.linalg.norm(axis, axis=0) for axis in random.normal(size=(2, 3, n)))
    R_o = rotation_taking(start, end, random.uniform(-3, 3, n))
    N = turned(R_o, n_o)
    R_f = rotation_taking(n_f, -N, random.uniform(-3, 3, n))
    p_o = random.normal(size=(3, n))
    p_f = p_o + turned(R_o, x_o) + random.uniform(-0.02, 0.1, n) * N - turned(R_f, x_f)
    poses, twists = (pose_of(p_o, R_o), pose_of(p_f, R_f)), random.normal(size=(2, 6, n))
    found = []
    for piece, at in (one, other):
        kind = ContactKind("join", form, Side(EGG_KIND, "free"), Side(kind_of(piece), "free"))
        o, f = eta_layout(kind)
        carried = {"point": x_o, "chart": alpha}[o], {"point": x_f, "chart": at, "curve": at}[f]
        numbers = np.tile(np.concatenate([EGG, numbers_of(piece)])[:, None], (1, n))
        arguments = (poses[0], twists[0], poses[1], twists[1], np.concatenate(carried), numbers)
        rates = columns(contact_kernels(kind).rates, *arguments)
        margin = columns(contact_kernels(kind).place, *poses, np.concatenate(carried), numbers)[3][0]
        found.append([*rates[:4], rates[4][: len(carried[0])], rates[5]])
    fine = np.abs(margin) > 0.05
    assert fine.sum() > n / 3
    return max(
        float((np.linalg.norm(a - b, axis=0) / np.maximum(1, np.linalg.norm(b, axis=0)))[fine].max())
        for a, b in zip(*found, strict=True)
    )


def forms_of(shape: Shape) -> list[str]:
    """The forms in which an ellipsoid meets the shape, those of the paper and by differentiation left out."""
    kind = kind_of(shape)
    wanted = ("implicit", "mixed", "block", "curve_implicit", "curve_block")
    return [name for name in wanted if FORMS[name].applies(EGG_KIND, kind)]


def _egg(random: np.random.Generator, n: int) -> tuple[Array, Array, Array]:
    alpha = random.uniform([[-3.0], [-1.2]], [[3.0], [1.2]], (2, n))
    shape = Shape("ellipsoid", tuple(zip("abc", EGG, strict=True)))
    return jets(shape, alpha)[0].T, curvatures(shape, alpha)[0].T, alpha


def _point(shape: Shape, eta: Array, random: np.random.Generator) -> tuple[Array, Array]:
    """Points and normals (3,n) at eta; for a curve any normal perpendicular to it."""
    x, first, _ = jets(shape, eta)
    if not is_curve(shape):
        return x.T, curvatures(shape, eta)[0].T
    normal = np.cross(first[:, :, 0], random.normal(size=(len(x), 3)))
    return x.T, (normal / np.linalg.norm(normal, axis=1, keepdims=True)).T
