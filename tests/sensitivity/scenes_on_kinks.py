"""Random scenes whose run is on a kink exactly, with masses, lengths and loads by decades: a template each.

Each has a second body, which no kink concerns, with a parameter of its own: `apart`.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from math import pi, sqrt

import numpy as np

from tests.sensitivity.families import FLOOR, Member, Random, parameters, sensors, shown

ASIDE = """
[[body]]
name = "aside"
shape = { kind = "sphere", radius = 0.1 }
mass = 2.0
inertia = [0.01, 0.02, 0.03]
position = [100, 0, 50]
velocity = ["apart", 0, 0]
angular_velocity = [1, "apart", 0]
"""


def _decades(random: Random, low: float, high: float) -> float:
    """A number whose logarithm is uniform."""
    return float(np.exp(random.uniform(np.log(low), np.log(high))))


def _apart(random: Random) -> dict[str, float]:
    return {"apart": float(random.uniform(0.5, 2.0))}


def _limit(random: Random) -> Member:
    """A wheel or slider whose motor is at its upper or lower limit, from rest or in motion."""
    slides, sign = bool(random.integers(2)), float(random.choice([-1.0, 1.0]))
    heavy, strong = _decades(random, 1e-3, 1e3), _decades(random, 1e-3, 1e3)
    t = sqrt((1.0 if slides else 2.0) * heavy / strong)
    inertia = '["heavy", "heavy", "heavy"]'
    values = {"heavy": heavy, "limit": strong, "drag": 0.3 * heavy / t} | _apart(random)
    text = f"""{parameters(values)}
[[input]]
name = "push"
default = {sign * strong!r}
[[body]]
name = "wheel"
mass = "heavy"
inertia = {inertia}
[[joint]]
name = "axle"
kind = "{"prismatic" if slides else "revolute"}"
between = ["world", "wheel"]
damping = "drag"
[[actuator]]
joint = "axle"
force = "push"
limits = ["-limit", "limit"]
{ASIDE}{sensors(turn="axle.coordinate", rate="axle.rate", p="aside.position")}"""
    return Member(text, t, ("push", "heavy", "limit", "drag", "apart"))


def _two_limits(random: Random) -> Member:
    """Two motors at their limits: what one input pushes further, the other may pull back, as may both."""
    heavy, limit = _decades(random, 1e-2, 1e2), _decades(random, 1e-2, 1e2)
    signs = [float(random.choice([-1.0, 1.0])) for _ in range(2)]
    texts = "".join(
        f"""
[[body]]
name = "w{k}"
mass = 1.0
inertia = ["heavy", "heavy", "heavy"]
position = [{k}, 0, 0]
[[joint]]
name = "j{k}"
kind = "revolute"
between = ["world", "w{k}"]
position = [{k}, 0, 0]
[[actuator]]
joint = "j{k}"
force = "{sign!r}*both + own{k}"
limits = ["-limit", "limit"]
"""
        for k, sign in enumerate(signs)
    )
    inputs = "".join(
        f'[[input]]\nname = "{name}"\ndefault = {value!r}\n'
        for name, value in (("both", limit), ("own0", 0.0), ("own1", 0.0))
    )
    t = 0.8 * sqrt(2 * heavy / limit)
    text = f"""{parameters({"heavy": heavy, "limit": limit} | _apart(random))}{inputs}{texts}{ASIDE}{
        sensors(a="j0.coordinate", b="j1.coordinate", p="aside.position")
    }{shown(apart_of="a - b")}"""
    return Member(text, t, ("both", "own0", "own1", "heavy", "limit", "apart"))


def _balanced(random: Random) -> Member:
    """A weight that a push balances, on a floor with friction, drawn aside; or without gravity at all."""
    heavy, gravity = _decades(random, 1e-3, 1e3), float(random.choice([0.0, 9.81]))
    radius = _decades(random, 0.03, 0.3)
    values = {
        "heavy": heavy,
        "lift": heavy * gravity,
        "draw": heavy * _decades(random, 0.1, 1),
    }
    rubs = {"mu": float(random.uniform(0.2, 0.6))} if random.integers(2) else {}
    text = f"""gravity = [0, 0, {-gravity!r}]
{parameters(values | rubs | _apart(random))}{FLOOR}
[[body]]
name = "ball"
shape = {{ kind = "sphere", radius = {radius!r} }}
mass = "heavy"
inertia = [{0.01 * heavy!r}, {0.01 * heavy!r}, {0.01 * heavy!r}]
position = [0, 0, {radius!r}]
[[input]]
name = "push"
default = "lift"
[[input]]
name = "aside_pull"
default = "draw"
[[force]]
body = "ball"
force = ["aside_pull", "0", "push"]
[[contact]]
between = ["ball", "floor"]
friction = {'"mu"' if rubs else 0}
{ASIDE}{sensors(p="ball.position", load="ball-floor.force", gap="ball-floor.gap", q="aside.position")}"""
    t = float(random.uniform(0.1, 0.5))
    return Member(text, t, ("heavy", "lift", "push", "draw", *rubs, "apart", "ball.velocity"))


def _box(random: Random) -> Member:
    """A box on a floor, pushed at the threshold of friction or of tipping, or lifted by all of its weight."""
    heavy, mu = _decades(random, 1e-2, 1e2), float(random.uniform(0.2, 0.5))
    size, case = [0.4, 0.3, 0.1], str(random.choice(["slides", "tips", "hangs"]))
    side, sign = int(random.integers(2)), float(random.choice([-1.0, 1.0]))
    high = size[side] / 2 / mu * float(random.uniform(1.2, 3)) if case == "tips" else 0.0
    weight = heavy * 9.81
    values = {
        "heavy": heavy,
        "mu": mu,
        "pull": {"slides": mu * weight, "tips": weight * size[side] / 2 / max(high, 1e-9), "hangs": 0.0}[
            case
        ],
        "lift": weight if case == "hangs" else 0.0,
        "high": high - 0.05,
    }
    along = ["0", "0"]
    along[side], along[1 - side] = f"{sign!r}*push", "across"
    text = f"""{parameters(values | _apart(random))}{FLOOR}
[[body]]
name = "box"
shape = {{ kind = "box", size = {size!r} }}
mass = "heavy"
inertia = [{0.02 * heavy!r}, {0.03 * heavy!r}, {0.04 * heavy!r}]
position = [0, 0, 0.05]
[[input]]
name = "push"
default = "pull"
[[input]]
name = "across"
[[input]]
name = "up"
default = "lift"
[[force]]
body = "box"
point = [0, 0, "high"]
force = ["{along[0]}", "{along[1]}", "up"]
[[contact]]
between = ["box", "floor"]
friction = "mu"
{ASIDE}{sensors(p="box.position", load="box-floor.force", q="aside.position")}"""
    t = float(random.uniform(0.1, 0.4)) * (1.0 if case == "hangs" else 0.1)
    across = () if case == "slides" else ("across",)  # slip that it begins is too slow for differences
    return Member(text, t, ("heavy", "mu", "pull", "lift", "high", *across, "apart"))


def _threshold(random: Random) -> Member:
    """A ball that is pushed at the threshold of friction, along any direction."""
    heavy, mu, radius = (
        _decades(random, 1e-2, 1e2),
        float(random.uniform(0.2, 0.6)),
        _decades(random, 0.03, 0.3),
    )
    inertia = 0.3 * heavy * radius**2
    bound = mu * heavy * 9.81 * (inertia + heavy * radius**2) / inertia
    angle = float(random.uniform(0, 2 * pi))
    text = f"""{parameters({"heavy": heavy, "mu": mu, "pull": bound} | _apart(random))}{FLOOR}
[[body]]
name = "ball"
shape = {{ kind = "sphere", radius = {radius!r} }}
mass = "heavy"
inertia = [{inertia!r}, {inertia!r}, {inertia!r}]
position = [0, 0, {radius!r}]
[[input]]
name = "push"
default = "pull"
[[force]]
body = "ball"
force = ["{float(np.cos(angle))!r}*push", "{float(np.sin(angle))!r}*push", "0"]
[[contact]]
between = ["ball", "floor"]
friction = "mu"
{ASIDE}{sensors(p="ball.position", vel="ball.velocity", load="ball-floor.force", q="aside.position")}"""
    return Member(
        text, sqrt(radius) * float(random.uniform(0.2, 1)), ("heavy", "mu", "pull", "push", "apart")
    )


def _graze(random: Random) -> Member:
    """A ball that flies past another without gravity, or just reaches a ceiling: the gap touches zero."""
    radius, t = _decades(random, 0.03, 0.3), float(random.uniform(0.5, 1.0))
    passes = bool(random.integers(2))
    fast = 5 * radius if passes else sqrt(2 * 9.81 * radius)
    values = {"fast": fast, "side": 2 * radius, "bounce": 0.5}
    target = (
        f'shape = {{ kind = "sphere", radius = {radius!r} }}\nposition = [{2.0 * radius!r}, "side", 0]'
        if passes
        else 'shape = { kind = "plane" }\nposition = [0, 0, "side"]\nrpy = ["pi", 0, 0]'
    )
    text = f"""gravity = [0, 0, {0.0 if passes else -9.81!r}]
{parameters(values | _apart(random))}
[[body]]
name = "target"
motion = "fixed"
{target}
[[body]]
name = "ball"
shape = {{ kind = "sphere", radius = {radius!r} }}
mass = 1.0
inertia = [0.01, 0.01, 0.01]
velocity = {'["fast", 0, 0]' if passes else '[0.3, 0, "fast"]'}
[[contact]]
between = ["ball", "target"]
restitution = "bounce"
{ASIDE}{sensors(p="ball.position", vel="ball.velocity", gap="ball-target.gap", q="aside.position")}"""
    t = t if passes else 1.4 * fast / 9.81
    return Member(text, t, ("fast", "side", "bounce", "apart", "ball.position"))


def _sensed(random: Random) -> Member:
    """Sensors on kinks at the sample, one within another, of one number or of two."""
    size, t = _decades(random, 0.01, 100), float(random.uniform(0.3, 1.0))
    fast, slow = (size * float(random.uniform(0.5, 2)) for _ in range(2))
    values = {"place": -fast * t, "fast": fast, "slow": slow, "level": -slow * t}
    text = f"""gravity = [0, 0, 0]
{parameters(values | _apart(random))}
[[body]]
name = "ball"
mass = 1.0
inertia = [0.01, 0.01, 0.01]
position = ["place", "level", 0]
velocity = ["fast", "slow", {size!r}]
{ASIDE}{sensors(p="ball.position", vel="ball.velocity", q="aside.position")}{
        shown(
            off="abs(p_x)",
            most="max(3*p_x, p_x + p_y)",
            within="max(abs(p_x), 2*p_y)",
            least="min(p_x, min(p_y, 0.5*p_x))",
            angle="atan2(p_x, 0 - vel_y)",
            far="sqrt(p_x*p_x + p_y*p_y)",
            step=f"sign(p_x)*{size!r} + p_z",
            bent="abs(p_x)*p_z + p_x*p_x",
        )
    }"""
    return Member(text, t, ("place", "fast", "slow", "level", "apart", "ball.velocity"), size)


def _level(random: Random) -> Member:
    """A level box over a floor: the gap is that of the lowest of four corners."""
    size = _decades(random, 0.05, 2)
    values = {"tilt": 0.0, "roll": 0.0, "high": size * float(random.uniform(1.5, 3))}
    text = f"""{parameters(values | _apart(random))}{FLOOR}
[[body]]
name = "box"
shape = {{ kind = "box", size = [{size!r}, {0.7 * size!r}, {0.4 * size!r}] }}
density = {_decades(random, 10, 10000)!r}
position = [0, 0, "high"]
rpy = ["roll", "tilt", 0]
[[contact]]
between = ["box", "floor"]
{ASIDE}{sensors(gap="box-floor.gap", p="box.position", q="aside.position")}{
        shown(below="3 - 2*gap", most="max(gap, 0)")
    }"""
    return Member(text, 0.05 * sqrt(size), ("tilt", "roll", "high", "apart", "box.velocity"))


def _half_turn(random: Random) -> Member:
    """A wheel that is at half a turn at the sample, and a torque that follows the angle of another."""
    heavy, t = _decades(random, 1e-3, 1e3), float(random.uniform(0.3, 1.0))
    values = {"spin": pi / t, "heavy": heavy, "drive": 0.0} | _apart(random)
    text = f"""{parameters(values)}
[[body]]
name = "wheel"
mass = 1.0
inertia = ["heavy", "heavy", "heavy"]
angular_velocity = [0, 0, "{random.choice(["", "-"])}spin"]
[[joint]]
name = "axle"
kind = "revolute"
between = ["world", "wheel"]
[[input]]
name = "torque"
default = "drive"
[[actuator]]
joint = "axle"
force = "torque"
{ASIDE}{sensors(turn="axle.coordinate", rate="axle.rate", q="aside.position")}{shown(twice="2*turn + 1")}"""
    return Member(text, t, ("spin", "heavy", "drive", "apart"))


def _numbers(random: Random) -> Member:
    """Numbers of the scene on kinks, one within another."""
    s = _decades(random, 0.01, 10)
    values = {"s": s, "r": float(random.uniform(0.5, 2))} | _apart(random)
    text = f"""gravity = [0, 0, 0]
{parameters(values)}
[constants]
slow = "max(s, {s!r}) + r"
bent = "abs(s - {s!r})*2 - min(3*s, {3 * s!r})"
deep = "max(abs(s - {s!r}), 5*(s - {s!r})) + s*s"
[[body]]
name = "ball"
mass = "1 + abs(s - {s!r}) + r"
inertia = [0.01, "0.01 + 0.002*abs(s - {s!r})", 0.015]
position = ["slow", "bent", "deep*r"]
velocity = [1, "slow", 0]
angular_velocity = [0.3, 2, 0.1]
[[force]]
body = "ball"
force = ["1", "0", "0"]
{ASIDE}{sensors(p="ball.position", vel="ball.velocity", w="ball.angular_velocity", q="aside.position")}"""
    return Member(text, float(random.uniform(0.3, 1)), ("s", "r", "apart"))


def _load(random: Random) -> Member:
    """A body at rest where loads on it have kinks: springs with play or of one side, dampers among them."""
    heavy, stiff = _decades(random, 1e-2, 1e2), _decades(random, 1e-1, 1e2)
    t = float(random.uniform(0.3, 1.2)) * sqrt(heavy / stiff)
    loads = [
        "-max(0, x)",
        "-abs(x)",
        "min(x, 0.3*x)",
        "-max(0, x) - max(0, x - 1)",
        "-max(x, max(0.5*x, vx))",
    ]
    values = {"heavy": heavy, "stiff": stiff, "place": 0.0} | _apart(random)
    text = f"""gravity = [0, 0, 0]
{parameters(values)}
[[input]]
name = "spring"
default = "stiff"
[[input]]
name = "pull"
[[body]]
name = "ball"
mass = "heavy"
inertia = [0.01, 0.01, 0.01]
position = ["place", 0, 0]
[[force]]
body = "ball"
force = ["spring*({random.choice(loads)}) + pull", "pull", "0"]
{ASIDE}{sensors(p="ball.position", a="ball.acceleration", q="aside.position")}"""
    return Member(text, t, ("heavy", "stiff", "place", "pull", "apart", "ball.velocity"))


def _groove(random: Random) -> Member:
    """A ball in a groove that is pushed so far that one of the walls carries nothing."""
    heavy, radius = _decades(random, 1e-2, 1e2), _decades(random, 0.03, 0.3)
    left, right = (float(angle) for angle in random.uniform(0.3, 1.2, 2))  # of the walls with the horizontal
    values = {"heavy": heavy, "pull": heavy * 9.81 * float(np.tan(right))} | _apart(random)
    walls = "".join(
        f"""[[body]]
name = "{name}"
motion = "fixed"
shape = {{ kind = "plane" }}
rpy = [0, {angle!r}, 0]
[[contact]]
between = ["ball", "{name}"]
"""
        for name, angle in (("left", left), ("right", -right))
    )
    # touching both: n . p = radius with n = (sin left, cos left) and (-sin right, cos right)
    normals = np.array([[np.sin(left), np.cos(left)], [-np.sin(right), np.cos(right)]])
    x, z = map(float, np.linalg.solve(normals, [radius, radius]))
    text = f"""{parameters(values)}
[[body]]
name = "ball"
shape = {{ kind = "sphere", radius = {radius!r} }}
mass = "heavy"
inertia = [{0.01 * heavy!r}, {0.01 * heavy!r}, {0.01 * heavy!r}]
position = [{x!r}, 0, {z!r}]
[[input]]
name = "push"
default = "pull"
[[input]]
name = "lift"
[[force]]
body = "ball"
force = ["push", "0", "lift"]
{walls}{ASIDE}{
        sensors(
            p="ball.position",
            vel="ball.velocity",
            l="ball-left.force",
            r="ball-right.force",
            q="aside.position",
        )
    }"""
    t = sqrt(radius) * float(random.uniform(0.2, 1))
    return Member(text, t, ("heavy", "pull", "push", "lift", "apart", "ball.velocity"))


def _stop(random: Random) -> Member:
    """A wheel or slider that touches the end of its travel, held there by nothing, or balanced."""
    slides, sign = bool(random.integers(2)), float(random.choice([-1.0, 1.0]))
    heavy, strong = _decades(random, 1e-3, 1e3), float(random.integers(2)) * _decades(random, 1e-3, 1e3)
    values = {"heavy": heavy, "strong": strong, "drag": 0.5 * heavy} | _apart(random)
    limits = [0.0, 2.0] if sign > 0 else [-2.0, 0.0]
    text = f"""gravity = [0, 0, 0]
{parameters(values)}
[[input]]
name = "push"
default = "strong"
[[body]]
name = "wheel"
mass = "heavy"
inertia = ["heavy", "heavy", "heavy"]
[[joint]]
name = "axle"
kind = "{"prismatic" if slides else "revolute"}"
between = ["world", "wheel"]
damping = "drag"
limits = {limits!r}
[[actuator]]
joint = "axle"
force = "{sign!r}*(push - {strong!r})"
{ASIDE}{sensors(turn="axle.coordinate", rate="axle.rate", load="axle.force", p="aside.position")}"""
    return Member(text, float(random.uniform(0.2, 1.0)), ("push", "strong", "heavy", "drag", "apart"))


ON_KINKS: Mapping[str, Callable[[Random], Member]] = {
    "limit": _limit, "two_limits": _two_limits, "balanced": _balanced, "box": _box, "threshold": _threshold,
    "graze": _graze, "sensed": _sensed, "corners": _level, "half_turn": _half_turn, "numbers": _numbers,
    "load": _load, "groove": _groove, "stop": _stop,
}  # fmt: skip
