"""The figures of the paper's tables, computed once for all scripts of a run."""

from __future__ import annotations

import os
import shutil
from pathlib import Path

from make_pictures import SHARED
from stage import Stage

from apd_viewer.__main__ import main


def paper_figure(stage: Stage, name: str) -> Path:
    """A figure of ``apd-viewer paper``; quickly, an earlier one."""
    if stage.quick:  # the command takes minutes, and has tests of its own
        return Path(__file__).parent / f"paper_{name.replace('-', '_')}.webp"
    folder = Path(os.environ.get(SHARED, stage.folder)) / "paper"
    if not folder.exists():
        scratch = stage.folder / "paper"
        assert main(["paper", "-o", str(scratch)]) == 0
        shutil.move(scratch, folder)
    return folder / f"{name}.png"
