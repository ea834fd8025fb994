# SPDX-License-Identifier: GPL-3.0-or-later
"""Chromium without a window: Debian's, by apt-get where it is missing. Pages run as files, without a network."""

from __future__ import annotations

import base64
import json
import os
import shutil
import subprocess
from pathlib import Path
from typing import Any

OPTIONS = (
    "--headless", "--no-sandbox", "--hide-scrollbars", "--use-angle=swiftshader", "--enable-unsafe-swiftshader",
    "--disable-background-networking", "--no-first-run", "--host-resolver-rules='MAP * ~NOTFOUND'",
)  # fmt: skip
PACKAGES = ("chromium", "fonts-dejavu-core")
# The handle that the page keeps to itself, and what goes wrong in it.
HANDLE = (
    "$page.start(",
    "globalThis.errors = []; onerror = (text) => errors.push(text); globalThis.handle = $page.start(",
)
DRAWN = """new Promise((resolve) => {
  const look = () => (document.body.dataset.drawn ? resolve(errors) : setTimeout(look, 20));
  look();
})"""


class UnavailableError(Exception):
    """This machine cannot have Chromium; one line says why."""


def set_up() -> str:
    """The path of Chromium."""
    if found := shutil.which("chromium"):
        return found
    if os.geteuid() != 0 or not Path("/usr/bin/apt-get").exists():
        message = "the page's tests need Chromium: install it, or run them as root on Debian"
        raise UnavailableError(message)
    apt = "/usr/bin/apt-get"
    for command in (["update"], ["install", "--yes", "--no-install-recommends", *PACKAGES]):
        done = subprocess.run([apt, *command], capture_output=True, text=True, check=False)
        if done.returncode:
            said = (done.stderr or done.stdout).strip().splitlines() or ["no reason given"]
            message = f"Chromium cannot be installed: apt-get {command[0]} failed: {said[-1]}"
            raise UnavailableError(message)
    return "chromium"


class Browser:
    """A running Chromium with one page, driven by its DevTools protocol over a pipe."""

    def __init__(self, profile: Path) -> None:
        to_read, self.write = os.pipe()
        self.read, to_write = os.pipe()
        options = " ".join([*OPTIONS, f"--user-data-dir={profile}"])
        command = f"exec {set_up()} {options} --remote-debugging-pipe 3<&{to_read} 4>&{to_write}"
        self.process = subprocess.Popen(
            ["/bin/bash", "-c", command],
            pass_fds=(to_read, to_write),
            stderr=subprocess.DEVNULL,
            stdout=subprocess.DEVNULL,
        )
        os.close(to_read)
        os.close(to_write)
        self.left, self.count, self.session = b"", 0, {}
        target = self.call("Target.createTarget", url="about:blank")["targetId"]
        self.session = {"sessionId": self.call("Target.attachToTarget", targetId=target, flatten=True)["sessionId"]}
        self.call("Page.enable")

    def close(self) -> None:
        self.process.kill()
        self.process.wait()
        os.close(self.read)
        os.close(self.write)

    def call(self, method: str, **parameters: Any) -> dict[str, Any]:
        """The result of a command; RuntimeError if it fails."""
        self.count += 1
        message = {"id": self.count, "method": method, "params": parameters} | self.session
        os.write(self.write, json.dumps(message).encode() + b"\0")
        while True:
            answer = self._next()
            if answer.get("id") == self.count:
                if "error" in answer:
                    raise RuntimeError(answer["error"]["message"])
                return answer["result"]

    def _next(self) -> dict[str, Any]:
        while b"\0" not in self.left:
            more = os.read(self.read, 1 << 20)
            if not more:
                message = "Chromium ended"
                raise RuntimeError(message)
            self.left += more
        one, _, self.left = self.left.partition(b"\0")
        return json.loads(one)

    def open(
        self,
        path: Path,
        fragment: str = "",
        size: tuple[int, int] = (1280, 800),
        scheme: str = "light",
        media: str = "",
    ) -> list[str]:
        """A page, drawn; returns what went wrong in it. The copy that is opened hands out its handle."""
        text = path.read_text(encoding="utf-8")
        assert text.count(HANDLE[0]) == 1
        copy = path.with_name(f"{path.stem}_opened.html")
        copy.write_text(text.replace(*HANDLE), encoding="utf-8")
        self.visit(copy.absolute().as_uri() + fragment, size, scheme, media)
        return self.run(f"return {DRAWN}")

    def visit(self, url: str, size: tuple[int, int] = (1280, 800), scheme: str = "light", media: str = "") -> None:
        """Any page, loaded."""
        features = [{"name": "prefers-color-scheme", "value": scheme}]
        self.call("Emulation.setEmulatedMedia", media=media, features=features)
        self.call(
            "Emulation.setDeviceMetricsOverride", width=size[0], height=size[1], deviceScaleFactor=1, mobile=False
        )
        self.call("Page.navigate", url="about:blank")
        self.call("Page.navigate", url=url)
        self.run("if (document.readyState !== 'complete') await new Promise((r) => addEventListener('load', r))")

    def run(self, script: str) -> Any:
        """What the body of an async function returns in the page."""
        found = self.call(
            "Runtime.evaluate", expression=f"(async () => {{ {script} }})()", awaitPromise=True, returnByValue=True
        )
        if "exceptionDetails" in found:
            raise RuntimeError(found["exceptionDetails"]["exception"]["description"])
        return found["result"].get("value")

    def picture(self, path: Path | None = None) -> bytes:
        """The page as a PNG; its bytes."""
        content = base64.b64decode(self.call("Page.captureScreenshot", format="png")["data"])
        if path:
            path.write_bytes(content)
        return content
