"""Processes that have come from one, as Linux lists them."""

from pathlib import Path


def text_of(path):
    """Text of a file of the system; empty for a process that has ended."""
    try:
        return path.read_text()
    except OSError:
        return ""


def tree_of(process):
    """Numbers of a process and of all below it."""
    found = [process]
    for each in found:
        for task in Path(f"/proc/{each}/task").glob("*/children"):
            found += map(int, text_of(task).split())
    return found
