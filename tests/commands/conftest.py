"""What the commands are given."""

import subprocess

import pytest


@pytest.fixture
def without_opengl(monkeypatch):
    """VTK ends the process that draws: here as a broken driver would."""

    class Aborted(subprocess.Popen):
        def __init__(self, command, **how):
            super().__init__([command[0], "-c", "import os; os.abort()"], **how)

    monkeypatch.setattr(subprocess, "Popen", Aborted)
