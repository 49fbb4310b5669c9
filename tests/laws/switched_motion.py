"""Motion under loads that jump or have kinks, by a route of its own: scipy's DOP853 from zero to zero.

Expressions are walked in Python; each call that is not smooth is on a branch, whose argument is an event
function of scipy. No CasADi, no core.
"""

from __future__ import annotations

import ast
import math
from collections.abc import Sequence
from itertools import chain
from random import Random

import numpy as np
from scipy.integrate import solve_ivp

NOT_SMOOTH = ("abs", "sign", "min", "max")
SMOOTH = {"sin": math.sin, "cos": math.cos}
NAMES = ("x", "y", "z", "vx", "vy", "vz")
CLOSE = 1e-10  # arguments below count as zero where branches are chosen
SLOW = 1e-3  # rates at zeros below are too near to a graze


class UndecidedError(Exception):
    """A zero that is not passed at once: it is kept, only touched, or one of several at a time."""


class Switched:
    """An expression whose calls that are not smooth have branches, in the order of evaluation."""

    def __init__(self, text: str) -> None:
        self.tree = ast.parse(text, mode="eval").body
        calls = (node for node in ast.walk(self.tree) if isinstance(node, ast.Call))
        self.count = sum(node.func.id in NOT_SMOOTH for node in calls)  # type: ignore[attr-defined]

    def evaluate(self, names: dict[str, float], branches: Sequence[float]) -> tuple[float, list[float]]:
        """The value, and the arguments whose signs are the branches."""
        arguments: list[float] = []

        def value(node: ast.expr) -> float:
            match node:
                case ast.Constant(number):
                    return float(number)  # type: ignore[arg-type]
                case ast.Name(name):
                    return names[name]
                case ast.UnaryOp(ast.USub(), x):
                    return -value(x)
                case ast.BinOp(a, op, b):
                    left, right = value(a), value(b)
                    return {
                        ast.Add: left + right, ast.Sub: left - right, ast.Mult: left * right
                    }[type(op)]  # type: ignore[index]  # fmt: skip
                case ast.Call(ast.Name(function), given):
                    values = [value(each) for each in given]
                    return SMOOTH[function](*values) if function in SMOOTH else switched(function, values)
            raise ValueError(ast.dump(node))

        def switched(function: str, values: Sequence[float]) -> float:
            argument = values[0] - values[1] if len(values) == 2 else values[0]
            branch = branches[len(arguments)]
            arguments.append(argument)
            if function in ("abs", "sign"):
                return branch * (argument if function == "abs" else 1.0)
            return values[0] if (branch > 0) == (function == "max") else values[1]

        return value(self.tree), arguments


class SwitchedMotion:
    """A point of which each coordinate is accelerated by an expression of t, place and velocity."""

    def __init__(self, accelerations: Sequence[str]) -> None:
        self.loads = [Switched(text) for text in accelerations]
        self.branches = [[1.0] * load.count for load in self.loads]
        self.switches = [(i, k) for i, load in enumerate(self.loads) for k in range(load.count)]

    def end(self, start: Sequence[float], until: float) -> np.ndarray:
        """Place and velocity at the end; UndecidedError where a zero is not passed at once."""
        t, state = 0.0, np.array(start, dtype=float)
        self._follow_signs(t, state, ())
        for _ in range(200):
            found = solve_ivp(
                lambda t, s: self._evaluate(t, s)[0], (t, until), state, "DOP853", rtol=1e-13, atol=1e-14,
                events=[self._event(i, k) for i, k in self.switches] or None, max_step=0.05,
            )  # fmt: skip
            t, state = float(found.t[-1]), found.y[:, -1]
            if found.status != 1:
                return np.asarray(state)
            arguments = chain.from_iterable(self._evaluate(t, state)[1])
            if sum(abs(argument) < CLOSE for argument in arguments) > 1:
                raise UndecidedError
            hit = tuple(s for s, times in zip(self.switches, found.t_events, strict=True) if len(times))
            for switch in hit:
                self._pass(t, state, switch, hit)
        raise UndecidedError

    def _evaluate(self, t: float, state: np.ndarray) -> tuple[np.ndarray, list[list[float]]]:
        n = len(state) // 2
        names = dict(zip(NAMES[:n] + NAMES[3 : 3 + n], state, strict=True)) | {"t": t}
        found = [each.evaluate(names, b) for each, b in zip(self.loads, self.branches, strict=True)]
        return np.array([*state[n:], *(value for value, _ in found)]), [arguments for _, arguments in found]

    def _event(self, load: int, which: int):  # type: ignore[no-untyped-def]
        def event(t: float, state: np.ndarray) -> float:
            return self._evaluate(t, state)[1][load][which] * self.branches[load][which] + 1e-30

        event.terminal, event.direction = True, -1  # type: ignore[attr-defined]
        return event

    def _follow_signs(self, t: float, state: np.ndarray, kept: Sequence[tuple[int, int]]) -> None:
        for load, which in self.switches * 4:
            argument = self._evaluate(t, state)[1][load][which]
            if (load, which) not in kept and abs(argument) > CLOSE:
                self.branches[load][which] = math.copysign(1.0, argument)

    def _rate(self, t: float, state: np.ndarray, switch: tuple[int, int]) -> float:
        step, slope = 1e-6, self._evaluate(t, state)[0]
        after, before = (
            self._evaluate(t + h, state + h * slope)[1][switch[0]][switch[1]] for h in (step, -step)
        )
        return (after - before) / (2 * step)

    def _pass(
        self, t: float, state: np.ndarray, switch: tuple[int, int], kept: Sequence[tuple[int, int]]
    ) -> None:
        load, which = switch
        side, before = self.branches[load][which], self._rate(t, state, switch)
        self.branches[load][which] = -side
        self._follow_signs(t, state, kept)
        after = self._rate(t, state, switch)
        if after * side > 0 or min(abs(before), abs(after)) < SLOW:
            raise UndecidedError


def drawn(random: Random, names: Sequence[str], depth: int = 0) -> str:
    """A random expression with at least one call that is not smooth."""

    def affine() -> str:
        a, b, c = (f"{random.uniform(-2, 2):.3f}" for _ in range(3))
        return f"({a}*{random.choice(names)} + {b}*{random.choice((*names, 't'))} + {c})"

    def smooth() -> str:
        return random.choice((affine(), f"sin({affine()})", f"({affine()}*{affine()})"))

    def argument() -> str:
        return drawn(random, names, depth + 1) if depth < 2 and random.random() < 0.3 else smooth()

    function = random.choice(NOT_SMOOTH)
    pair = function in ("min", "max")
    call = f"{function}({argument()}{', ' + argument() if pair else ''})"
    if depth:
        return call
    factor = f"{random.uniform(-3, 3):.3f}*"
    return factor + call + (f" + {smooth()}" if random.random() < 0.5 else "")
