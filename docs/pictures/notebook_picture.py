"""Picture of the page on notebooks: the sample bottle dragged in JupyterLab.

    build/night/environment/bin/python docs/pictures/notebook_picture.py

It needs the extras of a night and Chromium, and no display.
"""

import sys
import tempfile
from pathlib import Path

HERE = Path(__file__).resolve().parent
ROOT = HERE.parents[1]
sys.path[:0] = [str(HERE), str(ROOT / "tests" / "support")]
from notebook_pages import arrow, chromium, jupyterlab, run_first_cell, settle  # noqa: E402
from picture_files import write_picture  # noqa: E402

CELL = """import numpy as np
import apd_viewer

mesh = apd_viewer.open_mesh("bottle.obj")
base, neck = np.flatnonzero(mesh.V[:, 1] < 1.2), np.flatnonzero(mesh.V[:, 1] > 18.7)
view = apd_viewer.live(mesh, base, neck)
view"""
CELLS = [CELL, "view.result.area_error"]
SCALE = 2  # pixels of the picture for one of the page
MARGIN = 8  # pixels beside and above the cells


def main() -> None:
    """Drag the neck to the side, and write the cells as a picture."""
    with tempfile.TemporaryDirectory() as name, jupyterlab(Path(name), CELLS) as address:
        Path(name, "bottle.obj").symlink_to(ROOT / "resources" / "bottle.obj")
        with chromium() as browser:
            page = browser.new_page(viewport={"width": 1200, "height": 1000}, device_scale_factor=SCALE)
            page.goto(address)
            page.get_by_role("button", name="No", exact=True).click()
            run_first_cell(page)
            page.locator(".apd-view canvas").wait_for(timeout=120_000)
            settle(page)
            drag(page)
            settle(page)
            page.locator(".jp-CodeCell").nth(1).locator(".cm-content").click()
            page.keyboard.press("Shift+Enter")
            page.locator(".jp-OutputArea-executeResult").nth(1).wait_for(timeout=120_000)
            page.locator(".jp-NotebookPanel-toolbar").click()  # no cell has the focus
            picture = Path(name, "notebook.png")
            first, last = (page.locator(".jp-CodeCell").nth(k).bounding_box() for k in (0, 1))
            left, top = first["x"] - MARGIN, first["y"] - MARGIN
            size = {
                "width": first["width"] + 2 * MARGIN,
                "height": last["y"] + last["height"] - top,
            }
            page.screenshot(path=picture, clip={"x": left, "y": top, **size})
        write_picture(picture, HERE / "notebook.webp")


def drag(page) -> None:
    """Drag the red arrow of the gizmo to the right."""
    around = page.locator(".apd-view").bounding_box()
    x, y = arrow(page)
    x, y = x + around["x"], y + around["y"]
    page.mouse.move(x, y)
    page.mouse.down()
    for k in range(20):
        page.mouse.move(x + 3 * k, y)
        page.wait_for_timeout(50)
    page.mouse.up()


if __name__ == "__main__":
    main()
