"""Warnings about known weaknesses of a shape, given before a run meets them."""

from __future__ import annotations

from modelgen.scene.scene_types import Shape


def declared_limits(shape: Shape) -> tuple[str, ...]:
    """Warnings on curvatures of a superellipsoid that vanish or have no limit; nothing for other shapes.

    (|x/a|^p + |y/b|^p)^(q/p) + |z/c|^q = 1 has, near x = 0, a curvature along x like |x|^(p - 2); near
    z = 0 a curvature along z like |z|^(q - 2); at the ends of the z axis curvatures like s^(q - 2) with
    s = (|x/a|^p + |y/b|^p)^(1/p), times a factor that depends on the direction if p > 2.
    """
    if shape.kind != "superellipsoid":
        return ()
    p, q = (dict(shape.parameters)[name] for name in "pq")
    texts = []
    if p > 2:
        texts.append(f"p = {p:g}: the curvature along x vanishes where x = 0, that along y where y = 0")
    if q > 2:
        texts.append(f"q = {q:g}: the curvature along z vanishes where z = 0, both vanish at x = y = 0")
    if p > 2 and q == 2:
        texts.append(f"p = {p:g}, q = 2: the curvature has no limit at x = y = 0")
    rough = [f"{name} = {value:g}" for name, value in (("p", p), ("q", q)) if 2 < value < 3]
    if rough:
        texts.append(f"{', '.join(rough)}: the rate of change of these curvatures has no bound there")
    remedy = "a contact on flat places may lose its extremal pair"
    return tuple(f"shape {shape.name!r}: {text}; {remedy}" for text in texts)
