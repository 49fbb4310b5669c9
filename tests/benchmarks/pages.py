"""Pages of `inspect --format html` for each form of contact and each joint, looked at by a headless Chromium.

    python -m tests.benchmarks.pages FOLDER [KIND ...]

writes FOLDER/KIND.html. Where a Chromium is on the path it opens each page with its trees unfolded, says how
many formulas are there, how many of them have no extent or are wider than their line, and how much wider
than the window the page is; and it writes FOLDER/KIND.png, or FOLDER/KIND.1.png and so on, to look at.
"""

from __future__ import annotations

import re
import shutil
import subprocess
import sys
from pathlib import Path
from typing import NamedTuple

from modelgen import derive, require
from modelgen.joint.joint_equations import FORMS as JOINTS
from modelgen.report.formula_inspection import inspected, written
from tests.verification.test_status import PAIRS

WIDTH, TALLEST = 1300, 8000  # px of a picture
BROWSERS = ("chromium", "chromium-browser", "google-chrome")
KINDS = (
    *(f"{pair}:{form}" for form, pair in PAIRS.items()),
    *JOINTS,
    *(f"{joint}:motion" for joint, form in JOINTS.items() if form.given),
)
MEASURE = """<script>
const all = [...document.querySelectorAll('math')];
const box = all.map(x => x.getBoundingClientRect());
const lines = [...document.querySelectorAll('.eq')];
document.title = 'MEASURED ' + [all.length, box.filter(b => b.width < 2 || b.height < 2).length,
  lines.filter(x => x.scrollWidth > x.clientWidth + 1).length,
  document.documentElement.scrollWidth - window.innerWidth,
  Math.ceil(document.documentElement.scrollHeight)].join(' ');
</script>"""


class Look(NamedTuple):
    """What a browser says of a page."""

    formulas: int
    unrendered: int
    cut: int
    beyond: int  # px
    height: int  # px


def browser() -> str | None:
    return next(filter(None, map(shutil.which, BROWSERS)), None)


def chromium(program: str, page: Path, *options: str) -> str:
    fixed = ("--headless", "--no-sandbox", "--disable-gpu", "--hide-scrollbars")
    command = [program, *fixed, *options, page.resolve().as_uri()]
    return subprocess.run(command, check=True, capture_output=True, text=True).stdout


def looked_at(program: str, page: Path, *, unfolded: bool = True) -> Look:
    """The page measured in the browser, its trees unfolded or as they are."""
    copy, text = page.with_suffix(".measured.html"), page.read_text(encoding="utf-8")
    if unfolded:
        text = text.replace("<details>", "<details open>")
    copy.write_text(text.replace("</body>", f"{MEASURE}</body>"), encoding="utf-8")
    found = chromium(program, copy, f"--window-size={WIDTH},2000", "--dump-dom")
    copy.unlink()
    measured = re.search(r"MEASURED ([-\d ]+)", found)
    assert measured is not None
    return Look(*map(int, measured[1].split()))


def pictured(program: str, page: Path, height: int) -> list[Path]:
    """The page as it opens, in one picture or in several."""
    pictures = []
    for part in range(-(-height // TALLEST)):
        picture = page.with_suffix(f".{part + 1}.png" if height > TALLEST else ".png")
        shifted = page.with_suffix(".shifted.html")
        text = page.read_text(encoding="utf-8")
        style = f"<style>html{{margin-top:-{part * TALLEST}px}}</style></head>"
        shifted.write_text(text.replace("</head>", style, 1), encoding="utf-8")
        tall = min(TALLEST, height - part * TALLEST)
        chromium(program, shifted, f"--window-size={WIDTH},{tall}", f"--screenshot={picture}")
        shifted.unlink()
        pictures.append(picture)
    return pictures


def main(folder: Path, kinds: list[str]) -> None:
    folder.mkdir(parents=True, exist_ok=True)
    program = browser()
    for kind in kinds or KINDS:
        page = folder / f"{kind.partition(':')[2] or kind}.html"
        if kind.endswith(":motion"):
            page = folder / f"{kind.replace(':', '_')}.html"
        facts = inspected(kind, None, None, "html", (0, {}, None), lambda s: derive(require(s)))
        page.write_text(written(facts, "html"), encoding="utf-8")
        print(page)
        if program:
            print(looked_at(program, page))
            print(*pictured(program, page, looked_at(program, page, unfolded=False).height))


if __name__ == "__main__":
    main(Path(sys.argv[1]), sys.argv[2:])
