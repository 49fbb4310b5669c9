"""Work and precision of five scenes, here and in other simulators, in one table.

    python -m tests.benchmarks.fronts [--against A,B,..] [--knobs A,B,..] [--limit SECONDS] [SCENE..]

Runs `modelgen measure` on each scene and prints, beside the best error that each simulator reaches within 1 s
of CPU time per simulated second, how many times cheaper the scene runs here at no more error, and the digits
gained at no more cost; then the floor, and by how much a tighter tolerance ever raised the error. What was
measured before is remembered in `generated`; simulators that are not installed are left out.
"""

from __future__ import annotations

import argparse
from collections.abc import Iterator, Sequence
from math import log10

from rich.console import Console

from modelgen import measure, read
from modelgen.benchmark.measurement import Measurement
from modelgen.benchmark.peers import PEERS, PeerPoints
from modelgen.benchmark.work_precision_front import Point, front, is_measured, place
from modelgen.errors import ModelgenError
from tests.running import SCENES

SPANS: dict[str, float | None] = {  # s; None: the scene's own
    "ellipsoid_on_plane": None,
    "glass_on_table": None,
    "ellipsoid_on_ellipsoid": None,
    "rolling_disc": None,
    "linked_rings": 1.0,  # as far as chains of capsules follow
}
FINEST = 1e-12  # of the length: the digits are asked for down to here
PLAIN = ("method", "tolerance")  # what the ladder turns; all else at its first value


def installed(names: Sequence[str]) -> list[str]:
    """Those simulators that are here, asked by the first scene."""
    found = []
    for name in names:
        try:
            measured("ellipsoid_on_plane", [name], None, 1e-9)
        except ModelgenError as absent:
            print(absent)
        else:
            found.append(name)
    return found


def measured(
    name: str, against: Sequence[str], knobs: Sequence[str] | None, limit: float | None
) -> Measurement:
    scene = read(SCENES / f"{name}.toml")
    return measure(scene, until=SPANS.get(name), knobs=knobs, against=against, limit=limit)


def ladder(found: Measurement) -> list[Point]:
    """The tolerances from coarse to fine, with all other knobs at their first value."""
    first = {name: values[0] for name, values in found.knobs.items()}
    return [
        point
        for point in found.points
        if is_measured(point)
        and all(point.settings[name] == first[name] for name in point.settings if name not in PLAIN)
        and point.settings["method"] == first["method"]
    ]


def raised(points: Sequence[Point]) -> float:
    """The most by which a tighter tolerance raised an error that is above ten times the least of all."""
    errors = [place(point)[1] for point in points]
    above = [error for error in errors if error > 10 * min(errors)]
    return max((later / min(above[:k]) for k, later in enumerate(above) if k), default=0.0)


def rows(found: Measurement) -> Iterator[tuple[str, ...]]:
    for peer in found.peers:
        name = (found.subject.scene.name, peer.name)
        if peer.cannot:
            yield (*name, f"cannot: {'; '.join(peer.cannot)}", "", "", "", "")
        else:
            yield (*name, *comparison(peer, found.points))


def comparison(peer: PeerPoints, ours: Sequence[Point]) -> tuple[str, ...]:
    facts = peer.advantage(ours)
    if facts is None:
        return ("no error below 1 within 1 s per s", "", "", "", "")
    enough = min(6.0, log10(facts["error"] / FINEST))
    return (
        f"{facts['error']:.1e}",
        f"{facts['their_cost_ns_per_s'] / 1e3:.3g}",
        f"{facts['our_cost_ns_per_s'] / 1e3:.3g}",
        f"{facts['cheaper']:.0f}",
        f"{facts['digits']:.1f}{'' if facts['digits'] >= enough else ' (too few)'}",
    )


def printed(lines: Sequence[tuple[str, ...]]) -> None:
    widths = [max(len(line[k]) for line in lines if len(line[2]) < 30 or k < 2) for k in range(len(lines[0]))]
    for line in lines:
        print("  ".join(cell.ljust(width) for cell, width in zip(line, widths, strict=True)).rstrip())


def main() -> None:
    parser = argparse.ArgumentParser(description="Work and precision against other simulators")
    parser.add_argument("scenes", nargs="*", default=list(SPANS))
    parser.add_argument("--against", default=",".join(PEERS))
    parser.add_argument("--limit", type=float, default=None)
    parser.add_argument("--knobs", default=None, help="turned here and there; default: all that matter")
    given = parser.parse_args()
    knobs = given.knobs.split(",") if given.knobs else None
    peers = installed(given.against.split(","))
    console = Console(stderr=True)
    table: list[tuple[str, ...]] = [("scene", "peer", "best error", "us per s", "ours", "cheaper", "digits")]
    floors: list[tuple[str, ...]] = [
        ("scene", "error bar", "least error", "raised by", "kinstr per s at 1e-6")
    ]
    for name in given.scenes:
        with console.status(name):
            found = measured(name, peers, knobs, given.limit)
        table += rows(found)
        floors.append(floor(found))
    printed(table)
    print()
    printed(floors)


def floor(found: Measurement) -> tuple[str, ...]:
    steps, best = ladder(found), front(found.points)
    near = next((p for p in best if place(p)[1] <= 1e-6 and p.costs.get("instructions_per_s")), None)
    return (
        found.subject.scene.name,
        f"{found.reference['error']:.1e}",
        f"{place(best[-1])[1]:.1e}",
        f"{raised(steps):.2f}",
        f"{near.costs['instructions_per_s'] / 1e3:.0f}" if near else "-",
    )


if __name__ == "__main__":
    main()
