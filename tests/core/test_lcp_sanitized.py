"""The solvers alone in C programs, under the address and undefined-behaviour sanitizers, in each real."""

from __future__ import annotations

import subprocess
from collections.abc import Callable
from pathlib import Path

import pytest

DRIVERS = ("lcp_driver.c", "friction_driver.c")


@pytest.mark.cases(1)
@pytest.mark.parametrize("driver", DRIVERS)
@pytest.mark.parametrize(
    "real", [(), ("-DMG_REAL_FLOAT",), ("-DMG_REAL_LONG",)], ids=["double", "float", "long"]
)
def test_no_solver_leaves_its_scratch_or_claims_a_false_answer(
    driver: str, real: tuple[str, ...], lcp_compile: Callable[..., Path]
) -> None:
    sanitizers = ("-g", "-O0", "-fsanitize=address,undefined", "-fno-sanitize-recover=all")
    program = lcp_compile(Path(__file__).with_name(driver).read_text(), *sanitizers, *real)
    done = subprocess.run([program], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout + done.stderr
    assert done.stdout == "0 wrong\n"
