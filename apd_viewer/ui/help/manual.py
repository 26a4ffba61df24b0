"""The manual: HTML pages shipped with the program, and locations in them."""

import re
import tempfile
from html import escape
from pathlib import Path
from typing import NamedTuple

from PySide6.QtCore import QStandardPaths, QUrl, QUrlQuery
from PySide6.QtGui import QDesktopServices

from apd_viewer.errors import InputError
from apd_viewer.language import tr

_PACKAGE = Path(__file__).resolve().parents[2]
_SEARCH = "search"
_FORWARD = """<!doctype html>
<meta charset="utf-8">
<title>APD Viewer</title>
<meta http-equiv="refresh" content="0; url={url}">
<a href="{url}">{url}</a>
"""


class ManualPlace(NamedTuple):
    """Page of the manual, with an anchor.

    Parameters
    ----------
    page : str
        Without its suffix, relative to the manual.
    anchor : str
        Empty for the beginning of the page.
    """

    page: str
    anchor: str = ""


FIRST_PAGE = ManualPlace("index")


def slug(name: str) -> str:
    """Anchor made of a name; keeps signs, so that ``up:-X`` and ``up:+X`` differ."""
    spoken = name.lower().replace("-", " minus ").replace("+", " plus ")
    return re.sub(r"[^a-z0-9]+", "-", spoken).strip("-")


def action_place(name: str) -> ManualPlace:
    """Location in the manual of the menu entry ``name``."""
    return ManualPlace("reference/keys", f"action-{slug(name)}")


def setting_place(name: str) -> ManualPlace:
    """Location in the manual of the preference ``name``."""
    return ManualPlace("reference/settings", f"setting-{slug(name)}")


def section_place(name: str) -> ManualPlace:
    """Location in the manual of a section, card or dialog, by its class name."""
    words = re.sub(r"(?<=[a-z])(?=[A-Z])", " ", name)
    return ManualPlace("reference/window", f"section-{slug(words)}")


def manual_folder(package: Path = _PACKAGE) -> Path:
    """Folder of the manual, either installed or built in a source checkout.

    Raises
    ------
    InputError
        If there is none.
    """
    for folder in (package / "manual", package.parent / "build" / "docs"):
        if (folder / "index.html").is_file():
            return folder
    if (package.parent / "docs" / "conf.py").is_file():
        words = tr("The manual is not built yet; run “make docs” in {folder}.")
        raise InputError(words.format(folder=package.parent))
    raise InputError(tr("This installation has no manual; install the program from its wheel."))


def open_manual(place: ManualPlace = FIRST_PAGE) -> None:
    """Open a location in the manual in the browser; raises InputError if missing."""
    page = manual_folder() / f"{place.page}.html"
    url = QUrl.fromLocalFile(str(page))
    if place.anchor:
        url.setFragment(place.anchor)
        url = QUrl.fromLocalFile(str(_forwarding_page(url)))
    _show(url)


def search_manual(words: str) -> None:
    """Open the manual's search for words; raises InputError if missing."""
    url = QUrl.fromLocalFile(str(manual_folder() / f"{_SEARCH}.html"))
    query = QUrlQuery()
    query.addQueryItem("q", words)
    url.setQuery(query)
    _show(QUrl.fromLocalFile(str(_forwarding_page(url))))


def _show(url: QUrl) -> None:
    if not QDesktopServices.openUrl(url):
        raise InputError(
            tr("No browser could be started; open {page} in one.").format(page=url.toLocalFile())
        )


def _forwarding_page(url: QUrl) -> Path:
    """HTML page redirecting to ``url``: file openers drop anchors and queries."""
    place = QStandardPaths.writableLocation(QStandardPaths.StandardLocation.CacheLocation)
    text = _FORWARD.format(url=escape(url.toString(QUrl.ComponentFormattingOption.FullyEncoded)))
    for folder in (Path(place), Path(tempfile.gettempdir())):
        try:
            folder.mkdir(parents=True, exist_ok=True)
            page = folder / "apd-viewer-manual.html"
            page.write_text(text, encoding="utf-8")
        except OSError:
            continue
        return page
    raise InputError(tr("No temporary file could be written; the disk may be full."))
