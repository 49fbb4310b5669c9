"""Bodies that fall, lie and roll: stacks and piles, mixed sizes, thin and spline shapes, tossed solids."""

from __future__ import annotations

from itertools import combinations
from typing import Any

import numpy as np

from tests.benchmarks.verdict_scenes.parts import (
    SOLIDS,
    TURN,
    Random,
    Table,
    Tables,
    body,
    contact,
    ground,
    number,
    row,
    scene,
    solid,
    turned,
    weighed,
)

SIZE = 0.1  # m


def stack_or_pile(random: Random) -> Tables:
    return _stack(random) if random.integers(2) else _pile(random)


def _stack(random: Random) -> Tables:
    """Two to five boxes, cylinders and discs of wood on each other, hardly off centre, at rest or dropped."""
    friction, restitution = random.uniform(0.2, 0.8), float(random.choice([0.0, 0.0, 0.2]))
    level, bodies, below = 0.0, [ground()], "floor"
    contacts: list[Table] = []
    drop = float(random.choice([0.0, 0.0, 1e-3]))
    for k in range(int(random.integers(2, 6))):
        kind = str(random.choice(["box", "box", "cylinder"]))
        shape = solid(random, kind, SIZE)
        height = shape["size"][2] if kind == "box" else shape["length"]
        level = number(level + drop)
        aside = 0.1 * SIZE * random.uniform(-1, 1, 2)
        where = [*aside, level + height / 2]
        bodies.append(body(f"b{k}", shape, where, rpy=[0.0, 0.0, number(random.uniform(-3, 3))]))
        bodies[-1]["position"][2] = level + height / 2
        level, contacts = level + height, [*contacts, contact(below, f"b{k}", friction, restitution)]
        below = f"b{k}"
    return scene(bodies, contacts, 0.5)


def _pile(random: Random) -> Tables:
    """Three to five solids that fall onto each other."""
    friction, restitution = random.uniform(0.2, 0.8), random.uniform(0, 0.4)
    bodies = [ground()]
    for k in range(int(random.integers(3, 6))):
        shape = solid(
            random, str(random.choice(["sphere", "box", "capsule", "ellipsoid", "cylinder"])), SIZE / 2
        )
        where = [*(0.3 * SIZE * random.uniform(-1, 1, 2)), (1.2 + 2.2 * k) * SIZE]
        bodies.append(body(f"b{k}", shape, where, quaternion=turned(random)))
    names = [each["name"] for each in bodies]
    return scene(bodies, [contact(a, b, friction, restitution) for a, b in combinations(names, 2)], 1.0)


def mixed(random: Random) -> Tables:
    """Two or three bodies whose sizes differ by up to 100 and whose masses by up to 1e6."""
    friction, restitution = random.uniform(0, 0.6), random.uniform(0, 0.6)
    bodies, level = [ground()], 0.0
    for k in range(int(random.integers(2, 4))):
        size, mass = 10 ** random.uniform(-2, 0), 10 ** random.uniform(-3, 3)
        shape = solid(random, str(random.choice(["sphere", "ellipsoid", "box", "cylinder"])), size)
        where = [*(0.2 * size * random.uniform(-1, 1, 2)), level + 2.2 * size]
        velocity = row([*random.uniform(-1, 1, 2), 0.0])
        bodies.append(
            weighed(f"b{k}", shape, where, mass, size, quaternion=turned(random), velocity=velocity)
        )
        level += 4.4 * size
    names = [each["name"] for each in bodies]
    return scene(bodies, [contact(a, b, friction, restitution) for a, b in combinations(names, 2)], 1.0)


def tossed(random: Random) -> Tables:
    """One solid of 12 kinds on a floor."""
    kind = SOLIDS[int(random.integers(len(SOLIDS)))]
    velocity, spin = random.normal(size=3), 5 * random.normal(size=3)
    each = weighed(
        "solid", solid(random, kind, SIZE), [0, 0, 4 * SIZE], 1.0, 0.7 * SIZE,
        quaternion=turned(random), velocity=row(velocity), angular_velocity=row(spin),
    )  # fmt: skip
    return scene([ground(), each], [contact("floor", "solid", 0.4, 0.3)], 2.0)


def thin_or_spline(random: Random) -> Tables:
    kinds = (_coin, _card, _on_field, _spline, _ring, _oval)
    return kinds[int(random.integers(len(kinds)))](random)


def _dropped(random: Random, shape: Table, **keys: Any) -> Table:
    return weighed(
        "thing", shape, [0, 0, 2.5 * SIZE], 0.2, 0.5 * SIZE, quaternion=turned(random),
        velocity=row(0.5 * random.normal(size=3)), angular_velocity=row(3 * random.normal(size=3)), **keys,
    )  # fmt: skip


def _coin(random: Random) -> Tables:
    """A thin cylinder or a disc without thickness."""
    shape: Table = {"kind": "disc", "radius": number(SIZE * random.uniform(0.3, 1))}
    if random.integers(2):
        shape |= {"kind": "cylinder", "length": number(SIZE * 10 ** random.uniform(-3, -1))}
    return scene(
        [ground(), _dropped(random, shape)], [contact("floor", "thing", random.uniform(0, 0.6), 0.2)], 1.0
    )


def _card(random: Random) -> Tables:
    """A thin box on an edge of a table, or a rod."""
    thin = number(SIZE * 10 ** random.uniform(-3, -1))
    size = [number(2 * SIZE * random.uniform(0.5, 1)), number(SIZE), thin]
    if random.integers(2):
        size = [size[0], thin, thin]
    table = {
        "name": "floor",
        "motion": "fixed",
        "shape": {"kind": "box", "size": [0.3, 0.3, 0.2]},
        "position": [0, 0, -0.1],
    }
    return scene(
        [table, _dropped(random, {"kind": "box", "size": size})],
        [contact("floor", "thing", random.uniform(0, 0.6), 0.1)],
        0.6,
    )


def _on_field(random: Random) -> Tables:
    """A ball, capsule or ellipsoid on a hilly height field."""
    grid = row(np.linspace(-0.6, 0.6, 7))
    heights = [row(0.03 * random.uniform(-1, 1, 7)) for _ in grid]
    field = {
        "name": "floor",
        "motion": "fixed",
        "shape": {"kind": "height_field", "x": grid, "y": grid, "heights": heights},
    }
    shape = solid(random, str(random.choice(["sphere", "capsule", "ellipsoid"])), SIZE)
    return scene(
        [field, _dropped(random, shape)], [contact("floor", "thing", random.uniform(0, 0.6), 0.1)], 0.6
    )


def _spline(random: Random) -> Tables:
    """A ring of a spline surface, on a floor."""
    tube, swing = number(random.uniform(0.02, 0.03)), number(random.uniform(0, 0.01))
    points = [
        [
            row(
                [
                    (0.07 + tube * np.cos(v)) * np.cos(u),
                    (0.07 + tube * np.cos(v)) * np.sin(u),
                    tube * np.sin(v) + swing * np.cos(2 * u),
                ]
            )
            for v in np.arange(6) * np.pi / 3
        ]
        for u in np.arange(8) * np.pi / 4
    ]
    shape = {"kind": "bspline", "points": points, "periodic": [True, True]}
    return scene(
        [ground(), _dropped(random, shape)], [contact("floor", "thing", random.uniform(0, 0.6), 0.1)], 0.8
    )


def _ring(random: Random) -> Tables:
    """A wire of a circle, an ellipse or a closed curve."""
    wires: list[Table] = [
        {"kind": "circle", "radius": number(SIZE * random.uniform(0.3, 1))},
        {"kind": "ellipse_curve", "semi_axes": row(SIZE * random.uniform(0.3, 1, 2))},
        {
            "kind": "curve", "x": f"{number(random.uniform(0.04, 0.08))} * cos(t)",
            "y": f"{number(random.uniform(0.04, 0.08))} * sin(t)",
            "z": f"{number(random.uniform(0, 0.02))} * cos(2 * t)",
            "domain": TURN, "periodic": True,
        },
    ]  # fmt: skip
    shape = wires[int(random.integers(len(wires)))]
    return scene(
        [ground(), _dropped(random, shape)], [contact("floor", "thing", random.uniform(0, 0.6), 0.1)], 1.0
    )


def _oval(random: Random) -> Tables:
    """A prism with a smooth outline."""
    a, b = row(SIZE * random.uniform(0.3, 0.9, 2))
    shape = {
        "kind": "extrusion",
        "length": number(SIZE),
        "x": f"{a} * cos(t)",
        "y": f"{b} * sin(t)",
        "domain": TURN,
    }
    return scene(
        [ground(), _dropped(random, shape)], [contact("floor", "thing", random.uniform(0, 0.6), 0.1)], 0.8
    )
