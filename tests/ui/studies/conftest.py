"""Commands without a process of their own."""

import pytest
from command_here import CommandHere

from apd_viewer.ui.studies import run_bar


@pytest.fixture
def here(monkeypatch):
    """This process runs the commands of dialogs that are opened from now on."""
    monkeypatch.setattr(run_bar, "CommandProcess", CommandHere)
