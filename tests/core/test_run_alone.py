"""The core alone, with hand-written kinds: every real type; sanitizers as a study."""

from __future__ import annotations

import subprocess
from pathlib import Path

import pytest

from tests.c_compiler import CC
from tests.core.compiling import CORE, includes

HERE = Path(__file__).parent
E, G, HEIGHT = 0.7, 9.81, 1.0
FALL = (2 * HEIGHT / G) ** 0.5
REAL_TYPES = {"double": [], "long double": ["-DMG_REAL_LONG"]}
SANITIZERS = ["-g", "-fsanitize=address,undefined"]


def impact_times(count: int) -> list[float]:
    """Closed form: the first fall, then flights of 2 e^n v / g."""
    times = [FALL]
    for n in range(1, count):
        times.append(times[-1] + 2 * E**n * FALL)
    return times


def run_driver(folder: Path, flags: list[str]) -> list[list[str]]:
    unit = folder / "unit.c"
    before, after = (f'#include "{HERE / name}"\n' for name in ("bouncing_kinds.c", "bouncing_driver.c"))
    unit.write_text(before + includes() + after)
    command = [*CC, "-std=c99", "-O0", "-Wall", "-Wextra", "-Werror"]
    command += [*flags, f"-I{CORE}", str(unit), "-o", str(folder / "driver"), "-lm"]
    subprocess.run(command, check=True)
    done = subprocess.run([folder / "driver"], check=True, capture_output=True, text=True)
    return [line.split() for line in done.stdout.splitlines()]


@pytest.mark.parametrize(
    ("real", "flags"),
    [
        ("double", []),
        pytest.param("double", SANITIZERS, marks=pytest.mark.slow),
        pytest.param("long double", SANITIZERS, marks=pytest.mark.slow),
    ],
)
def test_a_bouncing_ball_comes_to_rest_at_the_right_time(tmp_path: Path, real: str, flags: list[str]) -> None:
    lines = run_driver(tmp_path, [*REAL_TYPES[real], *flags])
    events, end = lines[:-1], lines[-1]
    times = [float(t) for kind, t in events]
    assert times[:20] == pytest.approx(impact_times(20), abs=1e-11)
    assert {kind for kind, _ in events[:-1]} == {"0"}
    assert events[-1][0] == "1"
    assert times[-1] == pytest.approx(FALL * (1 + E) / (1 - E), abs=1e-9)
    assert float(end[2]) == pytest.approx(0.1, abs=1e-15)
    assert float(end[3]) == pytest.approx(G, rel=1e-12)
    assert float(end[4]) < 1e-11
