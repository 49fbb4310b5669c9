"""Random members of the kinds of scenes in which numbers have been wrong, each beside a judge of its own.

Run with `python -m tests.benchmarks.families [--kind NAME ..] [--count 100] [--part I/N]`. A judge is a
closed form, quadrature, statics, or an integration or search without the core. Told are of each kind the
members that are right and trusted, those that are not trusted (and how many of them are wrong), those that
are refused as they should be, those that the judge cannot follow, those that are wrong and trusted, and
CPU seconds with those of the compiler. Exits with 1 if a member is wrong and trusted.
"""

from __future__ import annotations

import argparse
import os
import tempfile
from collections import Counter
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
from scipy.optimize import brentq, minimize, minimize_scalar
from scipy.spatial.transform import Rotation

from modelgen import closest_points, derive, require, simulate
from modelgen.errors import SceneError, SimulationError
from modelgen.report.run_page import run_page
from modelgen.report.run_record import record_of
from modelgen.report.summary import verdict_title
from modelgen.runtime.trajectory import Trajectory
from modelgen.scene import python_scenes as make
from modelgen.scene.scene_types import Body
from tests.benchmarks import armature, derivative_families, rings_on_wires
from tests.importing import test_meshes
from tests.joints import test_gears
from tests.optimal_control.test_plans_of_modes import Task
from tests.oracles import test_force_errors, test_many_surfaces_at_point, test_stepping_boxes
from tests.oracles.friction import test_blow_laws, test_light_feet, test_resistance
from tests.oracles.friction.painleve import INDETERMINATE, PARTS, SLIDES, Rod
from tests.oracles.test_flush_blows import LEFT, SLIDERS, plate
from tests.planar import test_shares, test_spun_faces
from tests.planar.spun_faces import NEARLY_TIPPING, ending
from tests.running import library_of
from tests.runtime import test_estimate, test_poses
from tests.sensitivity import test_input_defaults
from tests.sensitivity.families import FAMILIES as DERIVED

Random = np.random.Generator
RIGHT, DOUBTED, WRONG_DOUBTED, REFUSED, WRONG = "right", "doubted", "doubted, wrong", "refused", "WRONG"
NOT_JUDGED = "not judged"
G = 9.81


def told(path: Trajectory, is_right: bool) -> str:
    if path.is_trusted:
        return RIGHT if is_right else WRONG
    return DOUBTED if is_right else WRONG_DOUBTED


def theorem(test: Callable[..., None], *given: object) -> str:
    """What a test that asserts trust and numbers says of a member."""
    try:
        test(*given)
    except AssertionError:
        return WRONG
    return RIGHT


def row(values: np.ndarray) -> list[float]:
    return [float(each) for each in values]


def flush(rng: Random) -> str:
    """A body slides without friction over the seam of level plates, of two bodies or of one, whose heights
    are equal or differ by rounding. No force acts along its way, unless the second plate is higher by more
    than `flush_height`, which is a step that the body strikes."""
    height = float(rng.choice([0.0, 1.0, -1.0])) * 10.0 ** rng.uniform(-17, -9)
    legs = [
        make.cylinder(0.03, 0.1, name=f"leg{k}", position=[0.1 * x, 0.08 * y, 0])
        for k, (x, y) in enumerate(((1, 1), (1, -1), (-1, 1), (-1, -1)))
    ]
    shapes = [*([each] for each in SLIDERS.values()), legs][int(rng.integers(4))]
    ground: list[Body] = [LEFT, plate(height)]
    if rng.integers(2):
        places = (("a", -1.0, -1.0), ("b", 1.0, height - 1))
        ground = [make.fixed("left", *(make.box(2, 2, 2, name=n, position=[x, 0, z]) for n, x, z in places))]
    way, start = rng.uniform(-0.5, 0.5), np.array([-0.5, rng.uniform(-0.2, 0.2), 0.05])
    v = rng.uniform(1, 3) * np.array([np.cos(way), np.sin(way), 0])
    slider = make.dynamic(
        "slider", *shapes, mass=1.0, inertia=[0.01, 0.01, 0.01], position=row(start), velocity=row(v),
        rpy=[0, 0, float(rng.uniform(-np.pi, np.pi))],
    )  # fmt: skip
    scene = make.scene("seam", [*ground, slider], contacts={"between": "all"})
    library = library_of(scene)
    is_step = height > scene.run.flush_height * library.manifest.instance["scales"]["length"]
    path = simulate(library, until=0.45, samples=9)
    off = np.abs(path.p[:, -1] - (start + path.t[:, None] * v)).max()
    return told(path, path.outcome.succeeded and bool(off < 1e-7) != is_step)


def _frustum_height(R: np.ndarray, radii: tuple[float, float], half: float, normal: np.ndarray) -> float:
    """How far a frustum reaches from its centre towards `normal`, m."""
    along = float(R[:, 2] @ normal)
    across = float(np.sqrt(max(1 - along**2, 0.0)))
    return max(-half * along + radii[0] * across, half * along + radii[1] * across)


def endless(rng: Random) -> str:
    """A frustum of any half-angle and pose falls onto an endless rail: the first time at which the distance
    of its convex body from the axis of the rail is the radius of the rail."""
    slope, middle, half = 10.0 ** rng.uniform(-3, -0.2), rng.uniform(0.1, 0.5), rng.uniform(0.02, 0.06)
    radii = (middle + half * slope, middle - half * slope)
    radius, drop = rng.uniform(0.05, 0.4), 10.0 ** rng.uniform(-3, -1)
    yaw = float(rng.uniform(-np.pi, np.pi))
    rail_turn = Rotation.from_euler("yz", [np.pi / 2 + float(rng.choice([0, rng.uniform(-0.3, 0.3)])), yaw])
    level = Rotation.from_euler("xz", [-np.pi / 2, yaw])
    turn = (level, Rotation.from_rotvec(0.1 * rng.normal(size=3)) * level, Rotation.random(random_state=rng))
    R, axis = turn[int(rng.integers(3))].as_matrix(), rail_turn.as_matrix()[:, 2]
    up = np.array([0, 0, 1.0]) - axis[2] * axis
    up /= np.linalg.norm(up)
    side = np.cross(axis, up)

    def distance(centre: np.ndarray) -> float:
        """From the axis of the rail: the largest over planes along it."""

        def beyond(angle: float) -> float:
            n = np.cos(angle) * up + np.sin(angle) * side
            return -(float(n @ centre) - _frustum_height(R, radii, half, -n))

        angles = np.linspace(-np.pi / 2, np.pi / 2, 721)
        k = int(np.argmin([beyond(a) for a in angles]))
        near = angles[max(k - 1, 0)], angles[min(k + 1, 720)]
        return -float(minimize_scalar(beyond, bounds=near, method="bounded", options={"xatol": 1e-13}).fun)

    x, y = rng.uniform(-0.1, 0.1, 2)

    def gap(z: float) -> float:
        return distance(np.array([x, y, z])) - radius

    if gap(0.0) > 0:  # it falls past the rail
        return endless(rng)
    low = brentq(gap, 0.0, 3.0, xtol=1e-14)
    rail = make.fixed("rail", make.cylinder(radius), rotation=[row(each) for each in rail_turn.as_matrix()])
    wheel = make.dynamic(
        "wheel", make.frustum(float(radii[0]), float(radii[1]), float(2 * half)), mass=1.0,
        inertia=[0.02, 0.02, 0.02],
        position=[float(x), float(y), float(low + drop)], rotation=[row(each) for each in R],
    )  # fmt: skip
    t = np.sqrt(2 * drop / G)
    scene = make.scene("rail", [rail, wheel], contact=[{"between": ["wheel", "rail"], "friction": 0.4}])
    path = simulate(library_of(scene), until=1.05 * t, samples=2)
    first = next((event.t for event in path.events if event.kind in ("impact", "touch-down")), np.inf)
    return told(path, bool(abs(first - t) < 1e-8))


def gear(rng: Random) -> str:
    """A gear on a body that can turn about its axis is taken, on another refused."""
    held = str(rng.choice([*test_gears.TURNING, *test_gears.HOLDING]))
    try:
        require(test_gears.geared(held, int(rng.integers(1 << 30))))
    except SceneError:
        return REFUSED if held in test_gears.HOLDING else WRONG
    return RIGHT if held in test_gears.TURNING else WRONG


def rod(rng: Random) -> str:
    """A rod whose tip slides: two Coulomb solutions, or the one of the closed form."""
    wanted, of, outcome = str(rng.choice([INDETERMINATE, INDETERMINATE, PARTS, SLIDES])), Rod(), ""
    while outcome != wanted:
        theta, mu, rate = rng.uniform(0.2, 1.4), rng.uniform(0.3, 3.0), rng.uniform(0.0, 12.0)
        outcome = of.outcome(theta, rate, mu)
    c, s = 0.5 * np.cos(theta), 0.5 * np.sin(theta)
    body = make.dynamic(
        "rod", make.point(-0.5, 0.0, 0.0), mass=1.0, inertia=[1e-4, 1 / 12, 1 / 12],
        rpy=[0, -float(theta), 0], position=[float(c), 0, float(s)],
        velocity=[float(-4.0 - rate * s), 0, float(rate * c)], angular_velocity=[0, -float(rate), 0],
    )  # fmt: skip
    table = make.fixed("table", make.plane())
    contact = [{"between": ["rod", "table"], "friction": float(mu)}]
    path = simulate(library_of(make.scene("rod", [body, table], contact=contact)), until=1e-5, samples=1)
    if wanted == INDETERMINATE:  # neither motion is the right one
        return told(path, False)
    force = of.force(theta, rate, mu) if wanted == SLIDES else 0.0
    return told(path, bool(abs(path.force[0, 0] - force) < 1e-8 * max(1.0, force)))


def tower(rng: Random) -> str:
    """Frictionless spheres of any masses, whose forces are sums of weights."""
    n, decades = int(rng.integers(2, 51)), int(rng.choice([0, 4, 8, 10]))
    return theorem(test_force_errors.test_the_error_of_forces_in_a_tower_is_stated, n, decades)


def stack(rng: Random) -> str:
    """Spheres between two walls."""
    return theorem(
        test_force_errors.test_the_error_of_forces_in_a_random_stack_is_stated, int(rng.integers(1 << 30))
    )


@cache
def _rings() -> Any:
    return test_poses.rings(fixed=False)


def poses(rng: Random) -> str:
    """Distances of tori at poses [R | p]: that of their middle circles, searched from many starts."""
    first, second = (test_poses.drawn(1, int(rng.integers(1 << 30)))[0] for _ in range(2))

    def circle(pose: np.ndarray, radius: float, angle: float) -> np.ndarray:
        at = pose[:, :3] @ [radius * np.cos(angle), radius * np.sin(angle), 0] + pose[:, 3]
        return np.asarray(at)

    def apart(angles: np.ndarray) -> float:
        return float(np.linalg.norm(circle(first, 1.0, angles[0]) - circle(second, 0.6, angles[1])))

    grid = np.linspace(-np.pi, np.pi, 25)[:-1]
    starts = sorted((apart(np.array([a, b])), a, b) for a in grid for b in grid)[:12]
    least = min(minimize(apart, [a, b], method="Nelder-Mead", options={"xatol": 1e-12, "fatol": 1e-15}).fun
                for _, a, b in starts)  # fmt: skip
    found = closest_points(_rings(), "a-b", first, second)
    if least < 0.21:  # the tori meet: another number
        return RIGHT if float(found.d[0]) < 0.02 else WRONG
    is_right = abs(float(found.d[0]) - (least - 0.2)) < 1e-8
    certified = bool(np.all(found.certified))
    return (RIGHT if is_right else WRONG) if certified else (DOUBTED if is_right else WRONG_DOUBTED)


def mesh(rng: Random) -> str:
    """An imported mesh with a dent of any depth, or none: a run with its hull is not trusted."""
    depth = float(rng.choice([0.0, rng.uniform(0.001, 0.19)]))
    of = test_meshes.dented(depth) if depth else (test_meshes.CORNERS, test_meshes.FACES)
    with tempfile.TemporaryDirectory() as folder:
        found = test_meshes.imported(*of, Path(folder))
    path = simulate(library_of(found.scene), until=float(rng.uniform(0.02, 0.5)), samples=2)
    return told(path, not depth)


def armature_joints(rng: Random) -> str:
    """Chains and trees beside MuJoCo."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "model.xml"
        path.write_text(armature.random_model(int(rng.integers(1 << 30))), encoding="utf-8")
        return RIGHT if armature.difference(path) < 1e-7 else WRONG


def limit(rng: Random) -> str:
    """A body on a slide falls between two stops and rebounds: a polygon of parabolas."""
    low, high = -rng.uniform(0.05, 0.5), rng.uniform(0.05, 0.5)
    bounce, x, v = rng.uniform(0.2, 0.95), 0.0, rng.uniform(-2, 2)
    tilt = float(rng.uniform(-1.5, 1.5))
    pull, until = G * np.sin(tilt), float(rng.uniform(0.1, 0.6))
    body = make.dynamic(
        "slider", mass=float(rng.uniform(0.1, 3)), inertia=[0.1, 0.1, 0.1], velocity=[0, 0, v]
    )
    slide = {
        "name": "slide", "kind": "prismatic", "between": ["world", "slider"],
        "limits": [float(low), float(high)], "restitution": float(bounce),
    }  # fmt: skip
    gravity = [G * np.cos(tilt), 0, pull]
    path = simulate(
        library_of(make.scene("slide", [body], joint=[slide], gravity=row(np.array(gravity)))),
        until=until, samples=1,
    )  # fmt: skip
    t = 0.0
    while True:
        ways = []
        for stop in (low, high):
            roots = np.roots([pull / 2, v, x - stop]) if abs(pull) > 1e-9 else np.array([(stop - x) / v])
            for r in roots:
                is_outwards = (v + pull * r.real) * (stop - (low + high) / 2) > 0
                ways += [(float(r.real), stop)] if not r.imag and r.real > 1e-9 and is_outwards else []
        way, stop = min(ways, default=(np.inf, 0.0))
        if t + way > until:
            x += v * (until - t) + pull / 2 * (until - t) ** 2
            break
        t, x, v = t + way, stop, -bounce * (v + pull * way)
        if abs(v) < 1e-3:
            return limit(rng)  # it settles
    return told(path, bool(abs(path.p[-1, 0, 2] - x) < 1e-7))


def dense(rng: Random) -> str:
    """Samples denser than steps at `fast` are within the stated error of a tight run."""
    return theorem(test_estimate.test_samples_denser_than_steps_are_covered, int(rng.integers(1 << 30)))


def blow(rng: Random) -> str:
    """A rod that strikes with Newton's restitution and friction gains energy, or not."""
    e, mu, angle, spin = row(rng.uniform([0.5, 0.1, 0.1, -3], [1.0, 1.5, 1.4, 3]))
    path, _, _ = test_blow_laws.rod_struck("newton", e, mu, angle, spin)
    before = 0.5 + test_blow_laws.INERTIA[1] * spin**2 / 2
    return told(path, bool(path.energy[-1] - before < 1e-6 * path.energy.max()))


def ring(rng: Random) -> str:
    """A ring on a wire moves no farther than its speed allows, and corrections make no energy."""
    of, path = None, None
    while path is None:
        of = rings_on_wires.ring_on_wire(int(rng.integers(1 << 30)))
        path = rings_on_wires.run(of, "balanced")
    assert of is not None
    moved = rings_on_wires.leap_of(of, path) <= 1.0 + 1e-9 and path.correction_energy <= 1e-6
    grown = np.max(path.energy - path.work - path.energy[0]) < 1e-6 * np.ptp(path.energy) + 1e-6
    return told(path, bool(moved and grown))


def spun(rng: Random) -> str:
    """Upright bodies that spin, and may slide, against an integration without the core."""
    of = test_spun_faces.member(
        int(rng.integers(1 << 30)), (0.02, 0.99), test_spun_faces.SLIDES if rng.integers(2) else None
    )
    try:
        end = ending(of.body, of.v, of.w)
    except ArithmeticError:  # the integration finds no pressure to go on with
        return NOT_JUDGED
    if end.margin < 2 * NEARLY_TIPPING:
        return spun(rng)
    path = test_spun_faces.run_of(of, 1.2 * end.t, "balanced")
    stops = [event.t for event in path.events if event.kind == "slip-stop"]
    place = np.abs(path.p[-1, 1, :2] - end.place).max()
    is_right = (
        len(stops) > 0 and abs(stops[-1] - end.t) < 1e-6 * end.t
        and place < 1e-6 * (of.body.radius + np.hypot(*end.place))
    )  # fmt: skip
    return told(path, bool(is_right))


def joined(rng: Random) -> str:
    """A ball slides without friction from one height field to another of the same plane."""
    a, b, radius = (
        float(each) for each in (*rng.uniform(-0.3, 0.3, 2) * rng.integers(2), rng.uniform(0.05, 0.2))
    )
    y = np.linspace(-1, 1, int(rng.integers(4, 7)))

    def field(name: str, low: float, high: float) -> Body:
        x = np.linspace(low, high, int(rng.integers(4, 7)))
        heights = [[float(a * u + b * w) for w in y] for u in x]
        return make.fixed(name, make.height_field(row(x), row(y), heights))

    normal = np.array([-a, -b, 1]) / np.sqrt(1 + a * a + b * b)
    across = rng.uniform(-0.3, 0.3)
    v = np.array([1.0, across, a + b * across]) * rng.uniform(0.8, 1.5)
    at = np.array([-0.4, rng.uniform(-0.2, 0.2), 0])
    at[2] = a * at[0] + b * at[1]
    start = at + radius * normal
    body = make.dynamic("ball", make.sphere(radius), density=1000.0, position=row(start), velocity=row(v))
    fields = [field("west", -2.0, 0.0), field("east", 0.0, 2.0)]
    scene = make.scene(
        "fields", [*fields, body], contact=[{"between": ["ball", each.name]} for each in fields]
    )
    path = simulate(library_of(scene), until=0.6, samples=20)
    g = np.array([0, 0, -G])
    down = g - (g @ normal) * normal
    wanted = start + path.t[:, None] * v + path.t[:, None] ** 2 / 2 * down
    off = np.abs(path.p[:, 2] - wanted).max()
    return told(path, path.outcome.succeeded and bool(off < 1e-7))


def foot(rng: Random) -> str:
    """A foot of a rimless wheel of any inertia sticks: angle by quadrature."""
    inertia = 10.0 ** rng.uniform(-10, -1)
    path = simulate(test_light_feet.wheel(inertia), until=float(rng.uniform(0.01, 0.3)), samples=3)
    centre = path.p[:, path.body_names.index("wheel")]
    angle = np.arctan2(centre[:, 0], centre[:, 2])
    times = np.array([test_light_feet.time_at(float(each), inertia) for each in angle])
    return told(path, path.outcome.succeeded and bool(np.abs(times - path.t).max() < 1e-7))


def tip(rng: Random) -> str:
    """A pyramid of any number of sides on its tip on a concave body touches at one point; deeper it is
    refused."""
    sides, turn = int(rng.integers(3, 65)), float(rng.uniform(0, 1))
    depth = float(rng.choice([0.0, 10.0 ** rng.uniform(-6, -2.5)]))
    scene = test_many_surfaces_at_point.on_foot_of_l(sides, turn, depth)
    try:
        path = simulate(library_of(scene), until=1e-6, samples=1)
    except SimulationError:
        return REFUSED if depth else WRONG
    return told(path, not depth and (path.force[0] > 0).sum() == 1)


def boxes(rng: Random) -> str:
    """Falling boxes by time-stepping: a penetration is told (no such run is trusted for other reasons)."""
    step, until = float(rng.choice([0.003, 0.005])), float(rng.uniform(0.1, 0.3))
    path = simulate(
        test_stepping_boxes.thrown(int(rng.integers(1 << 30))), until=until, samples=1, step=step,
        method="time-stepping", accuracy="fast", estimate=False,
    )  # fmt: skip
    deepest = test_stepping_boxes.deepest(path)
    if deepest < 1e-9:
        return DOUBTED
    return WRONG_DOUBTED if path.penetration_max > deepest / 2 else WRONG


def no_gamma(rng: Random) -> str:
    """A run without Gamma2 is another motion: page, heading and verdict say that it is not trusted."""
    shape = make.ellipsoid(*row(rng.uniform(0.04, 0.1, 3)))
    stone = make.dynamic(
        "stone", shape, density=1000.0, position=[0, 0, 0.3], rpy=row(rng.uniform(-1, 1, 3)),
        angular_velocity=row(rng.normal(size=3)),
    )  # fmt: skip
    scene = make.scene(
        "stone", [make.fixed("table", make.plane()), stone], contact=[{"between": ["stone", "table"]}],
        run={"use_gamma": False, "until": 0.5},
    )  # fmt: skip
    library = library_of(scene)
    path = simulate(library)
    said = verdict_title(path.summary())
    if rng.random() < 0.1:
        said = run_page(record_of(path, library, scene), derive(require(scene))).split("</h1>")[0]
    return told(path, False) if "not trusted" in said else WRONG


@contextmanager
def _silent() -> Iterator[None]:
    """Without what a solver writes past Python."""
    with Path(os.devnull).open("w") as nowhere:
        kept = os.dup(1)
        os.dup2(nowhere.fileno(), 1)
        try:
            yield
        finally:
            os.dup2(kept, 1)
            os.close(kept)


def plan(rng: Random) -> str:
    """A plan that succeeds is the best of the sequences of modes beside it."""
    friction, distance, horizon = row(rng.uniform([0.05, 0.1, 0.5], [0.8, 0.6, 1.5]))
    task = Task(friction, distance, horizon, int(rng.integers(4, 6)))
    with _silent():
        values, (made,) = task.values(), task.plans(1)
    if not made.solution.success or not values:
        return DOUBTED
    return RIGHT if task.is_best_beside(made, values) else WRONG


def by_inputs(rng: Random) -> str:
    """Derivatives by a parameter that is the default of an input."""
    return theorem(
        test_input_defaults.test_defaults_of_inputs_follow_from_parameters, int(rng.integers(1 << 30)),
        bool(rng.integers(2)),
    )  # fmt: skip


def derivatives(family: str) -> Callable[[Random], str]:
    """Derivatives of a member of a family beside differences of both sides and of one."""

    def judged(rng: Random) -> str:
        pairs = derivative_families.pairs_of(family, int(rng.integers(1 << 30)))
        if any(pair.outcome == "wrong" for pair in pairs):
            return WRONG
        return RIGHT if all(pair.verdict for pair in pairs) else DOUBTED

    return judged


KINDS: Mapping[str, Callable[[Random], str]] = {
    "flush": flush,
    "endless": endless,
    "resistance": lambda rng: theorem(
        test_resistance.test_the_torque_of_resistance_is_what_turns_the_body_beside_the_contact_force,
        int(rng.integers(1 << 30)),
    ),
    "gear": gear,
    "rod": rod,
    "tower": tower,
    "stack": stack,
    "poses": poses,
    "mesh": mesh,
    "shares": lambda rng: theorem(
        test_shares.test_the_share_of_each_pair_is_its_part_of_the_affine_pressure, int(rng.integers(1 << 30))
    ),
    "inputs": by_inputs,
    **{family: derivatives(family) for family in DERIVED},
    "plan": plan,
    "limit": limit,
    "no-gamma": no_gamma,
    "armature": armature_joints,
    "dense": dense,
    "blow": blow,
    "ring": ring,
    "spun": spun,
    "joined": joined,
    "foot": foot,
    "tip": tip,
    "boxes": boxes,
}


def member(kind: str, seed: int) -> str:
    return KINDS[kind](np.random.default_rng([seed, *kind.encode()]))


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--kind", nargs="+", default=list(KINDS), choices=KINDS)
    parser.add_argument("--count", type=int, default=100)
    parser.add_argument("--part", default="1/1", help="every N-th member from the I-th on")
    given = parser.parse_args()
    first, parts = map(int, given.part.split("/"))
    total: Counter[str] = Counter()
    for kind in given.kind:
        begun, counts = os.times(), Counter[str]()
        for seed in range(first - 1, given.count, parts):
            found = member(kind, seed)
            counts[found] += 1
            if found == WRONG:
                print(f"  {kind} {seed}: wrong and trusted", flush=True)
        seconds = sum(os.times()[:4]) - sum(begun[:4])
        print(f"{kind:10} " + "; ".join(f"{n} {name}" for name, n in sorted(counts.items()))
              + f"; {seconds:.1f} s", flush=True)  # fmt: skip
        total += counts
    print(f"all        {'; '.join(f'{n} {name}' for name, n in sorted(total.items()))}")
    return int(total[WRONG] > 0)


if __name__ == "__main__":
    raise SystemExit(main())
