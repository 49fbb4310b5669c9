"""Pages of `inspect --format html` for one pair of each form, and their pictures by a headless Chromium.

    python -m tests.benchmarks.pages FOLDER

writes FOLDER/KIND.html and, where `chromium` or `google-chrome` is on the path, FOLDER/KIND.png to look at.
"""

from __future__ import annotations

import shutil
import subprocess
import sys
from pathlib import Path

from modelgen import derive, require
from modelgen.report.inspection import inspected, written
from tests.evidence.test_status import PAIRS

HEIGHT = 9000  # px of a picture


def main(folder: Path) -> None:
    folder.mkdir(parents=True, exist_ok=True)
    browser = next(filter(None, map(shutil.which, ("chromium", "chromium-browser", "google-chrome"))), None)
    for form, pair in PAIRS.items():
        page = folder / f"{form}.html"
        facts = inspected(f"{pair}:{form}", None, None, "html", (0, {}, None), lambda s: derive(require(s)))
        page.write_text(written(facts, "html"), encoding="utf-8")
        print(page)
        if browser:
            picture = page.with_suffix(".png")
            subprocess.run(
                [
                    browser, "--headless", "--no-sandbox", "--disable-gpu", "--hide-scrollbars",
                    f"--window-size=1300,{HEIGHT}", f"--screenshot={picture}", page.resolve().as_uri(),
                ],
                check=True, capture_output=True,
            )  # fmt: skip
            print(picture)


if __name__ == "__main__":
    main(Path(sys.argv[1]))
