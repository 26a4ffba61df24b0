"""What twist, push and stiffness leave of the volume, by the table of the worked study."""

import runpy
from pathlib import Path

from stage import Stage

STUDY = Path(__file__).resolve().parents[2] / "studies" / "crushed-bottle" / "make.py"


def draw(stage: Stage) -> Path:
    """Draw the results that are kept beside the plan."""
    runpy.run_path(str(STUDY))["picture"](stage.folder)
    return stage.folder / "least-volume.png"
