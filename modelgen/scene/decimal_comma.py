"""Numbers with a decimal comma, which are written with a point."""

from __future__ import annotations

import re

DECIMAL_COMMA = re.compile(r"[-+]?\d[\d.]*,\d+(?:[eE][-+]?\d+)?(?![\w,])")


def with_point(number: str) -> tuple[str, str]:
    """What was found, and the remedy."""
    return f"the number {number} with a decimal comma", f"write {number.replace('.', '').replace(',', '.')}"
