"""Closest points of ellipsoids here and in coal, time and error, in one run (extra `peers`).

Run with `python -m tests.benchmarks.closest [N]`. 1e5 random pairs to 100:1 at gaps from 1e-2 m to 0 and
overlaps to 0.1 of the smallest radius of curvature, solved cold and again, from what that left, after both
bodies moved by 1e-3 of their size and 1e-3 rad at the same gap. Both sides loop inside compiled code: coal
in a C++ loop over GJKSolver::shapeDistance (no dispatch, nothing allocated for it), compiled here against
the headers of its wheel; ours in mg_closest, which gives the margin to singularity besides. coal runs at
its default and at finer tolerances (with up to 1000 iterations), and with its accelerated variants, cold
from the line between the centres and warm from its own cached guesses. A normal is wrong when it is off by
more than 1e-2 or is not finite.
"""

from __future__ import annotations

import ctypes
import subprocess
import sys
import sysconfig
from collections.abc import Callable
from importlib.util import find_spec
from pathlib import Path
from statistics import median
from tempfile import mkdtemp
from time import perf_counter

import numpy as np

from modelgen.runtime.closest_points import ClosestPoints, prepared
from tests.laws.ellipsoid_pairs import Array, Pairs, bound, library, moved, random_pairs, true_normals

ROUNDS, WRONG = 5, 1e-2
VARIANTS = {"GJK": 0, "Polyak": 1, "Nesterov": 2}
SETTINGS = [("GJK", tolerance) for tolerance in (1e-6, 1e-8, 1e-12, 1e-15)]
SETTINGS += [(variant, 1e-6) for variant in ("Polyak", "Nesterov")]


class Coal:
    """coal's solver over a fixed list of pairs."""

    def __init__(self, lengths: Array) -> None:
        prefix = Path(sysconfig.get_path("purelib")) / "cmeel.prefix"
        source, target = (
            Path(__file__).with_suffix(".cpp").with_stem("closest_coal"),
            Path(mkdtemp()) / "coal.so",
        )
        if find_spec("coal") is None:
            raise SystemExit('no package coal: run pip install "modelgen-contact[peers]"')
        command = ["g++", "-std=c++17", "-O3", "-DNDEBUG", "-shared", "-fPIC", f"-I{prefix}/include"]
        command += [f"-I{prefix}/include/eigen3", str(source), "-o", str(target), f"-L{prefix}/lib", "-lcoal"]
        subprocess.run([*command, f"-Wl,-rpath,{prefix}/lib"], check=True)
        self.cdll = ctypes.CDLL(str(target))
        self.cdll.coal_open.restype, self.cdll.coal_run.restype = ctypes.c_void_p, ctypes.c_double
        self.n = len(lengths)
        self.batch = ctypes.c_void_p(self.cdll.coal_open(self.n, pointer(lengths)))

    def place(self, pairs: Pairs) -> None:
        self.cdll.coal_pose(self.batch, self.n, pointer(pairs.pose_o), pointer(pairs.pose_f))

    def run(self, setting: tuple[str, float], warm: bool) -> tuple[Array, float]:
        """Normals, and microseconds a pair."""
        d, normal = np.zeros(self.n), np.zeros((self.n, 3))
        options = VARIANTS[setting[0]], ctypes.c_double(setting[1]), int(warm)
        spent = self.cdll.coal_run(self.batch, self.n, *options, pointer(d), pointer(normal))
        return normal, spent / self.n * 1e6


def pointer(array: Array) -> ctypes.c_void_p:
    return ctypes.c_void_p(array.ctypes.data)


def ours(pairs: Pairs, eta: Array | None) -> tuple[ClosestPoints, float]:
    """Closest points, and microseconds a pair."""
    start = np.zeros((len(pairs.gap), 6)) if eta is None else eta.copy()
    queries, points = prepared(library(), 0, [pairs.pose_o, pairs.pose_f, pairs.lengths, start])
    queries.is_warm_start = eta is not None
    begun = perf_counter()
    library().cdll.mg_closest(ctypes.byref(queries))
    return points, (perf_counter() - begun) / len(pairs.gap) * 1e6


def describe(name: str, normal: Array, truth: Array, spent: list[float]) -> None:
    off = np.linalg.norm((normal - truth).astype(float), axis=1)
    wrong = ~(off <= WRONG)
    print(
        f"{name:32} {median(spent):7.3f} us a pair, {wrong.sum():6d} wrong normals, "
        f"error of the rest: median {np.median(off[~wrong]):.1e}, most {off[~wrong].max():.1e}"
    )


def compare(title: str, pairs: Pairs, eta: Array | None, coal: Coal, ready: Callable[[], None]) -> Array:
    """Prints errors and median times of interleaved rounds; returns our contact parameters."""
    normal, _, kappa = true_normals(pairs)
    times: dict[object, list[float]] = {setting: [] for setting in (None, *SETTINGS)}
    answers: dict[object, Array] = {}
    print(f"--- {title}")
    for _ in range(ROUNDS):
        found, spent = ours(pairs, eta)
        times[None].append(spent)
        for setting in SETTINGS:
            if eta is not None:
                ready()
                coal.run(setting, warm=True)
            coal.place(pairs)
            answers[setting], spent = coal.run(setting, warm=eta is not None)
            times[setting].append(spent)
    describe("modelgen", found.normal, normal, times[None])
    off = np.linalg.norm((found.normal - normal).astype(float), axis=1)
    worst = (off / bound(pairs, kappa)).max() * 20
    print(f"{'':32} {found.certified.sum()} certified; normals within {worst:.2f} eps (1 + kappa |p|)")
    for setting in SETTINGS:
        ratio = median(times[setting]) / median(times[None])
        describe(f"coal {setting[0]} {setting[1]:g}", answers[setting], normal, times[setting])
        print(f"{'':32} {ratio:.1f} times ours")
    return found.eta


def main(n: int) -> None:
    before = random_pairs(n, seed=1)
    coal = Coal(before.lengths)
    eta = compare("cold", before, None, coal, lambda: None)
    after = moved(before, 1e-3, 2, lambda apart: ours(apart, None)[0].normal)
    compare("warm", after, eta, coal, lambda: coal.place(before))


if __name__ == "__main__":
    main(int(sys.argv[1]) if len(sys.argv) > 1 else 100_000)
