"""Bodies that joints and prescribed motions hold: mechanisms, driven bodies, grips, nuts and dominoes."""

from __future__ import annotations

import numpy as np

from tests.benchmarks.verdict_scenes.contacts import SIZE
from tests.benchmarks.verdict_scenes.parts import (
    Random,
    Table,
    Tables,
    body,
    contact,
    ground,
    half_extent,
    number,
    row,
    scene,
    solid,
    turned,
    weighed,
)

JOINTS = ("revolute", "revolute", "prismatic", "spherical", "universal")


def mechanism(random: Random) -> Tables:
    """A tree of two to five bodies with random joints, limits and springs, which may touch a floor."""
    bodies, joints = (
        [{"name": "floor", "motion": "fixed", "shape": {"kind": "plane"}, "position": [0.0, 0.0, -0.5]}],
        [],
    )
    count = int(random.integers(2, 6))
    tips = [np.zeros(3)]
    names = ["world"]
    contacts = []
    for k in range(count):
        root = int(random.integers(len(tips)))
        way = random.normal(size=3)
        way[2] = -abs(way[2])
        tip = tips[root] + number(random.uniform(0.1, 0.3)) * way / np.linalg.norm(way)
        middle = (tips[root] + tip) / 2
        link = weighed(f"b{k}", {"kind": "sphere", "radius": 0.03}, middle, random.uniform(0.2, 2), 0.1)
        link["inertia"] = row(link["mass"] * 0.01 * random.uniform(0.5, 0.9, 3))
        link |= {"position": [float(each) for each in middle], "quaternion": turned(random)}
        bodies.append(link)
        joints.append(_joint(random, f"j{k}", names[root], f"b{k}", tips[root]))
        tips.append(tip)
        names.append(f"b{k}")
        if random.random() < 0.3:
            contacts.append(contact("floor", f"b{k}", random.uniform(0, 0.7), random.uniform(0, 0.5)))
    keys: Table = {"joint": joints}
    if random.random() < 0.3 and count > 2:
        keys["spring"] = [
            {
                "between": ["b0", f"b{count - 1}"],
                "stiffness": number(10 ** random.uniform(1, 2.5)),
                "rest_length": 0.1,
            }
        ]
    return scene(bodies, contacts, 1.0, **keys)


def _joint(random: Random, name: str, a: str, b: str, at: np.ndarray) -> Table:
    kind = str(random.choice(JOINTS))
    found: Table = {"name": name, "kind": kind, "between": [a, b], "quaternion": turned(random)}
    found["position"] = [float(each) for each in at]
    if kind == "prismatic":
        found |= {
            "stiffness": number(random.uniform(20, 200)),
            "limits": row([-0.1, random.uniform(0.05, 0.2)]),
        }
    elif kind != "universal" and random.random() < 0.3:
        low = "none" if kind == "spherical" else -number(random.uniform(0.2, 1))
        found |= {
            "limits": [low, number(random.uniform(0.3, 1))],
            "restitution": number(random.uniform(0, 0.6)),
        }
    if kind in ("revolute", "prismatic") and random.random() < 0.3:
        found["damping"] = number(10 ** random.uniform(-3, -1))
    return found


def driven(random: Random) -> Tables:
    kinds = (_belt, _table, _shaker, _paddle, _crank)
    return kinds[int(random.integers(len(kinds)))](random)


def _moved(name: str, shape: Table, position: list[float], path: Table) -> Table:
    return {"name": name, "motion": "driven", "shape": shape, "position": position, "path": path}


def _laid(random: Random, kind: str, level: float, aside: float = 0.0) -> Table:
    """A solid that lies on a level with a face, or the lowest point of an ellipsoid."""
    shape = solid(random, kind, SIZE / 2)
    return body("load", shape, [0, 0, 0]) | {"position": [aside, 0.0, level + half_extent(shape, 2)]}


def _belt(random: Random) -> Tables:
    """A load on a belt that starts, runs and stops."""
    speed, rate = number(random.uniform(0.2, 1.5)), number(random.uniform(2, 10))
    path = {"position": [f"{speed} * t + {speed / rate!r} * (exp(-{rate} * t) - 1)", 0.0, 0.0]}
    belt = _moved("belt", {"kind": "plane"}, [0.0, 0.0, 0.0], path)
    load = _laid(random, str(random.choice(["box", "cylinder", "sphere", "ellipsoid"])), 0.0)
    return scene([belt, load], [contact("belt", "load", random.uniform(0.1, 0.8))], 1.0)


def _table(random: Random) -> Tables:
    """A load on a turntable."""
    path = {"rotation_vector": [0.0, 0.0, f"{number(random.uniform(1, 6))} * t"]}
    table = _moved("table", {"kind": "plane"}, [0.0, 0.0, 0.0], path)
    load = _laid(random, str(random.choice(["box", "cylinder", "sphere", "ellipsoid"])), 0.0, 0.2)
    return scene([table, load], [contact("table", "load", random.uniform(0.1, 0.8))], 1.0)


def _shaker(random: Random) -> Tables:
    """A load on a plate that shakes along, across or up and down, hard enough to throw it or not."""
    rate = random.uniform(10, 60)
    height = random.uniform(0.3, 2) * 9.81 / rate**2
    axis = int(random.integers(3))
    position: list[object] = [0.0, 0.0, 0.0]
    position[axis] = f"{number(height)} * sin({number(rate)} * t)"
    plate = _moved("plate", {"kind": "plane"}, [0.0, 0.0, 0.0], {"position": position})
    load = _laid(random, str(random.choice(["box", "sphere", "ellipsoid"])), 0.0)
    return scene([plate, load], [contact("plate", "load", random.uniform(0.1, 0.8), 0.2)], 0.6)


def _paddle(random: Random) -> Tables:
    """A box that swings on a prescribed path and strikes a ball on a floor."""
    rate = number(random.uniform(3, 10))
    path = {"rotation_vector": [0.0, f"0.8 * cos({rate} * t)", 0.0]}
    paddle = _moved("paddle", {"kind": "box", "size": [0.05, 0.2, 0.5]}, [0.0, 0.0, 0.4], path)
    ball = body("ball", solid(random, "sphere", 0.06), [-0.45, 0.02, 0.0])
    ball["position"][2] = ball["shape"]["radius"]
    contacts = [contact("floor", "ball", 0.3, 0.3), contact("paddle", "ball", 0.3, 0.5)]
    return scene([ground(), paddle, ball], contacts, 1.0)


def _crank(random: Random) -> Tables:
    """A wheel that a motion turns, a rod and a slider, whose block pushes a load along a floor."""
    r, length, rate = 0.1, 0.3, number(random.uniform(2, 8))
    turn = {"rpy": [float(np.pi / 2), 0.0, 0.0]}
    along = {"rpy": [0.0, float(np.pi / 2), 0.0]}
    wheel = weighed("wheel", {"kind": "cylinder", "radius": r, "length": 0.02}, [0, 0, 0.2], 1.0, r, **turn)
    rod = weighed("rod", {"kind": "sphere", "radius": 0.01}, [r + length / 2, 0, 0.2], 0.2, 0.1)
    block = weighed("block", {"kind": "box", "size": [0.1, 0.1, 0.1]}, [r + length, 0, 0.2], 0.5, 0.05)
    load = weighed("load", {"kind": "box", "size": [0.1, 0.1, 0.1]}, [r + length + 0.11, 0, 0.05], 0.5, 0.05)
    joints = [
        _jointed("motor", "revolute", "world", "wheel", 0.0, motion=f"-{rate} * t", **turn),
        _jointed("pin", "revolute", "wheel", "rod", r, **turn),
        _jointed("wrist", "revolute", "rod", "block", r + length, **turn),
        _jointed("slide", "prismatic", "world", "block", r + length, **along),
    ]
    block["shape"] = {"kind": "box", "size": [0.1, 0.1, 0.3]}
    contacts = [
        contact("floor", "load", random.uniform(0.1, 0.6)),
        contact("block", "load", random.uniform(0, 0.4), 0.2),
    ]
    return scene([ground(), wheel, rod, block, load], contacts, 1.0, joint=joints)


def _jointed(name: str, kind: str, a: str, b: str, x: float, **keys: object) -> Table:
    return {"name": name, "kind": kind, "between": [a, b], "position": [x, 0.0, 0.2], **keys}


def held(random: Random) -> Tables:
    kinds = (_grip, _nut, _dominoes)
    return kinds[int(random.integers(len(kinds)))](random)


def _grip(random: Random) -> Tables:
    """Two fingers with springs hold a solid that hangs free, and a hand lifts and turns it."""
    kind = str(random.choice(["sphere", "box", "cylinder", "ellipsoid"]))
    shape = solid(random, kind, 0.04)
    half = half_extent(shape, 0)
    tip, friction = 0.02, random.uniform(0.4, 0.9)
    thing = body("thing", shape, [0, 0, 0.3])
    rate, height = number(random.uniform(2, 8)), number(random.uniform(0.01, 0.1))
    hand = _moved("hand", {"kind": "box", "size": [0.2, 0.05, 0.02]}, [0.0, 0.0, 0.5],
                  {"position": [0.0, 0.0, f"{height} * (1 - cos({rate} * t))"]})  # fmt: skip
    push = number(random.uniform(1, 4) * 9.81 * 0.5)
    bodies, joints, contacts = [hand, thing], [], []
    for name, side in (("left", -1.0), ("right", 1.0)):
        x = side * (half + tip)
        finger = weighed(name, {"kind": "sphere", "radius": tip}, [x, 0, 0.3], 0.1, tip)
        bodies.append(finger | {"position": [x, 0.0, 0.3]})
        joints.append(
            {"name": f"{name}_guide", "kind": "prismatic", "between": ["hand", name],
             "position": [x, 0.0, 0.3], "rpy": [0.0, float(-side * np.pi / 2), 0.0],
             "stiffness": 100.0, "rest": number(push / 100.0)}
        )  # fmt: skip
        contacts.append(contact("thing", name, friction))
    return scene(bodies, contacts, 0.6, joint=joints)


def _nut(random: Random) -> Tables:
    """A nut of three pads on the flank of a thread, which it holds or runs down."""
    pitch, angle = (
        number(random.uniform(0.01, 0.03)),
        row(random.uniform(0, 6.28) + np.arange(3) * 2 * np.pi / 3),
    )
    p, r, pad = pitch / (2 * np.pi), 0.03, 0.002
    flank = {"x": "u*cos(v)", "y": "u*sin(v)", "z": "p*v", "domain": [[0.015, 0.045], [-40.0, 12.0]]}
    shape = {"kind": "chart", "parameters": {"p": p}, **flank}
    thread = {"name": "thread", "motion": "fixed", "shape": shape}
    shapes = []
    for k, v in enumerate(angle):
        normal = np.array([p * np.sin(v), -p * np.cos(v), r]) / np.hypot(p, r)
        at = np.array([r * np.cos(v), r * np.sin(v), p * v]) + pad * normal
        shapes.append(
            {"name": f"pad{k}", "kind": "sphere", "radius": pad, "position": [float(each) for each in at]}
        )
    nut = {
        "name": "nut",
        "shape": shapes,
        "mass": 0.4,
        "inertia": [1.2e-4, 1.2e-4, 2e-4],
        "center_of_mass": [0.0, 0.0, 0.01],
    }
    friction = random.uniform(0.02, 0.3)
    contacts = [contact("thread", f"nut/pad{k}", friction) for k in range(3)]
    joint = {"name": "guide", "kind": "cylindrical", "between": ["world", "nut"]}
    return scene([thread, nut], contacts, 0.6, joint=[joint])


def _dominoes(random: Random) -> Tables:
    """Three to five dominoes in a row, of which the first is tipped."""
    thick, wide, tall = 0.02, 0.05, 0.06
    apart = number(random.uniform(0.035, 0.06))
    friction, between, spin = random.uniform(0.4, 0.8), random.uniform(0, 0.4), number(random.uniform(5, 8))
    bodies, contacts = [ground("table")], []
    for k in range(int(random.integers(3, 6))):
        piece = body(f"d{k}", {"kind": "box", "size": [thick, wide, tall]}, [k * apart, 0, tall / 2])
        bodies.append(piece)
        contacts.append(contact("table", f"d{k}", friction))
        if k:
            contacts.append(contact(f"d{k - 1}", f"d{k}", between))
    bodies[1] |= {
        "angular_velocity": [0.0, spin, 0.0],
        "velocity": row([spin * tall / 2, 0.0, spin * thick / 2]),
    }
    return scene(bodies, contacts, 0.4)
