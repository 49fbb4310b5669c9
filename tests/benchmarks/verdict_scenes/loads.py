"""Bodies under all kinds of resistance: rolling, spinning, dry and viscous, of contacts, joints and air."""

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
    turned,
)


def resisted(random: Random) -> Tables:
    kinds = (_rolls, _rolls, _cart, _pendulum, _slides, _in_air)
    return kinds[int(random.integers(len(kinds)))](random)


def _rolls(random: Random) -> Tables:
    """One or two balls, capsules or cylinders that roll and spin to a stop, on a level or a slope."""
    slope = float(random.choice([0.0, 0.0, random.uniform(0.01, 0.2)]))
    bodies, contacts = [ground()], []
    for k in range(int(random.integers(1, 3))):
        kind = str(random.choice(["sphere", "capsule", "cylinder", "ellipsoid"]))
        shape = solid(random, kind, SIZE / 2)
        lies = kind in ("capsule", "cylinder")
        height = shape["radius"] if "radius" in shape else shape["semi_axes"][2]
        turn = {"rpy": [float(np.pi / 2), 0.0, number(random.uniform(-3, 3))]} if lies else {}
        velocity = row([*random.uniform(-1, 1, 2), 0.0])
        spin = row([0.0, 0.0, random.uniform(-10, 10)])
        place = [0.4 * k, 0.0, height]
        bodies.append(body(f"b{k}", shape, place, velocity=velocity, angular_velocity=spin, **turn))
        resistance = {"rolling_resistance": number(10 ** random.uniform(-4, -2))}
        if random.integers(2):
            resistance["spinning_resistance"] = number(10 ** random.uniform(-4, -2))
        friction = random.uniform(0.2, 0.8)
        contacts.append(contact("floor", f"b{k}", friction, **resistance))
    gravity = row([9.81 * np.sin(slope), 0.0, -9.81 * np.cos(slope)])
    return scene(bodies, contacts, 1.5, gravity=gravity)


def _cart(random: Random) -> Tables:
    """A box on four wheels of balls or cylinders, pushed, with damped axles and rolling resistance."""
    r, a, b = 0.05, 0.2, 0.12
    bodies = [ground(), body("cart", {"kind": "box", "size": [0.4, 0.2, 0.05]}, [0, 0, r + 0.06])]
    bodies[1]["velocity"] = row([random.uniform(0.2, 1), 0, 0])
    joints, contacts = [], []
    resistance = number(10 ** random.uniform(-4, -2.5))
    is_ball = bool(random.integers(2))
    shape = {"kind": "sphere", "radius": r} if is_ball else {"kind": "cylinder", "radius": r, "length": 0.03}
    upright = {"rpy": [float(np.pi / 2), 0.0, 0.0]}
    for k, (x, y) in enumerate(((a, b), (a, -b), (-a, b), (-a, -b))):
        bodies.append(body(f"w{k}", shape, [x, y, r], velocity=bodies[1]["velocity"], **upright))
        damping = number(10 ** random.uniform(-4, -2))
        joints.append(
            {"name": f"axle{k}", "kind": "revolute", "between": ["cart", f"w{k}"], "position": [x, y, r],
             "damping": damping, **upright}
        )  # fmt: skip
        contacts.append(contact("floor", f"w{k}", 0.6, rolling_resistance=resistance))
    return scene(bodies, contacts, 0.6, joint=joints)


def _pendulum(random: Random) -> Tables:
    """A chain of one to three links with damped hinges, and a sprung one, in air."""
    bodies, joints, at = [], [], np.zeros(3)
    upper = "world"
    for k in range(int(random.integers(1, 4))):
        length = number(random.uniform(0.1, 0.3))
        way = random.normal(size=3)
        way /= np.linalg.norm(way)
        across = np.cross(way, [0.3, 0.5, 0.8])
        q = _frame(across / np.linalg.norm(across), way)
        bodies.append(
            body(
                f"l{k}",
                {"kind": "capsule", "radius": 0.02, "length": length},
                at + length / 2 * way,
                quaternion=q,
            )
        )
        joints.append(
            {"name": f"j{k}", "kind": "revolute", "between": [upper, f"l{k}"], "position": row(at),
             "quaternion": turned(random), "damping": number(10 ** random.uniform(-4, -1)),
             "stiffness": number(random.choice([0.0, random.uniform(0.1, 2)]))}
        )  # fmt: skip
        joints[-1]["position"] = [float(each) for each in at]
        bodies[-1]["position"] = [float(each) for each in at + length / 2 * way]
        upper, at = f"l{k}", at + length * way
    return scene(bodies, [], 1.5, joint=joints)


def _frame(x: np.ndarray, z: np.ndarray) -> list[float]:
    """The orientation with these axes, as a quaternion."""
    from scipy.spatial.transform import Rotation

    found = Rotation.from_matrix(np.column_stack([x, np.cross(z, x), z])).as_quat()
    return [float(each) for each in np.roll(found, 1)]


def _slides(random: Random) -> Tables:
    """A block that slides to a stop on a slope, tied by a spring with a damper."""
    shape = solid(random, "box", SIZE)
    kinetic = number(random.uniform(0.1, 0.6))
    friction = {"static": number(kinetic * random.uniform(1, 1.4)), "kinetic": kinetic}
    height = shape["size"][2] / 2
    block = body("block", shape, [0, 0, height], velocity=row([*random.uniform(-1, 1, 2), 0.0]))
    block["position"][2] = height
    spring = {
        "between": ["floor", "block"], "anchors": [[-0.3, 0.0, height], [0.0, 0.0, 0.0]],
        "stiffness": number(10 ** random.uniform(0, 2)), "damping": number(10 ** random.uniform(-2, 1)),
        "rest_length": 0.3,
    }  # fmt: skip
    slope = random.uniform(0, 0.3)
    gravity = row([9.81 * np.sin(slope), 0.0, -9.81 * np.cos(slope)])
    contacts = [{"between": ["floor", "block"], "friction": friction}]
    return scene([ground(), block], contacts, 1.0, spring=[spring], gravity=gravity)


def _in_air(random: Random) -> Tables:
    """A solid that is thrown through air, which resists by the square of its speed, and bounces."""
    shape = solid(random, str(random.choice(["sphere", "ellipsoid", "capsule"])), SIZE / 2)
    ball = body("ball", shape, [0, 0, 0.5], quaternion=turned(random))
    ball |= {"velocity": row(3 * random.normal(size=3)), "angular_velocity": row(5 * random.normal(size=3))}
    c = number(10 ** random.uniform(-3, -1.5))
    speed = "sqrt(vx**2 + vy**2 + vz**2 + 1e-6)"
    drag = {"body": "ball", "force": [f"-{c} * {speed} * v{axis}" for axis in "xyz"]}
    contacts = [contact("floor", "ball", random.uniform(0, 0.6), 0.5, rolling_resistance=1e-3)]
    if "friction" not in contacts[0]:
        del contacts[0]["rolling_resistance"]
    return scene([ground(), ball], contacts, 1.5, force=[drag])
