"""Builds into the wheel what is made before: manual, compiled kernels, and completions for shells.

``make docs`` has left the pages in build/docs; in resources/installer, kernels.py has left the kernels in
build/kernels, and completions.py the completions in build/completions.
"""

import sysconfig
from pathlib import Path
from typing import Any

from hatchling.builders.hooks.plugin.interface import BuildHookInterface

_PAGES = "build/docs"
_KERNELS = "build/kernels"
# Where shells look for completions, below the prefix of an installation.
_COMPLETIONS = {
    "build/completions/bash": "share/bash-completion/completions/apd-viewer",
    "build/completions/zsh": "share/zsh/site-functions/_apd-viewer",
    "build/completions/fish": "share/fish/vendor_completions.d/apd-viewer.fish",
}
# What no page shows: maps for debugging its style, and what Sphinx keeps for itself.
_NEEDLESS = (".map", ".buildinfo", "objects.inv", "webpack-macros.html")


class CustomBuildHook(BuildHookInterface[Any]):
    """Takes pages and kernels along into a wheel, and pages into a source archive."""

    def initialize(self, version: str, build_data: dict[str, Any]) -> None:
        """Name each file and where it goes; an editable installation reads them from where they are."""
        if version == "editable":
            return
        self._add_pages(build_data)
        if self.target_name == "wheel":
            self._add_kernels(build_data)
            for path, place in _COMPLETIONS.items():
                if (Path(self.root) / path).is_file():
                    build_data["shared_data"][str(Path(self.root) / path)] = place

    def _add_pages(self, build_data: dict[str, Any]) -> None:
        pages = Path(self.root) / _PAGES
        if not (pages / "index.html").is_file():
            self.app.display_warning("The manual is not built, so it is left out; run make docs first.")
            return
        home = "apd_viewer/manual" if self.target_name == "wheel" else _PAGES
        for page in sorted(pages.rglob("*")):
            if page.is_file() and not page.name.endswith(_NEEDLESS):
                build_data["force_include"][str(page)] = f"{home}/{page.relative_to(pages).as_posix()}"

    def _add_kernels(self, build_data: dict[str, Any]) -> None:
        """Put kernels beside their modules, where they are looked for; the wheel is then one of a system."""
        kernels = Path(self.root) / _KERNELS
        for file in sorted(kernels.rglob("*.nb?")):
            folder = file.parent.relative_to(kernels).as_posix()
            build_data["force_include"][str(file)] = f"{folder}/__pycache__/{file.name}"
        if kernels.is_dir():
            # Kernels link to nothing but numba, so any C library will do.
            system = sysconfig.get_platform().replace("linux-", "manylinux_2_17_")
            build_data["tag"] = f"py3-none-{system.replace('-', '_').replace('.', '_')}"
