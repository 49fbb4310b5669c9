"""Parts of HTML pages: their style, badges of a status, tables."""

from __future__ import annotations

from collections.abc import Sequence
from html import escape

STYLE = """
body{font:16px/1.5 Georgia,'DejaVu Serif',serif;max-width:76rem;margin:2rem auto;padding:0 1.5rem;
color:#1b1b1b}h1,h2,h3{font-family:'DejaVu Sans',Helvetica,sans-serif;line-height:1.2}
h2{margin-top:3rem;border-bottom:2px solid #345}h3{margin-top:2.2rem;overflow-wrap:anywhere}
table{border-collapse:collapse;margin:1rem 0;font-size:.88rem}
td,th{border-bottom:1px solid #ccd;padding:.25rem .6rem;text-align:left;vertical-align:top;
overflow-wrap:break-word}th{background:#eef2f7}td.n{text-align:right;white-space:nowrap}
pre{background:#f5f6f8;padding:.8rem;white-space:pre-wrap}
math{font-size:1.02rem;font-family:'STIX Two Math','STIX Math','Latin Modern Math','Cambria Math',math}
mfrac>*{math-style:normal}mtd{padding:.15em .35em}.lines mtd{text-align:left;padding:.3em .2em}
.eq{margin:.1rem 0;display:inline-block;vertical-align:middle;max-width:calc(100% - 9rem);
overflow-x:auto;overflow-y:hidden;padding:.2rem 0}
.tested,.proved,.failed,.open{padding:.05rem .5rem;border-radius:.6rem;color:#fff;
font:bold .8rem 'DejaVu Sans',sans-serif;white-space:nowrap}.tested{background:#2b6cb0}
.proved{background:#2f7d4a}.failed{background:#c0262d}.open{background:#777}
details{margin:.15rem 0 .15rem 1.1rem;border-left:2px solid #dde3ea;padding-left:.7rem}
summary{cursor:pointer}.v{color:#566;font-size:.85rem}div.leaf{margin:.15rem 0 .15rem 2.2rem}
figure{margin:1rem 0}
""".strip()


def document(title: str, style: str, body: str) -> str:
    """A whole HTML document; `body` is HTML."""
    head = f'<meta charset="utf-8"><title>{escape(title)}</title><style>{style}</style>'
    return f'<!DOCTYPE html><html lang="en"><head>{head}</head><body>{body}</body></html>\n'


def badge(status: str) -> str:
    """A status with the colour of its kind."""
    known = status if status in ("tested", "proved", "failed") else "open"
    return f'<span class="{known}">{escape(status)}</span>'


def table(head: Sequence[str], rows: Sequence[Sequence[str]], numeric: Sequence[int] = ()) -> str:
    """A table; cells are HTML already, those of the columns `numeric` stand to the right."""
    top = "".join(f"<th>{escape(cell)}</th>" for cell in head)
    lines = "".join(
        "<tr>"
        + "".join(f"<td{' class=n' if k in numeric else ''}>{cell}</td>" for k, cell in enumerate(row))
        + "</tr>"
        for row in rows
    )
    return f"<table><thead><tr>{top}</tr></thead><tbody>{lines}</tbody></table>"


def sections_of(sections: Sequence[tuple[str, str, str]]) -> str:
    """Contents and sections (key, title, HTML); empty ones are left out."""
    filled = [section for section in sections if section[2]]
    contents = " · ".join(f'<a href="#{key}">{escape(title)}</a>' for key, title, _ in filled)
    return f"<p>{contents}</p>" + "".join(
        f'<h2 id="{key}">{escape(title)}</h2>{text}' for key, title, text in filled
    )
