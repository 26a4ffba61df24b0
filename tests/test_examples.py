"""The examples in the docstrings of the public Python names run, and say what comes of it."""

import doctest
import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

import apd_viewer

ROOT = Path(__file__).parents[1]
# Runs the example of `view` and, in place of a user, closes the window once it shows the mesh.
VIEW = """
import doctest
from PySide6.QtCore import QTimer
import apd_viewer
from apd_viewer.ui import application

titles = []

def built(shell, *given, build=application.build_workbench):
    workbench = build(shell, *given)
    def look():
        if "bottle.obj" in shell.windowTitle():
            titles.append(shell.windowTitle())
            shell.close()
    QTimer(workbench, interval=20, timeout=look).start()
    return workbench

application.build_workbench = built
found = doctest.DocTestParser().get_doctest(apd_viewer.view.__doc__, {}, "view", None, 0)
print(doctest.DocTestRunner().run(found).failed, "failed")
print(titles[0])
"""


@pytest.mark.parametrize("name", apd_viewer.__all__)
def test_examples_are_there_for_every_public_name_and_are_run(name):
    found = examples(name)
    assert len(found) > 1
    assert not any(doctest.SKIP in example.options for example in found)


@pytest.mark.parametrize(
    "name",
    [
        *sorted(set(apd_viewer.__all__) - {"view", "live"}),
        pytest.param("live", marks=pytest.mark.extra),
    ],
)
def test_examples_say_what_comes_of_them(name, compiled, tmp_path, monkeypatch):
    shutil.copy(ROOT / "resources" / "bottle.obj", tmp_path)
    monkeypatch.chdir(tmp_path)
    found = doctest.DocTestParser().get_doctest(getattr(apd_viewer, name).__doc__, {}, name, None, 0)
    assert doctest.DocTestRunner().run(found).failed == 0


@pytest.mark.night
def test_view_has_an_example_that_opens_the_window_and_returns_when_it_is_closed(tmp_path):
    shutil.copy(ROOT / "resources" / "bottle.obj", tmp_path)
    home = {"HOME": str(tmp_path), "XDG_CONFIG_HOME": str(tmp_path / "config")}
    done = subprocess.run(
        [sys.executable, "-c", VIEW],
        cwd=tmp_path,
        env=os.environ | home | {"PYTHONPATH": str(ROOT)},
        capture_output=True,
        text=True,
        check=False,
        timeout=120,
    )
    assert (done.returncode, done.stderr) == (0, "")
    failed, title = done.stdout.splitlines()
    assert failed == "0 failed"
    assert title.startswith("bottle.obj")


def examples(name):
    """Examples of a public name, those of its methods left out."""
    return doctest.DocTestParser().get_examples(getattr(apd_viewer, name).__doc__ or "")
