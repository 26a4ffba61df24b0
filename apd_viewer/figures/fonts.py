"""Fonts of figures for letters that DejaVu Sans lacks; loads no matplotlib."""

from functools import cache
from pathlib import Path

from apd_viewer.language import LANGUAGE

LATIN = "DejaVu Sans"  # bundled with matplotlib: figures are the same everywhere
# Simplified Chinese font files on Linux, Windows and macOS, best first; a collection gives its first face.
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
    """System font file for a language; None if none is needed or found."""
    if not language.startswith("zh"):
        return None
    # Imported here: it takes a third of a second, and only few languages need it.
    from matplotlib import font_manager

    found = {Path(path).stem: Path(path) for path in font_manager.findSystemFonts()}
    return next((found[name] for name in _CHINESE if name in found), None)


@cache
def font_families(language: str = LANGUAGE) -> list[str]:
    """Font families for matplotlib, in order of preference for each letter."""
    path = font_file(language)
    if path is None:
        return [LATIN]
    # Imported here, as in font_file.
    from matplotlib import font_manager

    font_manager.fontManager.addfont(path)
    return [LATIN, font_manager.get_font(path).family_name]
