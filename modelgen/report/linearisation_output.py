"""Output of `linearise`: the equilibrium or steady motion, and each small motion with frequency and shape."""

from __future__ import annotations

from typing import Any

import numpy as np
from rich.console import Console

from modelgen.linearisation.eigenmodes import Mode
from modelgen.linearisation.equilibrium_and_modes import Linearised
from modelgen.linearisation.steady_modes import LinearisedSteady, SteadyMode
from modelgen.linearisation.touching_contact import Array

STILL = 1e-9  # of places over velocities in characteristic time: rounding


def mode_facts(found: Linearised) -> dict[str, Any]:
    """The object that `linearise --json` prints."""
    bodies = {
        name: {"p": found.p[name].tolist(), "quaternion": found.quaternion[name].tolist()} for name in found.p
    }
    modes = [_mode_facts(mode) | _shape(mode, found.coordinates) for mode in found.modes]
    return {"scene": found.scene, "bodies": bodies} | _force_facts(found) | {"modes": modes}


def steady_facts(found: LinearisedSteady) -> dict[str, Any]:
    """The object that `linearise --steady --json` prints."""
    bodies = {
        name: {
            "p": found.p[name].tolist(),
            "quaternion": found.quaternion[name].tolist(),
            "v": found.v[name].tolist(),
            "w": found.w[name].tolist(),
        }
        for name in found.p
    }
    modes = [_mode_facts(mode) | _change(mode, found.coordinates, found.time) for mode in found.modes]
    return (
        {"scene": found.scene, "bodies": bodies}
        | _force_facts(found)
        | {"symmetries": found.symmetries, "modes": modes}
    )


def _force_facts(found: Linearised | LinearisedSteady) -> dict[str, Any]:
    friction = {
        name: {"force": each.force.tolist(), "share": each.share} for name, each in found.friction.items()
    }
    return {"force": dict(found.force), "friction": friction, "redundant": found.redundant}


def _mode_facts(mode: Mode) -> dict[str, Any]:
    return {"kind": mode.kind, "frequency": mode.frequency, "hertz": mode.hertz, "growth": mode.growth}


def print_modes(facts: dict[str, Any], console: Console) -> None:
    """The same for people: a line a mode, with the bodies that take part."""
    console.print(f"{facts['scene']}: at rest", markup=False, soft_wrap=True)
    for name, state in facts["bodies"].items():
        console.print(_placed(name, state), soft_wrap=True)
    _print_forces(facts, console)
    if not facts["modes"]:
        console.print("no small motions: what touches holds all bodies", soft_wrap=True)
    _print_modes(facts, console)


def print_steady(facts: dict[str, Any], console: Console) -> None:
    """The same for people."""
    console.print(
        f"{facts['scene']}: steady motion, unchanged along {facts['symmetries']} directions",
        markup=False,
        soft_wrap=True,
    )
    for name, state in facts["bodies"].items():
        velocities = f"v ({_vector(state['v'])}), w ({_vector(state['w'])})"
        console.print(f"{_placed(name, state)}, {velocities}", soft_wrap=True)
    _print_forces(facts, console)
    _print_modes(facts, console)


def _placed(name: str, state: dict[str, Any]) -> str:
    return f"{name}: p ({_vector(state['p'])}), quaternion ({_vector(state['quaternion'])})"


def _print_forces(facts: dict[str, Any], console: Console) -> None:
    for name, force in facts["force"].items():
        console.print(
            f"{name}: {force:.6g} N{_held(facts['friction'].get(name))}", markup=False, soft_wrap=True
        )
    if facts["redundant"]:
        console.print(
            f"warning: contact forces are not unique: the contacts have {facts['redundant']} more rows than "
            "independent ones; the motions are unique, the forces given are those of minimum norm"
            + (", or others where friction holds no such" if facts["friction"] else ""),
            soft_wrap=True,
        )


def _print_modes(facts: dict[str, Any], console: Console) -> None:
    for mode in facts["modes"]:
        parts = [f"{mode['frequency']:.9g} rad/s", f"{mode['hertz']:.6g} Hz"] if mode["frequency"] else []
        parts += [f"growth {mode['growth']:.6g} 1/s"] if mode["growth"] else []
        moving = [f"{name} {_taking_part(part)}" for name, part in mode["shape"].items()]
        if "rate" in mode and not any(any(each) for part in mode["shape"].values() for each in part.values()):
            moving = [f"{name} rate {_taking_part(part)}" for name, part in mode["rate"].items()]
        console.print(
            f"{', '.join([mode['kind'], *parts])}: {', '.join(moving)}", markup=False, soft_wrap=True
        )


def _held(friction: dict[str, Any] | None) -> str:
    if friction is None:
        return ""
    return f", friction ({_vector(friction['force'])}) N, {friction['share']:.3g} of what holds"


def _shape(mode: Mode, coordinates: dict[str, slice]) -> dict[str, Any]:
    """The shape turned and scaled so that its largest entry is 1, and what follows a quarter turn later."""
    whole = mode.shape / mode.shape[np.abs(mode.shape).argmax()]
    parts = {"shape": np.real(whole), "quadrature": np.imag(whole)}
    return {
        key: {name: _of_body(part[place]) for name, place in coordinates.items()}
        for key, part in parts.items()
    }


def _change(mode: SteadyMode, coordinates: dict[str, slice], time: float) -> dict[str, Any]:
    """Change of places (`shape`) and of velocities (`rate`), turned and scaled so that the largest entry of
    the places is 1, or of the velocities where no place changes; what follows a quarter turn later."""
    still = np.abs(mode.shape).max(initial=0.0) < STILL * time * np.abs(mode.rate).max(initial=0.0)
    places = np.zeros_like(mode.shape) if still else mode.shape
    leading = mode.rate if still else places
    largest = leading[np.abs(leading).argmax()]
    parts = {
        "shape": np.real(places / largest),
        "quadrature": np.imag(places / largest),
        "rate": np.real(mode.rate / largest),
        "rate_quadrature": np.imag(mode.rate / largest),
    }
    return {
        key: {name: _of_body(part[place]) for name, place in coordinates.items()}
        for key, part in parts.items()
    }


def _of_body(part: Array) -> dict[str, list[float]]:
    return {"v": part[:3].tolist(), "w": part[3:].tolist() or [0.0, 0.0, 0.0]}


def _taking_part(part: dict[str, list[float]]) -> str:
    return f"v ({_vector(part['v'])}) w ({_vector(part['w'])})"


def _vector(values: list[float]) -> str:
    return " ".join(f"{value:.5g}" for value in (round(value, 9) + 0.0 for value in values))
