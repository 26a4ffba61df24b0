"""Fonts of figures in languages beyond the letters of DejaVu Sans."""

from __future__ import annotations

from functools import cache
from pathlib import Path

from apd_viewer.language import LANGUAGE

LATIN = "DejaVu Sans"  # comes with matplotlib: figures are the same everywhere
# Files with simplified Chinese on Linux, Windows and macOS, best first; a collection gives its first face.
_CHINESE = (
    "NotoSansCJKsc-Regular",
    "NotoSansSC-Regular",
    "SourceHanSansSC-Regular",
    "SourceHanSansCN-Regular",
    "msyh",
    "PingFang",
    "Hiragino Sans GB",
    "STHeiti Light",
    "NotoSansCJK-Regular",
    "wqy-microhei",
    "wqy-zenhei",
    "simhei",
    "simsun",
    "DroidSansFallbackFull",
    "DroidSansFallback",
)


@cache
def font_file(language: str = LANGUAGE) -> Path | None:
    """Font of the system for a language; None if it needs none, or there is none."""
    if not language.startswith("zh"):
        return None
    # Here, because only few languages need it, and it takes a third of a second.
    from matplotlib import font_manager

    found = {Path(path).stem: Path(path) for path in font_manager.findSystemFonts()}
    return next((found[name] for name in _CHINESE if name in found), None)


@cache
def families(language: str = LANGUAGE) -> list[str]:
    """Families for matplotlib; each letter is from the first that has it."""
    path = font_file(language)
    if path is None:
        return [LATIN]
    # Here, as above.
    from matplotlib import font_manager

    font_manager.fontManager.addfont(path)
    return [LATIN, font_manager.get_font(path).family_name]
