"""Output of `linearise`: the equilibrium, and each small motion with its frequency and shape."""

from __future__ import annotations

from typing import Any

import numpy as np
from rich.console import Console

from modelgen.linearisation.contact_at_rest import Array
from modelgen.linearisation.eigenmodes import Mode
from modelgen.linearisation.equilibrium_and_modes import Linearised


def mode_facts(found: Linearised) -> dict[str, Any]:
    """The object that `linearise --json` prints."""
    return {
        "scene": found.scene,
        "bodies": {
            name: {"p": found.p[name].tolist(), "quaternion": found.quaternion[name].tolist()}
            for name in found.p
        },
        "force": dict(found.force),
        "friction": {
            name: {"force": each.force.tolist(), "share": each.share} for name, each in found.friction.items()
        },
        "redundant": found.redundant,
        "modes": [
            {
                "kind": mode.kind,
                "frequency": mode.frequency,
                "hertz": mode.hertz,
                "growth": mode.growth,
                **_shape(mode, found.coordinates),
            }
            for mode in found.modes
        ],
    }


def print_modes(facts: dict[str, Any], console: Console) -> None:
    """The same for people: a line a mode, with the bodies that take part."""
    console.print(f"{facts['scene']}: at rest", markup=False, soft_wrap=True)
    for name, state in facts["bodies"].items():
        console.print(
            f"{name}: p ({_vector(state['p'])}), quaternion ({_vector(state['quaternion'])})", soft_wrap=True
        )
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
    if not facts["modes"]:
        console.print("no small motions: what touches holds all bodies", soft_wrap=True)
    for mode in facts["modes"]:
        parts = [f"{mode['frequency']:.9g} rad/s", f"{mode['hertz']:.6g} Hz"] if mode["frequency"] else []
        parts += [f"growth {mode['growth']:.6g} 1/s"] if mode["growth"] else []
        moving = [f"{name} {_taking_part(part)}" for name, part in mode["shape"].items()]
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


def _of_body(part: Array) -> dict[str, list[float]]:
    return {"v": part[:3].tolist(), "w": part[3:].tolist() or [0.0, 0.0, 0.0]}


def _taking_part(part: dict[str, list[float]]) -> str:
    return f"v ({_vector(part['v'])}) w ({_vector(part['w'])})"


def _vector(values: list[float]) -> str:
    return " ".join(f"{value:.5g}" for value in (round(value, 9) + 0.0 for value in values))
