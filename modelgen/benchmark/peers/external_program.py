"""Simulators that run as programs of their own: they read text and write JSON."""

from __future__ import annotations

import json
import shutil
import subprocess
import sys
from collections.abc import Sequence
from functools import cache
from pathlib import Path

import numpy as np

from modelgen.benchmark.peers.peer import PeerError
from modelgen.benchmark.sampled_motion import Array

AROUND_S = 60.0  # wall time, beyond its patience, after which a program is ended


def answer(command: Sequence[str], told: str, patience: float, samples: int) -> tuple[Array, float]:
    """(samples + 1, nb, 10) and CPU seconds that a program writes as {rows, seconds}; raises PeerError."""
    try:
        done = subprocess.run(
            command, input=told, capture_output=True, text=True, check=False, timeout=AROUND_S + 4 * patience
        )
    except subprocess.TimeoutExpired:
        raise PeerError("it did not end", too_long=True) from None
    if done.returncode:
        said = (done.stderr.strip().splitlines() or ["it said nothing"])[-1]
        raise PeerError(f"it ended with {done.returncode}: {said}")
    found = json.loads(done.stdout[done.stdout.index("{") :])
    rows, seconds = np.array(found["rows"], dtype=float), float(found["seconds"])
    if len(rows) <= samples:
        raise PeerError(f"it came to {len(rows) - 1} of {samples} samples", seconds > patience)
    return rows, seconds


@cache
def python_with(module: str) -> str | None:
    """A Python that knows a module: this one, or one of the system."""
    for name in (sys.executable, "/usr/bin/python3", shutil.which("python3")):
        if name and Path(name).exists() and _runs([name, "-c", f"import {module}"]):
            return name
    return None


def output_of(command: Sequence[str]) -> str:
    """Standard output of a command; empty if it fails."""
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    return done.stdout.strip() if done.returncode == 0 else ""


def _runs(command: Sequence[str]) -> bool:
    return subprocess.run(command, capture_output=True, check=False).returncode == 0


def compiled(source: Path, flags: Sequence[str], folder: Path) -> Path | None:
    """A C++ program, compiled once into a folder; None where there is no compiler or library for it."""
    target = folder / source.stem
    compiler = shutil.which("c++") or shutil.which("g++") or shutil.which("clang++")
    if target.exists() and target.stat().st_mtime > source.stat().st_mtime:
        return target
    if compiler is None:
        return None
    folder.mkdir(parents=True, exist_ok=True)
    return target if _runs([compiler, "-O2", str(source), "-o", str(target), *flags]) else None
