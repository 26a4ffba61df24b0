"""Look at every page of the built site in a headless browser: ``python tests/site_pages.py build/docs``.

Each page is laid out 1280 and 390 pixels wide, in light and dark. Named are pages wider than the window,
pictures that are broken, and text with less contrast than WCAG AA asks for. It needs Chromium.
"""

from __future__ import annotations

import http.server
import json
import shutil
import subprocess
import sys
import tempfile
import threading
from functools import partial
from pathlib import Path
from typing import Any

WIDTHS, SCHEMES = (1280, 390), ("light", "dark")
_PATIENCE = 1200  # s, for all pages
_LOOK = """<!doctype html><iframe id=f style="border:0"></iframe><script>
const pages = PAGES, widths = WIDTHS, schemes = SCHEMES, frame = document.getElementById("f"), said = [];
function rgb(c) { const m = c.match(/[\\d.]+/g).map(Number); return m.length < 4 ? [...m, 1] : m; }
function over(a, b) { return [0, 1, 2].map(k => a[k] * a[3] + b[k] * (1 - a[3])); }
function light(c) { const l = c.slice(0, 3).map(v => (v /= 255) <= 0.03928 ? v / 12.92 : ((v + 0.055) / 1.055) ** 2.4);
  return 0.2126 * l[0] + 0.7152 * l[1] + 0.0722 * l[2]; }
function background(e, w) { const stack = [];
  for (; e; e = e.parentElement) { const c = rgb(w.getComputedStyle(e).backgroundColor);
    if (c[3] > 0) stack.push(c); if (c[3] === 1) break; }
  return stack.reverse().reduce((below, c) => over(c, below), [255, 255, 255]); }
function dim(d, w) { const found = new Set();
  const walker = d.createTreeWalker(d.querySelector("main") || d.body, NodeFilter.SHOW_TEXT);
  while (walker.nextNode()) { const e = walker.currentNode.parentElement, text = walker.currentNode.data.trim();
    if (!text || !e.getClientRects().length || !e.checkVisibility({opacityProperty: true})) continue;
    const style = w.getComputedStyle(e), back = background(e, w), ink = over(rgb(style.color), back);
    const [a, b] = [light(ink), light(back)].sort((x, y) => y - x), ratio = (a + 0.05) / (b + 0.05);
    const size = parseFloat(style.fontSize), large = size >= 24 || (size >= 18.66 && style.fontWeight >= 700);
    if (ratio < (large ? 3 : 4.5) - 0.01) found.add(`${ratio.toFixed(2)} ${style.color} on ${back.map(Math.round)} .${e.className}: ${text.slice(0, 30)}`); }
  return [...found].slice(0, 4); }
async function look() {
  for (const page of pages) {
    await new Promise(done => { frame.onload = done; frame.src = page; });
    const d = frame.contentDocument, w = frame.contentWindow;
    const images = [...d.images]; images.forEach(i => { i.loading = "eager"; });
    await Promise.all(images.map(i => i.decode().catch(() => 0)));
    for (const i of images) if (!i.naturalWidth) said.push(`${page}: broken picture ${i.src}`);
    for (const scheme of schemes) { d.documentElement.dataset.theme = scheme; d.documentElement.dataset.mode = scheme;
      await new Promise(r => setTimeout(r, 30));
      for (const width of widths) { frame.width = width; frame.height = 900;
        await new Promise(r => setTimeout(r, 30));
        const root = d.scrollingElement, wide = root.scrollWidth;
        if (wide > width) said.push(`${page}: ${wide} wide at ${width}, ${scheme}`); }
      for (const line of dim(d, w)) said.push(`${page}, ${scheme}: contrast ${line}`); } }
  await fetch("/said", {method: "POST", body: JSON.stringify(said)}); }
look().catch(e => fetch("/said", {method: "POST", body: JSON.stringify(["stopped: " + e])}));
</script>"""


class _Findings:
    """The page that looks at all others, and what it has found."""

    def __init__(self, pages: list[str]) -> None:
        self.page, self.lines, self.ended = _LOOK, [""], threading.Event()
        for name, value in (("PAGES", pages), ("WIDTHS", WIDTHS), ("SCHEMES", SCHEMES)):
            self.page = self.page.replace(name, json.dumps(value), 1)


class _Handler(http.server.SimpleHTTPRequestHandler):
    """Serves the site and the page that looks at it, and takes what that finds."""

    def __init__(self, findings: _Findings, *words: Any, **more: Any) -> None:
        self._findings = findings
        super().__init__(*words, **more)

    def do_GET(self) -> None:
        """Send a file, or the page."""
        if self.path != "/look":
            super().do_GET()
            return
        self.send_response(200)
        self.send_header("Content-Type", "text/html; charset=utf-8")
        self.end_headers()
        self.wfile.write(self._findings.page.encode())

    def do_POST(self) -> None:
        """Take the findings."""
        self._findings.lines = json.loads(self.rfile.read(int(self.headers["Content-Length"])))
        self.send_response(204)
        self.end_headers()
        self._findings.ended.set()

    def log_message(self, *_: object) -> None:
        """Be quiet."""


def browser() -> str | None:
    """Path of Chromium, if it is installed."""
    return next(filter(None, map(shutil.which, ("chromium", "chromium-browser", "google-chrome"))), None)


def looked_at(site: Path) -> list[str]:
    """What is wrong with the pages of a site, a line each."""
    pages = sorted(path.relative_to(site).as_posix() for path in site.rglob("*.html"))
    pages = [page for page in pages if not page.startswith("_")]
    findings = _Findings(pages)
    handler = partial(_Handler, findings, directory=str(site))
    server = http.server.ThreadingHTTPServer(("127.0.0.1", 0), handler)
    threading.Thread(target=server.serve_forever, daemon=True).start()
    # Its processes may write a moment longer than it runs.
    with tempfile.TemporaryDirectory(ignore_cleanup_errors=True) as profile:
        command = [
            browser() or "chromium",
            "--headless=new",
            "--no-sandbox",
            "--disable-gpu",
            f"--user-data-dir={profile}",
        ]
        address = f"http://127.0.0.1:{server.server_address[1]}/look"
        with subprocess.Popen(
            [*command, "--window-size=1400,1000", address],
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
        ) as process:
            ended = findings.ended.wait(_PATIENCE)
            process.terminate()
    server.shutdown()
    server.server_close()
    return findings.lines if ended else ["It took too long."]


if __name__ == "__main__":
    lines = looked_at(Path(sys.argv[1]))
    print("\n".join(lines) or "All pages fit, with all pictures and enough contrast.")
    sys.exit(bool(lines))
