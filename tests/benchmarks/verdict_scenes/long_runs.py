"""Runs over many turns, swings and bounces."""

from __future__ import annotations

import numpy as np

from tests.benchmarks.verdict_scenes.contacts import SIZE
from tests.benchmarks.verdict_scenes.parts import (
    Random,
    Tables,
    body,
    contact,
    ground,
    number,
    row,
    scene,
    solid,
)


def long_run(random: Random) -> Tables:
    kinds = (_in_bowl, _disc, _top, _pendulum, _wobbles)
    return kinds[int(random.integers(len(kinds)))](random)


def _in_bowl(random: Random) -> Tables:
    """A ball in a bowl, sliding, slipping or rolling, 20 s."""
    bowl = {
        "name": "bowl",
        "motion": "fixed",
        "shape": {"kind": "sphere", "radius": 0.5, "cavity": True},
        "position": [0, 0, 0.5],
    }
    r, lean = number(random.uniform(0.02, 0.1)), random.uniform(0.1, 1)
    way = 0.5 - r
    where = [float(way * np.sin(lean)), 0.0, float(0.5 - way * np.cos(lean))]
    ball = body("ball", {"kind": "sphere", "radius": r}, where)
    ball |= {"position": where, "velocity": [0.0, number(random.uniform(-1, 1)), 0.0]}
    friction = float(random.choice([0.0, random.uniform(0.05, 0.8)]))
    return scene([bowl, ball], [contact("bowl", "ball", friction)], 20.0)


def _disc(random: Random) -> Tables:
    """A disc that rolls on its rim, 10 s."""
    r, lean, speed = number(random.uniform(0.1, 0.3)), random.uniform(0.05, 0.6), random.uniform(1.5, 3)
    disc = {
        "name": "disc", "shape": {"kind": "circle", "radius": r}, "mass": 1.0,
        "inertia": [number(r * r / 4), number(r * r / 4), 2 * number(r * r / 4)],
        "rpy": [float(np.pi / 2 - lean), 0.0, 0.0], "position": [0.0, 0.0, float(r * np.cos(lean))],
        "velocity": row([speed, 0, 0]), "angular_velocity": row([0.0, speed / r, 0.0]),
    }  # fmt: skip
    return scene([ground(), disc], [contact("floor", "disc", random.uniform(0.3, 0.9))], 10.0)


def _top(random: Random) -> Tables:
    """An egg that spins on a floor, 10 s."""
    a, b = sorted(row(SIZE * random.uniform(0.3, 0.6, 2)))
    egg = body(
        "egg", {"kind": "ellipsoid", "semi_axes": [a, a, b]}, [0, 0, a], rpy=[float(np.pi / 2), 0.0, 0.0]
    )
    egg |= {
        "position": [0.0, 0.0, a],
        "angular_velocity": row([*random.normal(size=2), random.uniform(20, 60)]),
    }
    return scene([ground(), egg], [contact("floor", "egg", random.uniform(0.05, 0.5))], 10.0)


def _pendulum(random: Random) -> Tables:
    """One or two links that swing for a minute."""
    bodies, joints, at, upper = [], [], np.zeros(3), "world"
    for k in range(int(random.integers(1, 3))):
        length, lean = number(random.uniform(0.2, 0.5)), random.uniform(-0.6, 0.6)
        way = np.array([np.sin(lean), 0.0, -np.cos(lean)])
        link = body(
            f"l{k}", {"kind": "capsule", "radius": 0.02, "length": length}, at, rpy=[0.0, float(-lean), 0.0]
        )
        bodies.append(link | {"position": [float(each) for each in at + length / 2 * way]})
        joints.append(
            {"name": f"j{k}", "kind": "revolute", "between": [upper, f"l{k}"],
             "position": [float(each) for each in at], "rpy": [float(np.pi / 2), 0.0, 0.0]}
        )  # fmt: skip
        upper, at = f"l{k}", at + length * way
    return scene(bodies, [], 60.0, joint=joints)


def _wobbles(random: Random) -> Tables:
    """A stone that rocks and rolls on a floor without end, 10 s."""
    shape = solid(random, "ellipsoid", SIZE)
    height = shape["semi_axes"][2]
    stone = body("stone", shape, [0, 0, height])
    stone |= {"position": [0.0, 0.0, height], "angular_velocity": row(2 * random.normal(size=3))}
    return scene([ground(), stone], [contact("floor", "stone", random.uniform(0.2, 0.9))], 10.0)
