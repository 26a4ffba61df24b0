"""Builds the manual into the wheel: the pages that ``make docs`` has left in build/docs."""

from pathlib import Path
from typing import Any

from hatchling.builders.hooks.plugin.interface import BuildHookInterface

_PAGES = "build/docs"
# What no page shows: maps for debugging its style, and what Sphinx keeps for itself.
_NEEDLESS = (".map", ".buildinfo", "objects.inv", "webpack-macros.html")


class CustomBuildHook(BuildHookInterface[Any]):
    """Takes the pages along: into the package in a wheel, to their place in a source archive."""

    def initialize(self, version: str, build_data: dict[str, Any]) -> None:
        """Name each page and where it goes; an editable installation reads them from where they are."""
        pages = Path(self.root) / _PAGES
        if version == "editable":
            return
        if not (pages / "index.html").is_file():
            self.app.display_warning("The manual is not built, so it is left out; run make docs first.")
            return
        home = "apd_viewer/manual" if self.target_name == "wheel" else _PAGES
        for page in sorted(pages.rglob("*")):
            if page.is_file() and not page.name.endswith(_NEEDLESS):
                build_data["force_include"][str(page)] = f"{home}/{page.relative_to(pages).as_posix()}"
