"""A browser without a window, driven through its pipe of DevTools: pages, pictures, messages, requests."""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import time
from base64 import b64decode
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from io import BytesIO
from pathlib import Path
from select import select
from typing import Any

import numpy as np
import pytest

BROWSER = next(filter(None, map(shutil.which, ("chromium", "chromium-browser", "google-chrome"))), None)
needs_browser = pytest.mark.skipif(BROWSER is None, reason="no Chromium is installed")
FLAGS = (
    *(
        "--headless",
        "--no-sandbox",
        "--disable-gpu",
        "--use-angle=swiftshader",
        "--enable-unsafe-swiftshader",
    ),
    *("--disable-quic", "--no-first-run", "--disable-background-networking", "--disable-component-update"),
    *("--disable-sync", "--disable-extensions", "--hide-scrollbars", "--remote-debugging-pipe"),
)
PATIENCE = 60.0  # s, for an answer


class Browser:
    """One page. `complaints` are errors and warnings of its console, `requests` what it asked for."""

    def __init__(self, into: int, out: int) -> None:
        self._into, self._out = into, out
        self._rest, self._count = b"", 0
        self.complaints: list[str] = []
        self.requests: list[str] = []
        target = self.ask("Target.createTarget", {"url": "about:blank"})["targetId"]
        self._session = self.ask("Target.attachToTarget", {"targetId": target, "flatten": True})["sessionId"]
        for room in ("Page", "Runtime", "Log", "Network"):
            self.ask(f"{room}.enable")

    def ask(self, method: str, given: dict[str, Any] | None = None) -> dict[str, Any]:
        """The answer of the browser to a command of its protocol."""
        self._count += 1
        message: dict[str, Any] = {"id": self._count, "method": method, "params": given or {}}
        if hasattr(self, "_session"):
            message["sessionId"] = self._session
        os.write(self._into, json.dumps(message).encode() + b"\0")
        end = time.monotonic() + PATIENCE
        while time.monotonic() < end:
            found = self._next()
            if found.get("id") == self._count:
                assert "error" not in found, found
                return dict(found["result"])
            self._note(found.get("method"), found.get("params", {}))
        raise AssertionError(f"no answer to {method}")

    def _next(self) -> dict[str, Any]:
        while b"\0" not in self._rest:
            assert select([self._out], [], [], PATIENCE)[0], "the browser says nothing"
            part = os.read(self._out, 1 << 20)
            assert part, "the browser ended"
            self._rest += part
        message, self._rest = self._rest.split(b"\0", 1)
        return dict(json.loads(message))

    def _note(self, event: object, told: dict[str, Any]) -> None:
        if event == "Runtime.consoleAPICalled" and told["type"] in ("error", "warning", "assert"):
            self.complaints.append(str([each.get("value", each.get("description")) for each in told["args"]]))
        elif event == "Runtime.exceptionThrown":
            self.complaints.append(str(told["exceptionDetails"]))
        elif event == "Log.entryAdded" and told["entry"]["level"] in ("error", "warning"):
            self.complaints.append(told["entry"]["text"])
        elif event == "Network.requestWillBeSent":
            self.requests.append(told["request"]["url"])

    @property
    def serious(self) -> list[str]:
        """The complaints, less what a driver without a graphics card says of its speed."""
        return [each for each in self.complaints if "GL Driver Message" not in each]

    def open(self, address: str, width: int = 1280, height: int = 800) -> None:
        sizes = {"width": width, "height": height, "deviceScaleFactor": 1, "mobile": False}
        self.ask("Emulation.setDeviceMetricsOverride", sizes)
        self.ask("Page.navigate", {"url": address})
        self.until("document.readyState === 'complete'")
        self.settle()

    def value(self, expression: str) -> Any:
        """The value of a JavaScript expression in the page; a promise is awaited."""
        given = {"expression": expression, "returnByValue": True, "awaitPromise": True}
        found = self.ask("Runtime.evaluate", given)
        assert "exceptionDetails" not in found, found
        return found["result"].get("value")

    def until(self, condition: str, patience: float = PATIENCE) -> None:
        end = time.monotonic() + patience
        while not self.value(condition):
            assert time.monotonic() < end, f"never: {condition}"
            time.sleep(0.05)

    def settle(self) -> None:
        """Two pictures of the page later."""
        self.value("new Promise(r => requestAnimationFrame(() => requestAnimationFrame(() => r(1))))")

    def shot(self, path: Path | None = None) -> np.ndarray:
        """(rows, columns, 3) the page as it is seen."""
        from PIL import Image

        content = b64decode(self.ask("Page.captureScreenshot", {"format": "png"})["data"])
        if path is not None:
            path.write_bytes(content)
        return np.asarray(Image.open(BytesIO(content)).convert("RGB"), dtype=int)

    def press(self, key: str, code: int) -> None:
        """Press a key and let it go, as a person does."""
        text = {"text": key} if len(key) == 1 else {}
        given = {"key": key, "code": "Space" if key == " " else key, "windowsVirtualKeyCode": code}
        self.ask("Input.dispatchKeyEvent", {"type": "keyDown", **given, **text})
        self.ask("Input.dispatchKeyEvent", {"type": "keyUp", **given})

    def drag(self, start: tuple[float, float], end: tuple[float, float]) -> None:
        """Press the mouse at one place of the page and let it go at another."""
        for kind, (x, y) in (("mousePressed", start), ("mouseMoved", end), ("mouseReleased", end)):
            given = {"type": kind, "x": x, "y": y, "button": "left", "buttons": 1, "clickCount": 1}
            self.ask("Input.dispatchMouseEvent", given)


@contextmanager
def browser(folder: Path) -> Iterator[Browser]:
    """A browser with a new profile in a folder."""
    assert BROWSER is not None
    (from_us, into), (out, to_us) = os.pipe(), os.pipe()

    def connect() -> None:  # the browser reads from 3 and writes to 4
        os.dup2(from_us, 100)
        os.dup2(to_us, 101)
        os.dup2(100, 3)
        os.dup2(101, 4)

    running = subprocess.Popen(
        [BROWSER, *FLAGS, f"--user-data-dir={folder / 'profile'}"],
        stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, preexec_fn=connect, close_fds=False,
    )  # fmt: skip
    os.close(from_us)
    os.close(to_us)
    try:
        yield Browser(into, out)
    finally:
        with suppress(OSError, AssertionError):
            os.write(into, json.dumps({"id": 0, "method": "Browser.close"}).encode() + b"\0")
        try:
            running.wait(10)
        except subprocess.TimeoutExpired:
            running.kill()
        os.close(into)
        os.close(out)
