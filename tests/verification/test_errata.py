"""The paper's errors are errors, and their corrections are right: every row, on random contacts."""

from __future__ import annotations

import pytest

from modelgen.verification.errata.errata_table import ERRATA, Erratum, decide

EQUATIONS = {
    "(2.1)", "(3.1)", "(3.11)", "(4.4), (4.12), (4.23), (4.28), (B.7)", "(4.5)", "(4.11)", "(C.18), row z",
    "(4.15)", "(4.17), (4.18)", "(4.20)", "(4.21) with (4.25)", "(4.22)", "(4.31)", "(4.33)", "(4.35)",
    "(4.32), (4.33)", "Section 4.1.2", "Section 4.2.2", "Section 5.3", "Corollary 5.2",
    "Appendix E.1, Lemma B.1", "Theorems 4.3, 4.6",
}  # fmt: skip


def test_every_known_erratum_has_a_row() -> None:
    assert {row.equation for row in ERRATA} == EQUATIONS
    assert len(ERRATA) == len(EQUATIONS)


@pytest.mark.parametrize("row", ERRATA, ids=lambda row: row.equation)
@pytest.mark.parametrize("seed", [1, 2])
def test_print_fails_and_correction_holds(row: Erratum, seed: int) -> None:
    decision = decide(row, 24, seed)
    assert decision.n >= 8
    assert decision.confirmed
    assert decision.corrected < 1e-8
    assert decision.printed_agrees < decision.n


def test_a_correction_that_is_wrong_is_not_confirmed() -> None:
    row = next(row for row in ERRATA if row.equation == "(3.11)")
    turned = Erratum(
        row.equation, row.corrected, row.printed, row.kind, row.measure,
        lambda n, seed: tuple(reversed(row.decide(n, seed))),  # type: ignore[arg-type]
    )  # fmt: skip
    assert not decide(turned, 24, 1).confirmed
