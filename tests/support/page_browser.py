"""A page of HTML in Chromium without a window, driven over a pair of pipes."""

import base64
import json
import os
import subprocess
import tempfile
from contextlib import ExitStack

from site_pages import browser

_FLAGS = (
    "--headless=new",
    "--no-sandbox",
    "--remote-debugging-pipe",
    "--use-angle=swiftshader",  # WebGL by the processor
    "--enable-unsafe-swiftshader",
    "--hide-scrollbars",
)


class PageBrowser:
    """Chromium with one page.

    Attributes
    ----------
    requests : list of str
        Addresses of all that was asked for.
    complaints : list of str
        Errors of scripts, and what the policy of the page has refused.
    """

    def __init__(self):
        self.requests, self.complaints = [], []
        self._stack, self._count, self._waiting = ExitStack(), 0, b""

    def __enter__(self):
        profile = tempfile.TemporaryDirectory(ignore_cleanup_errors=True)
        self._stack.enter_context(profile)
        orders, self._orders = os.pipe()
        self._replies, replies = os.pipe()

        def connect():  # Chromium reads from 3 and writes to 4
            os.dup2(os.dup(orders), 3)
            os.dup2(os.dup(replies), 4)

        words = [browser(), *_FLAGS, f"--user-data-dir={profile.name}", "about:blank"]
        quiet = subprocess.DEVNULL
        self._process = subprocess.Popen(
            words, stdin=quiet, stdout=quiet, stderr=quiet, close_fds=False, preexec_fn=connect
        )
        os.close(orders)
        os.close(replies)
        self._session = None
        targets = self.ask("Target.getTargets")["targetInfos"]
        page = next(each["targetId"] for each in targets if each["type"] == "page")
        self._session = self.ask("Target.attachToTarget", targetId=page, flatten=True)["sessionId"]
        for domain in ("Page", "Runtime", "Network", "Log"):
            self.ask(f"{domain}.enable")
        return self

    def __exit__(self, *_):
        self._process.kill()
        self._process.wait()
        os.close(self._orders)
        os.close(self._replies)
        self._stack.close()

    def _message(self):
        while b"\0" not in self._waiting:
            portion = os.read(self._replies, 1 << 20)
            if not portion:
                raise EOFError("Chromium has ended.")
            self._waiting += portion
        head, _, self._waiting = self._waiting.partition(b"\0")
        message = json.loads(head)
        method, told = message.get("method"), message.get("params", {})
        if method == "Network.requestWillBeSent":
            self.requests.append(told["request"]["url"])
        elif method == "Runtime.exceptionThrown":
            self.complaints.append(json.dumps(told["exceptionDetails"])[:500])
        elif method == "Log.entryAdded":
            self.complaints.append(told["entry"]["text"])
        return message

    def ask(self, method, **parameters):
        """Result of a command of the DevTools protocol."""
        self._count += 1
        message = {"id": self._count, "method": method, "params": parameters}
        if self._session is not None:
            message["sessionId"] = self._session
        os.write(self._orders, json.dumps(message).encode() + b"\0")
        while True:
            told = self._message()
            if told.get("id") == self._count:
                assert "error" not in told, told
                return told["result"]

    def open(self, path, scheme="light", size=(1280, 900), media="", has_scripts=True):
        """Open a file as a click on it does."""
        features = [{"name": "prefers-color-scheme", "value": scheme}]
        self.ask("Emulation.setEmulatedMedia", media=media, features=features)
        width, height = size
        self.ask(
            "Emulation.setDeviceMetricsOverride",
            width=width,
            height=height,
            deviceScaleFactor=1,
            mobile=False,
        )
        self.ask("Emulation.setScriptExecutionDisabled", value=not has_scripts)
        self.ask("Page.navigate", url=path.as_uri())
        while self._message().get("method") != "Page.loadEventFired":
            pass

    def value(self, code):
        """Value of an expression in the page, or what it promises."""
        found = self.ask("Runtime.evaluate", expression=code, awaitPromise=True, returnByValue=True)
        assert "exceptionDetails" not in found, found
        return found["result"].get("value")

    def picture(self):
        """PNG of the whole page."""
        told = self.ask("Page.captureScreenshot", captureBeyondViewport=True)
        return base64.b64decode(told["data"])

    def press(self, key, code=None):
        """Press a key."""
        told = {"key": key, "code": code or key}
        self.ask("Input.dispatchKeyEvent", type="keyDown", **told)
        self.ask("Input.dispatchKeyEvent", type="keyUp", **told)

    def drag(self, start, end):
        """Drag with the left button."""
        for kind, (x, y) in (("mousePressed", start), ("mouseMoved", end), ("mouseReleased", end)):
            self.ask("Input.dispatchMouseEvent", type=kind, x=x, y=y, button="left", buttons=1, clickCount=1)
