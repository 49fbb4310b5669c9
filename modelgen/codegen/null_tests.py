"""CasADi's C text with one test for null pointers at each entry."""

from __future__ import annotations

import re
from collections.abc import Mapping

ENTRY = re.compile(  # the exported function of a kernel: head, name, internal function
    r"(^CASADI_SYMBOL_EXPORT int (mg_\w+)\([^\n]*\)\{)\n"
    r"  return (\w+)\(arg, res, iw, w, mem\);\n",
    re.MULTILINE,
)


def without_null_tests(text: str, counts: Mapping[str, tuple[int, int]]) -> str:
    """CasADi's C text with one test for null pointers at each exported entry in place of one an element.

    The core passes no null pointers; callers from outside may, by CasADi's interface, for inputs that are
    zero and outputs that they do not want. `counts`: inputs and outputs by the kernel's name.
    """
    text = re.sub(r"arg\[(\d+)\]\? arg\[\1\]\[(\d+)\] : 0", r"arg[\1][\2]", text)
    text = re.sub(r"if \(res\[(\d+)\]!=0\) res\[\1\]", r"res[\1]", text)
    assert "]? arg[" not in text
    assert "]!=0)" not in text

    def entry(match: re.Match[str]) -> str:
        head, name, internal = match.groups()
        n_in, n_out = counts[name]
        call = f"mg_call({internal}, {n_in}, {n_out}, arg, res)"
        return f"{head}\n  (void)iw, (void)w, (void)mem;\n  return {call};\n"

    return ENTRY.sub(entry, text)
