"""Names with signs of Qt in them."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path


def menu_text(name: str) -> str:
    """Name for an action or button, with ``&`` escaped from being a mnemonic."""
    return name.replace("&", "&&")


def window_title_text(name: str) -> str:
    """Name in the title of a window; ``[*]`` is a sign of Qt there."""
    return name.replace("[*]", "[*][*]")


def distinct_names(paths: Sequence[Path]) -> list[str]:
    """Names of files, with the end of the folder if a name is not alone."""
    named = []
    for path in paths:
        others = [other for other in paths if other.name == path.name and other != path]
        parts = path.parent.parts
        least = max((_common(parts, other.parent.parts) for other in others), default=-1) + 1
        named.append(f"{path.name} – {Path(*parts[-least:])}" if least else path.name)
    return named


def _common(parts: Sequence[str], others: Sequence[str]) -> int:
    """Number of last folders common to two paths."""
    pairs = zip(reversed(parts), reversed(others), strict=False)
    return next((k for k, (part, other) in enumerate(pairs) if part != other), min(len(parts), len(others)))
