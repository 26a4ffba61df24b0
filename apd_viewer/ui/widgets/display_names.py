"""Names escaped for display by Qt."""

from collections.abc import Sequence
from pathlib import Path


def menu_text(name: str) -> str:
    """Name for an action or button, with ``&`` escaped."""
    return name.replace("&", "&&")


def window_title_text(name: str) -> str:
    """Name for a window title, with Qt's placeholder ``[*]`` escaped."""
    return name.replace("[*]", "[*][*]")


def distinct_names(paths: Sequence[Path]) -> list[str]:
    """File names, with their last folders added to equal names."""
    named = []
    for path in paths:
        others = [other for other in paths if other.name == path.name and other != path]
        parts = path.parent.parts
        least = max((_common_folder_count(parts, other.parent.parts) for other in others), default=-1) + 1
        named.append(f"{path.name} – {Path(*parts[-least:])}" if least else path.name)
    return named


def _common_folder_count(parts: Sequence[str], others: Sequence[str]) -> int:
    """Number of equal folders at the ends of two paths."""
    pairs = zip(reversed(parts), reversed(others), strict=False)
    return next((k for k, (part, other) in enumerate(pairs) if part != other), min(len(parts), len(others)))
