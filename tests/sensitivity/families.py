"""Random scenes of feet, hinges, kinks, inputs and sensors of forces: a template each, whose numbers are
drawn, half of those of kinks so that the run is exactly on one."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from math import pi, sqrt

import numpy as np

Random = np.random.Generator


@dataclass(frozen=True)
class Member:
    """A scene as text, the time of its sample, s, and what it is differentiated by."""

    text: str
    t: float
    by: tuple[str, ...]
    size: float = 1.0  # of its lengths, m


def parameters(values: Mapping[str, float]) -> str:
    return "".join(f'[[parameter]]\nname = "{name}"\nvalue = {value!r}\n' for name, value in values.items())


def sensors(**of: str) -> str:
    return "".join(f'[[sensor]]\nname = "{name}"\nof = "{each}"\n' for name, each in of.items())


def shown(**values: str) -> str:
    return "".join(f'[[sensor]]\nname = "{name}"\nvalue = "{each}"\n' for name, each in values.items())


def _between(random: Random, low: float, high: float) -> float:
    return float(random.uniform(low, high))


def _beside(random: Random) -> float:
    """How far from a kink: not at all, or a few hundredths to either side."""
    return float(random.choice([0.0, 0.0, -1.0, 1.0])) * _between(random, 0.02, 0.08)


FLOOR = """
[[body]]
name = "floor"
motion = "fixed"
shape = { kind = "plane" }
"""


def _stool(random: Random) -> Member:
    """Feet on a floor, more than three or just three, pushed while they stick."""
    feet = int(random.choice([3, 4]))
    turns = [2 * pi * k / feet + _between(random, -0.2, 0.2) for k in range(feet)]
    places = [[0.2 * float(np.cos(a)), 0.2 * float(np.sin(a)), -0.3] for a in turns]
    legs = [
        f'{{ name = "leg{k}", kind = "sphere", radius = 0.02, position = {place} }}'
        for k, place in enumerate(places)
    ]
    contacts = "".join(
        f'[[contact]]\nbetween = ["stool/leg{k}", "floor"]\nfriction = "mu"\n' for k in range(feet)
    )
    values = {"heavy": _between(random, 1, 4), "mu": _between(random, 0.5, 0.9)}
    text = f"""{parameters(values)}{FLOOR}
[[body]]
name = "stool"
shape = [{", ".join(legs)}]
mass = "heavy"
inertia = [0.1, 0.1, 0.15]
position = [0, 0, 0.32]
[[input]]
name = "push"
default = {_between(random, 0.1, 0.5)!r}
[[force]]
body = "stool"
force = ["push*(1 + t)", "0.3*push", "0"]
{contacts}{sensors(first="stool/leg0-floor/plane.force", p="stool.position")}{shown(twice="2*first")}"""
    return Member(text, 0.2, ("heavy", "mu", "push", "stool.velocity"))


def _hinges(random: Random) -> Member:
    """A door on one or two hinges."""
    both = bool(random.integers(2))
    at = [0.0, _between(random, 0.2, 0.5)] if both else [0.0]
    joints = "".join(
        f"""
[[joint]]
name = "h{k}"
kind = "revolute"
between = ["world", "arm"]
position = [0, {y!r}, 0]
axis_angle = {{ axis = [1, 0, 0], angle = "-pi/2" }}
"""
        for k, y in enumerate(at)
    )
    values = {"heavy": _between(random, 0.5, 2), "long": _between(random, 0.3, 0.7)}
    of = {f"f{k}": f"h{k}.force" for k in range(len(at))} | {f"m{k}": f"h{k}.torque" for k in range(len(at))}
    total = " + ".join(f"f{k}_z" for k in range(len(at)))
    text = f"""{parameters(values)}
[[body]]
name = "arm"
mass = "heavy"
inertia = [0.1, 0.2, 0.3]
position = ["long", 0.1, 0]
{joints}{sensors(**of, turn="h0.coordinate", speed="arm.velocity")}{shown(total=total)}"""
    return Member(text, _between(random, 0.05, 0.4), ("heavy", "long"))


def _weight(random: Random) -> Member:
    """A weight that a push balances, or nearly."""
    heavy = _between(random, 0.5, 2)
    text = f"""{parameters({"heavy": heavy, "lift": heavy * 9.81 * (1 + _beside(random))})}{FLOOR}
[[body]]
name = "ball"
shape = {{ kind = "sphere", radius = 0.1 }}
mass = "heavy"
inertia = [0.01, 0.01, 0.01]
position = [0, 0, 0.1]
[[input]]
name = "push"
default = "lift"
[[force]]
body = "ball"
force = ["0", "0", "push"]
[[contact]]
between = ["ball", "floor"]
{sensors(p="ball.position", load="ball-floor.force", gap="ball-floor.gap")}"""
    return Member(text, _between(random, 0.1, 0.6), ("heavy", "lift", "push", "ball.velocity"))


def _motor(random: Random) -> Member:
    """A wheel that a motor turns: at its limit, near it, or past half a turn at the sample."""
    limit, inertia = _between(random, 0.5, 2), _between(random, 0.5, 2)
    push = limit * (1 + _beside(random))
    t = sqrt(2 * inertia * (pi if random.integers(3) == 0 else _between(random, 0.5, 2)) / min(push, limit))
    text = f"""{parameters({"inertia": inertia, "limit": limit})}
[[input]]
name = "push"
default = {push!r}
[[body]]
name = "wheel"
mass = 1.0
inertia = ["inertia", "inertia", "inertia"]
[[joint]]
name = "axle"
kind = "revolute"
between = ["world", "wheel"]
[[actuator]]
joint = "axle"
force = "push"
limits = ["-limit", "limit"]
{sensors(turn="axle.coordinate", rate="axle.rate", w="wheel.angular_velocity", a="wheel.acceleration")}"""
    return Member(text, t, ("push", "inertia", "limit"))


def _flight(random: Random) -> Member:
    """A free flight, seen by sensors that may be on a kink at the sample, of numbers that may be."""
    fast, t, turn = _between(random, 0.4, 1), _between(random, 0.3, 0.8), _between(random, 100, 2000)
    kink = _between(random, -0.5, 0.5)
    values = {
        "place": kink - fast * t + _beside(random),
        "fast": fast,
        "s": 0.1 * (1 + _beside(random)),
        "w": turn,
    }
    text = f"""gravity = [0, 0, 0]
{parameters(values)}
[constants]
slow = "max(s, 0.1) + 0.01*sin(w*s)"
[[body]]
name = "ball"
mass = "1 + abs(s)"
inertia = [0.01, 0.01, 0.01]
position = ["place", 0.2, 0]
velocity = ["fast", "slow", "min(2*s, s + 0.1)"]
{sensors(p="ball.position", speed="ball.velocity")}{
        shown(
            off=f"3*abs(p_x - {kink!r})",
            most=f"max(p_x, 2*p_x - {kink!r})",
            least="min(p_y, 0.2 + p_z)",
            angle=f"atan2(p_x - {kink!r}, 0 - p_y)",
            energy="speed_x*speed_x + speed_y*speed_y",
        )
    }"""
    return Member(text, t, ("place", "fast", "s", "w", "ball.position"))


def _throw(random: Random) -> Member:
    """A throw to a ceiling that it just reaches, misses or strikes, by one of three laws."""
    law = str(random.choice(["newton", "newton", "poisson", "stronge"]))
    high = _between(random, 0.4, 1)
    fast = sqrt(2 * 9.81 * (high - 0.1)) * (1 + _beside(random))
    values = {"up": fast, "bounce": _between(random, 0.3, 0.8), "high": high}
    text = f"""{parameters(values)}
[[body]]
name = "ceiling"
motion = "fixed"
shape = {{ kind = "plane" }}
position = [0, 0, "high"]
rpy = ["pi", 0, 0]
[[body]]
name = "ball"
shape = {{ kind = "sphere", radius = 0.1 }}
mass = 1.0
inertia = [0.01, 0.01, 0.01]
velocity = [0.5, 0, "up"]
angular_velocity = [0, 3, 0]
[[contact]]
between = ["ball", "ceiling"]
restitution = {{ value = "bounce", law = "{law}" }}
friction = 0.1
{sensors(p="ball.position", speed="ball.velocity", w="ball.angular_velocity", gap="ball-ceiling.gap")}"""
    return Member(text, 1.3 * fast / 9.81, ("up", "bounce", "high", "ball.velocity"))


def _roll(random: Random) -> Member:
    """A ball that is pushed over a floor: at the threshold of friction, or beside it."""
    heavy, mu, inertia = _between(random, 0.5, 2), _between(random, 0.2, 0.6), 0.003
    bound = mu * heavy * 9.81 * (inertia + heavy * 0.01) / inertia
    values = {"heavy": heavy, "mu": mu, "pull": bound * (1 + min(_beside(random), 0.0))}
    text = f"""{parameters(values)}{FLOOR}
[[body]]
name = "ball"
shape = {{ kind = "sphere", radius = 0.1 }}
mass = "heavy"
inertia = [{inertia}, {inertia}, {inertia}]
position = [0, 0, 0.1]
[[input]]
name = "push"
default = "pull"
[[force]]
body = "ball"
force = ["push", "0", "0"]
[[contact]]
between = ["ball", "floor"]
friction = "mu"
{sensors(p="ball.position", w="ball.angular_velocity", load="ball-floor.force")}"""
    return Member(text, _between(random, 0.1, 0.5), ("heavy", "mu", "pull", "push", "ball.velocity"))


def _level(random: Random) -> Member:
    """A box over a floor, level or tilted: the gap is that of one corner or of several."""
    tilt = float(random.choice([0.0, 0.0, 1.0])) * _between(random, 0.05, 0.3)
    text = f"""{parameters({"tilt": tilt, "high": _between(random, 0.5, 0.8)})}{FLOOR}
[[body]]
name = "box"
shape = {{ kind = "box", size = [0.4, 0.3, 0.2] }}
density = 500.0
position = [0, 0, "high"]
rpy = [0, "tilt", 0]
[[contact]]
between = ["box", "floor"]
{sensors(gap="box-floor.gap", p="box.position")}"""
    return Member(text, 0.1, ("tilt", "high", "box.velocity"))


def _start(random: Random) -> Member:
    """A ball that a parameter lets start from the floor, and a load that starts at a jump or on a kink."""
    force = str(random.choice(["-9*sign(x)", "-9*max(0, x)", "-9*abs(x)", "-9*x"]))
    values = {
        "up": float(random.choice([0.0, 1.0])) * _between(random, 0.2, 0.6),
        "place": _beside(random),
        "along": float(random.choice([0.0, 0.8])),
    }
    text = f"""{parameters(values)}{FLOOR}
[[body]]
name = "ball"
shape = {{ kind = "sphere", radius = 0.1 }}
mass = 1.2
inertia = [0.01, 0.01, 0.01]
position = ["place", 0, 0.1]
velocity = ["along", 0, "up"]
[[force]]
body = "ball"
force = ["{force}", "0", "0"]
[[contact]]
between = ["ball", "floor"]
restitution = 0.5
{sensors(p="ball.position", speed="ball.velocity", a="ball.acceleration")}"""
    return Member(text, 0.03, ("up", "place", "along"))


FAMILIES: Mapping[str, Callable[[Random], Member]] = {
    "stool": _stool, "hinges": _hinges, "weight": _weight, "motor": _motor, "flight": _flight,
    "throw": _throw, "roll": _roll, "level": _level, "start": _start,
}  # fmt: skip


def member(name: str, seed: int) -> Member:
    """A member of a family."""
    return FAMILIES[name](np.random.default_rng([seed, *name.encode()]))
