"""The errata of Anitescu, Cremer and Potra, Formulating 3D contact dynamics problems, with evidence.

Each row is decided by computation: the printed and the corrected statement are evaluated on random contacts
and compared with what the motion itself, or the Jacobian of the extremality system, says. `_x` writes an
index.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np

from modelgen.verification.errata import (
    curve_errata,
    planar_contact_errata,
    singularity_errata,
    surface_errata,
)
from modelgen.verification.errata.surface_errata import Errors

AGREE = 1e-8  # largest error, of quantities of order 1, of a statement that holds
WRONG = 1e-3  # least error, somewhere, of a statement that does not

Kind = Literal["print", "print or scan", "definition", "claim"]
COUNTED = "counterexamples"  # the measure of a claim; others are errors


@dataclass(frozen=True, slots=True)
class Erratum:
    """A statement of the paper that does not hold as printed, and the one that does."""

    equation: str
    printed: str
    corrected: str
    kind: Kind
    measure: str
    decide: Callable[[int, int], Errors]  # (number of configurations, seed) -> errors of both


@dataclass(frozen=True, slots=True)
class Decision:
    """Result of the computation: largest errors, and number of configurations that agree."""

    erratum: Erratum
    n: int
    printed: float
    printed_agrees: int
    corrected: float
    corrected_agrees: int

    @property
    def confirmed(self) -> bool:
        """The corrected statement holds everywhere, the printed one fails somewhere."""
        return self.corrected_agrees == self.n and self.printed > WRONG

    def as_dict(self) -> dict[str, Any]:
        row = self.erratum
        return {
            "equation": row.equation, "printed": row.printed, "corrected": row.corrected, "kind": row.kind,
            "measure": row.measure, "n": self.n, "error_printed": self.printed,
            "agree_printed": self.printed_agrees, "error_corrected": self.corrected,
            "agree_corrected": self.corrected_agrees, "confirmed": self.confirmed,
        }  # fmt: skip


ERRATA = (
    Erratum(
        "(2.1)", "d/dε ‖P_f − P_o‖² = 0 defines extremal points",
        "g = (E_o^T(P_f − P_o), E_f^T N) = 0: parallel normals added; (2.1) is void where P_o = P_f",
        "definition", "what the Jacobian lacks of rank 4 at d = 0", surface_errata.extremal_points,
    ),
    Erratum("(3.1)", "N = (P_o − P_f)/d", "N = (P_f − P_o)/d", "print", "ḋ, m/s", surface_errata.normal),
    Erratum(
        "(3.11)", "+⟨ω_f×R_f l_f, ω_f×N⟩ − ⟨ω_o×R_o l_o, ω_o×N⟩",
        "−⟨ω_f×R_f l_f, ω_f×N⟩ + ⟨ω_o×R_o l_o, ω_o×N⟩", "print", "d̈, m/s²", surface_errata.gap_bias,
    ),
    Erratum(
        "(4.4), (4.12), (4.23), (4.28), (B.7)", "ḋ = +v_z", "ḋ = −v_z", "print", "ḋ, m/s",
        surface_errata.gap_rate,
    ),
    Erratum(
        "(4.5)", "Ṅ = ω_o×N + H_o K_o M_o α̇_o, a 3×3 matrix times a 2-vector",
        "Ṅ = ω_o×N + [x_o y_o] K_o M_o α̇_o", "definition", "Ṅ, 1/s", surface_errata.normal_rate,
    ),
    Erratum(
        "(4.11)", "… = R_ψ(k_o sin φ_o l̇_o, −τ_o l̇_o − φ̇_o)", "… = −R_ψ(k_o sin φ_o l̇_o, −τ_o l̇_o − φ̇_o)",
        "print or scan", "l̇ m/s, φ̇ rad/s", curve_errata.contact_frames,
    ),
    Erratum(
        "(C.18), row z", "−k_o cos φ_o l̇_o", "+k_o cos φ_o l̇_o, as in (4.13)", "print or scan",
        "ψ̇, rad/s", curve_errata.spin_row,
    ),
    Erratum(
        "(4.15)", "N = T_o×T_f/|T_o×T_f|, tangents “appropriate”", "N = −sgn(sin ψ) T_o×T_f/|T_o×T_f|",
        "definition", "N", curve_errata.crossed_normal,
    ),
    Erratum(
        "(4.17), (4.18)", "Ṫ_o = ω_o×T_o + k_o N_o", "Ṫ_o = ω_o×T_o + k_o N_o l̇_o", "print", "Ṫ, 1/s",
        curve_errata.tangent_rate,
    ),
    Erratum(
        "(4.20)", "l̇_f = −v_x + cot ψ v_y", "l̇_f = −v_x − cot ψ v_y", "print", "l̇, m/s",
        curve_errata.slide_of_f,
    ),
    Erratum(
        "(4.21) with (4.25)", "ξ = … − R_ψ(k_o sin φ_o l̇_o, −τ_o l̇_o)",
        "ξ = … + R_ψ(k_o sin φ_o l̇_o, −τ_o l̇_o)", "print or scan", "φ̇, rad/s", curve_errata.turn_of_o,
    ),
    Erratum(
        "(4.22)", "φ̇_f = −ξ_y + cot ψ ξ_x", "φ̇_f = ξ_y − cot ψ ξ_x", "print", "φ̇, rad/s",
        curve_errata.turn_of_f,
    ),
    Erratum(
        "(4.31)", "… = β/R", "… = −β/R, as in (4.27)", "print or scan", "l̇, m/s", curve_errata.sphere_row
    ),
    Erratum(
        "(4.33)", "regular if 1/R − k_f sin φ_f (1 + d/R) ≠ 0", "regular if 1/R + k_f sin φ_f (1 + d/R) ≠ 0",
        "print", "|S| R where said singular", singularity_errata.sphere_condition,
    ),
    Erratum(
        "(4.35)", "regular if r̃ ≠ −(R + d), r̃ = −1/(k_f sin φ_f)", "regular if r̃ ≠ R + d", "print",
        "|S| R where said singular", singularity_errata.radius_condition,
    ),
    Erratum(
        "(4.32), (4.33)", "singular if and only if, on any surface",
        "on spheres; else S = 0, and 1 + d k_1 = 0 gives S = k_1 (1 + d k_2) cos²∠(t_f, dir_1)", "claim",
        "|S| where said singular, 1/m", singularity_errata.only_for_spheres,
    ),
    Erratum(
        "Section 4.1.2", "two strictly convex surfaces: K_f + K̃_o + d K̃_o K_f positive definite",
        "its determinant is positive for d ≥ 0; it need not be definite", "claim", COUNTED,
        singularity_errata.convex_pairs,
    ),
    Erratum(
        "Section 4.2.2", "two curves: singular where sin ψ = 0",
        "for d = 0 only; in general D = (1 + dκ_o)(1 + dκ_f) − cos²ψ = 0", "claim", "|D| where said singular",
        singularity_errata.parallel_tangents,
    ),
    Erratum(
        "Section 5.3", "φ_f = π of the rim of an upright glass", "φ_f = 0 or π, by the sense of the rim",
        "claim", "φ_f, rad", planar_contact_errata.upright_glass,
    ),
    Erratum(
        "Corollary 5.2", "three positive forces λ̃_j > 0", "three forces λ̃_j ≥ 0", "claim", COUNTED,
        planar_contact_errata.three_forces,
    ),
    Erratum(
        "Appendix E.1, Lemma B.1", "M = diag(|c_u|, |c_v|), axes c_u/|c_u|, c_v/|c_v|",
        "M upper triangular, axes by Gram–Schmidt; as printed for c_u·c_v = 0 only", "definition",
        "η̇, 1/s", surface_errata.orthogonal_charts,
    ),
    Erratum(
        "Theorems 4.3, 4.6", "l is a natural parameter: ṫ = l̇", "ṫ = l̇/|c′| for any regular parameter",
        "definition", "ṫ, 1/s", curve_errata.arc_length,
    ),
)  # fmt: skip


def decide(row: Erratum, n: int, seed: int) -> Decision:
    """Evaluates both statements of a row on n random configurations, or a multiple of n that its kind has."""
    printed, corrected = row.decide(n, seed)
    return Decision(
        row, len(printed), float(np.max(printed)), int(np.sum(printed < AGREE)), float(np.max(corrected)),
        int(np.sum(corrected < AGREE)),
    )  # fmt: skip


def decided(n: int, seed: int) -> tuple[Decision, ...]:
    """All rows."""
    return tuple(decide(row, n, seed) for row in ERRATA)
