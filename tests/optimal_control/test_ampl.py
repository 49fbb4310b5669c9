"""Small models in AMPL against the same values by hand."""

from __future__ import annotations

from pathlib import Path

import casadi as ca
import numpy as np
import pytest

from tests.ampl.program import AmplProgram, read_program
from tests.ampl.tokens import AmplError

MODEL = """
# sets, parameters and tables
param n integer;
set I := 1..n;
set A within I cross I;
param cost {I} default 2;
param table {I, I} default 0;
param square {i in I} := if i == 1 then 1 else square[i-1] + 2*i - 1;
var x {i in I} >= 0, <= square[i], := 0.5*i;
var y {A};
var total = sum{i in I} x[i];
maximize value: -sum{i in I} cost[i]*x[i]^2 + sum{(i,j) in A: i < j} table[i,j]*y[i,j] - total;
subject to
  bound {i in I: i > 1}: -1 <= x[i] - x[i-1] <= 2;
  tie {(i,j) in A}: y[i,j] = x[i]*x[j];
  pair {(i,j) in A}: 0 <= x[i] complements y[i,j] <= 4;
  between: 0 <= x[1] <= 1 complements x[2] - 1;
"""
DATA = """
param n := 3;
set A := (1,2) (2,1) (1,3);
param cost := 1 5  3 7;
param table : 1 2 3 := 1 . 3 4  2 5 . 6;
let x[2] := 0.25;
"""


@pytest.fixture
def program(tmp_path: Path) -> AmplProgram:
    (tmp_path / "a.mod").write_text(MODEL)
    (tmp_path / "a.dat").write_text(DATA)
    return read_program(tmp_path / "a.mod", tmp_path / "a.dat")


def test_a_model_is_read_with_its_data(program: AmplProgram) -> None:
    read = program.program
    assert program.names == ["x_1", "x_2", "x_3", "y_1_2", "y_2_1", "y_1_3"]
    np.testing.assert_array_equal(program.start, [0.5, 0.25, 1.5, 0, 0, 0, 0, 0])
    np.testing.assert_array_equal(read.ubx[:3], [1, 4, 9])
    x, y, parts = np.array([0.5, 2.0, 3.0]), np.array([0.1, 0.2, 0.3]), np.array([0.4, 0.6])
    at = np.concatenate([x, y, parts])
    f, g, first, second = (
        np.array(each).ravel()
        for each in ca.Function("f", [read.x], [read.f, read.g, read.first, read.second])(at)
    )
    value = -(5 * 0.25 + 2 * 4 + 7 * 9) + 3 * 0.1 + 4 * 0.3 - 5.5
    assert f == pytest.approx([-value])
    assert g == pytest.approx([1.5 + 1, 2 - 1.5, 1 + 1, 2 - 1, 0.1 - 1, 0.2 - 1, 0.3 - 1.5, 1 - 0.4 + 0.6])
    assert first == pytest.approx([0.5, 2.0, 0.5, 0.5, 0.5])
    assert second == pytest.approx([4 - 0.1, 4 - 0.2, 4 - 0.3, 0.4, 0.6])


@pytest.mark.parametrize("statement", ["var z binary", "c: x complements y", "let z := 1", "param p := 3 +"])
def test_what_is_not_of_the_part_that_is_read_is_refused(statement: str, tmp_path: Path) -> None:
    (tmp_path / "b.mod").write_text(f"var x; var y; minimize f: x; {statement};")
    with pytest.raises((AmplError, KeyError)):
        read_program(tmp_path / "b.mod")
