"""JupyterLab and other notebooks on this machine, in a Chromium without a window."""

import json
import os
import shutil
import socket
import subprocess
import sys
import time
from contextlib import contextmanager
from urllib.request import urlopen

CHROMIUM = next(filter(None, map(shutil.which, ("chromium", "chromium-browser", "google-chrome"))), None)


@contextmanager
def chromium():
    from playwright.sync_api import sync_playwright

    assert CHROMIUM, "Chromium is needed"
    with sync_playwright() as playwright:
        # As Chromium is by itself without a graphics processor: WebGL by SwiftShader, the page without it.
        opened = playwright.chromium.launch(
            executable_path=CHROMIUM, args=["--no-sandbox", "--enable-unsafe-swiftshader"]
        )
        yield opened
        opened.close()


@contextmanager
def server(command, folder, port):
    """A server on a port of this machine, with settings in a folder of its own."""
    own = {
        name: str(folder / name) for name in ("JUPYTER_CONFIG_DIR", "JUPYTER_DATA_DIR", "JUPYTER_RUNTIME_DIR")
    }
    own |= {"XDG_CONFIG_HOME": str(folder / "config"), "APD_VIEWER_LANGUAGE": "en"}
    with (folder / "log").open("w") as log:
        process = subprocess.Popen(
            [sys.executable, "-m", *command], cwd=folder, env=os.environ | own, stdout=log, stderr=log
        )
    try:
        for _ in range(300):
            try:
                urlopen(f"http://127.0.0.1:{port}/", timeout=5).close()
                break
            except OSError:
                assert process.poll() is None, (folder / "log").read_text()
                time.sleep(0.2)
        yield
    finally:
        process.terminate()
        process.wait(20)


def free_port():
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        return probe.getsockname()[1]


@contextmanager
def jupyterlab(folder, cells):
    """Address of a notebook with some cells, opened by a JupyterLab of its own."""
    notebook = {
        "cells": [
            {
                "cell_type": "code",
                "id": f"c{k}",
                "metadata": {},
                "source": cell,
                "outputs": [],
                "execution_count": None,
            }
            for k, cell in enumerate(cells)
        ],
        "metadata": {"kernelspec": {"name": "python3", "display_name": "Python 3", "language": "python"}},
        "nbformat": 4,
        "nbformat_minor": 5,
    }
    (folder / "view.ipynb").write_text(json.dumps(notebook))
    port = free_port()
    command = [
        *("jupyterlab", "--no-browser", "--ip=127.0.0.1", f"--port={port}", "--allow-root"),
        *("--IdentityProvider.token=secret", "--LabApp.news_url=", "--ServerApp.port_retries=0"),
        *(
            "--LabApp.check_for_updates_class=jupyterlab.NeverCheckForUpdate",
            f"--ServerApp.root_dir={folder}",
        ),
    ]
    with server(command, folder, port):
        yield f"http://127.0.0.1:{port}/lab/tree/view.ipynb?token=secret"


def run_first_cell(page):
    page.locator(".jp-CodeCell").first.locator(".cm-content").click(timeout=60_000)
    page.locator('[data-status="idle"]').first.wait_for(state="attached", timeout=60_000)
    page.keyboard.press("Shift+Enter")


def arrow(page):
    """Pixel of the view where the arrow along x is."""
    return page.locator(".apd-view").evaluate("(box) => box.meshView.gizmoPixel(0)")


def settle(page):
    page.locator(".apd-line", has_text="converged").wait_for(timeout=120_000)
