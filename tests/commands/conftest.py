"""What the commands are given."""

import subprocess

import pytest
from immediate import Here
from study_work import computed


@pytest.fixture
def without_opengl(monkeypatch):
    """VTK ends the process that draws: here as a broken driver would."""

    class Aborted(subprocess.Popen):
        def __init__(self, command, **how):
            super().__init__([command[0], "-c", "import os; os.abort()"], **how)

    monkeypatch.setattr(subprocess, "Popen", Aborted)


@pytest.fixture
def cases_run_here(monkeypatch):
    """The cases of a study need no process, which takes longer to start than they take."""
    monkeypatch.setattr("apd_viewer.commands.study_command.LocalPool", lambda _: Here(computed))


@pytest.fixture
def undrawn_sweeps(monkeypatch):
    """Sweeps without their figures, which take longer than all else."""
    monkeypatch.setattr("apd_viewer.figures.curves.draw_sweep_curves", lambda *_, **__: None)
