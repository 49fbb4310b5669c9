"""`--to casadi`: the folder loads in a process that cannot import modelgen."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import casadi as ca
import numpy as np

from modelgen import derive, read, require
from tests.c_compiler import needs_c
from tests.export.folders import exported
from tests.running import SCENES

BARRED = """
import sys

class Barred:
    def find_spec(self, name, *_):
        if name.split(".")[0] == "modelgen":
            raise ImportError(name)

sys.meta_path.insert(0, Barred())
sys.path.insert(0, sys.argv[1])
"""
ALONE = (
    BARRED
    + """
from load import load

functions = load()
name = sys.argv[2]
f = functions[name]
values = f(*[0.1 + 0.01 * k for k in range(f.n_in())])
values = values if isinstance(values, tuple) else (values,)
print(len(functions), *[repr(float(x)) for v in values for x in v.full().ravel()])
"""
)


@needs_c
def test_the_folder_loads_where_modelgen_cannot_be_imported(tmp_path: Path) -> None:
    folder = exported("ellipsoid_on_plane", "casadi", tmp_path)
    derivation = derive(require(read(SCENES / "ellipsoid_on_plane.toml")))
    formulas = derivation.formulas
    for function in (derivation.rhs(), next(each.function for each in formulas if each.role == "rates")):
        command = [sys.executable, "-c", ALONE, str(folder), function.name()]
        count, *told = subprocess.check_output(command, text=True, cwd=tmp_path).split()
        assert int(count) == len(formulas) + 1
        expected = [ca.DM(v).full().ravel() for v in function(*_given(function))]
        assert np.array(told, dtype=float) == approx(np.concatenate(expected))


def _given(function: ca.Function) -> list[float]:
    return [0.1 + 0.01 * k for k in range(function.n_in())]


def approx(values: np.ndarray) -> object:
    import pytest

    return pytest.approx(values, rel=1e-12, abs=1e-12)
