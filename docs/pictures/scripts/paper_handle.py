"""A figure of the paper's tables: handle."""

from pathlib import Path

from paper_figures import paper_figure
from stage import Stage


def draw(stage: Stage) -> Path:
    """Run the command that re-runs the tables."""
    return paper_figure(stage, "handle")
