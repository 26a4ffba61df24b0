"""A figure of the paper's tables: loss-against-angle."""

from pathlib import Path

from paper_figures import paper_figure
from stage import Stage


def draw(stage: Stage) -> Path:
    """Run the command that re-runs the tables."""
    return paper_figure(stage, "loss-against-angle")
