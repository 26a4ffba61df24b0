"""Views in real notebooks: JupyterLab and marimo, with a real mouse in a Chromium without a window.

Both run on this machine only, and every request of their pages is written down.
"""

import json
import os
import time
from pathlib import Path
from urllib.parse import urlsplit

import pytest
from notebook_pages import arrow, chromium, free_port, jupyterlab, run_first_cell, server, settle

pytestmark = pytest.mark.extra

ROOT = Path(__file__).parents[2]
SECONDS = 8.0  # of a drag
ENOUGH = 5.0  # shapes drawn a second on two cores that all of this shares; 8 to 17 were measured
OPEN = f"""
import numpy as np
import apd_viewer
mesh = apd_viewer.open_mesh({str(ROOT / "resources" / "bottle.obj")!r})
base, neck = np.flatnonzero(mesh.V[:, 1] < 1.2), np.flatnonzero(mesh.V[:, 1] > 18.7)
view = apd_viewer.live(mesh, base, neck, contact=False)
"""
# The solver's own rate, by the same settings and a handle that moves at each iteration; and bits.
JUDGE = f"""
import json, time
solver = apd_viewer.Deformation(mesh.V, mesh.F, view.fixed, handle=view.handles, contact=False)
held, count, began = np.isin(view.fixed, neck), 0, time.perf_counter()
while (now := time.perf_counter() - began) < {SECONDS}:
    targets = mesh.V[view.fixed].copy()
    targets[held, 0] += 2 * np.sin(now)
    solver.aim(targets)
    solver.step()
    count += 1
alone = count / now
result = view.result
other = apd_viewer.deform(
    mesh.V, mesh.F, view.fixed, view.targets, handle=view.handles, contact=False
)
told = dict(
    alone=alone,
    moved=float(abs(view.targets - mesh.V[view.fixed]).max()),
    bits=result.U.tobytes() == other.U.tobytes(),
    area_error=view.frame.area_error,
)
"""
# A shape counts once it is drawn: one that came and was replaced before is not seen.
COUNT = """(box) => {
  const view = box.meshView, plain = view.setPositions, gl = view.canvas.getContext("webgl2");
  const fence = gl.fenceSync.bind(gl);
  let isNew = false;
  box.shapes = 0;
  view.setPositions = (P) => { isNew = true; plain(P); };
  gl.fenceSync = (...given) => { box.shapes += isNew; isNew = false; return fence(...given); };
}"""


@pytest.fixture(scope="module")
def browser():
    with chromium() as opened:
        yield opened


def recorded_page(browser, scheme="light"):
    """A page, and the list of hosts that it asks."""
    page = browser.new_page(viewport={"width": 1200, "height": 1000}, color_scheme=scheme)
    hosts = []
    page.on("request", lambda request: hosts.append(request.url))
    page.on("websocket", lambda opened: hosts.append(opened.url))
    return page, hosts


def outside(urls):
    own = {"127.0.0.1", "localhost"}
    return [
        url
        for url in urls
        if urlsplit(url).scheme not in ("data", "blob") and urlsplit(url).hostname not in own
    ]


def drag(page):
    """Drag the red arrow of the gizmo to and fro; shapes drawn per second."""
    box = page.locator(".apd-view")
    box.scroll_into_view_if_needed()
    box.evaluate(COUNT)
    around = box.bounding_box()
    x, y = arrow(page)
    x, y = x + around["x"], y + around["y"]
    page.mouse.move(x, y)
    page.mouse.down()
    began, step, first = time.perf_counter(), 0, box.evaluate("(box) => box.shapes")
    while time.perf_counter() - began < SECONDS:
        step += 1
        page.mouse.move(x + 40 * abs(step % 40 - 20) / 20 - 40, y)
        time.sleep(0.02)
    shapes = (box.evaluate("(box) => box.shapes") - first) / (time.perf_counter() - began)
    page.mouse.move(x - 30, y)
    page.mouse.up()
    return shapes


def judge(told, shapes, hosts, record_property, name):
    alone, share = told["alone"], shapes / told["alone"]
    record_property(f"{name}: shapes drawn [1/s]", round(shapes, 1))
    record_property(f"{name}: solver alone [1/s]", round(alone, 1))
    assert outside(hosts) == []
    assert told["moved"] > 0.1
    assert told["bits"]
    assert abs(told["area_error"]) < 1e-9
    assert shapes >= ENOUGH or share >= 0.8


def test_live_view_follows_the_mouse_in_jupyterlab(browser, tmp_path, record_property):
    cells = [OPEN + "view", JUDGE + "print('told', json.dumps(told))"]
    with jupyterlab(tmp_path, cells) as address:
        page, hosts = recorded_page(browser)
        page.goto(address)
        run_first_cell(page)
        page.locator(".apd-view canvas").wait_for(timeout=120_000)
        settle(page)
        shapes = drag(page)
        settle(page)
        page.screenshot(path=os.environ.get("APD_SHOTS", str(tmp_path)) + "/jupyterlab.png")
        page.locator(".jp-CodeCell").nth(1).locator(".cm-content").click()
        page.keyboard.press("Shift+Enter")
        said = page.locator(".jp-OutputArea-output", has_text="told {").inner_text(timeout=180_000)
        page.close()
    judge(json.loads(said.partition("told ")[2]), shapes, hosts, record_property, "JupyterLab")


def test_live_view_follows_the_mouse_in_marimo(browser, tmp_path, record_property):
    port = free_port()
    (tmp_path / "config" / "marimo").mkdir(parents=True)
    (tmp_path / "config" / "marimo" / "marimo.toml").write_text('[display]\ntheme = "dark"\n')
    opened = "\n".join("    " + line for line in OPEN.strip().splitlines())
    after = "\n".join("    " + line for line in JUDGE.strip().splitlines())
    (tmp_path / "view.py").write_text(
        "import marimo\n\napp = marimo.App()\n\n\n@app.cell\ndef _():\n"
        f"{opened}\n    return apd_viewer, base, mesh, neck, np, view\n\n\n"
        "@app.cell\ndef _(view):\n    view\n    return\n\n\n"
        "@app.cell\ndef _():\n    import marimo as mo\n    go = mo.ui.run_button(label='Judge')\n    go\n"
        "    return go, mo\n\n\n"
        "@app.cell\ndef _(apd_viewer, go, mesh, mo, neck, np, view):\n    mo.stop(not go.value)\n"
        f"{after}\n    mo.md('told ' + json.dumps(told))\n    return\n"
    )
    with server(
        ["marimo", "run", "view.py", "--headless", "--no-token", f"--port={port}", "--host=127.0.0.1"],
        tmp_path,
        port,
    ):
        page, hosts = recorded_page(browser, "dark")
        page.goto(f"http://127.0.0.1:{port}/")
        page.locator(".apd-view canvas").wait_for(timeout=180_000)
        settle(page)
        shapes = drag(page)
        settle(page)
        page.screenshot(path=os.environ.get("APD_SHOTS", str(tmp_path)) + "/marimo.png")
        page.get_by_role("button", name="Judge").click()
        said = page.get_by_text("told {").last.inner_text(timeout=180_000)
        page.close()
    told = json.loads(said.partition("told ")[2].replace("“", '"').replace("”", '"'))
    judge(told, shapes, hosts, record_property, "marimo")
