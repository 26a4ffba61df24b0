"""The public Python names, for autodoc to fill in."""

from __future__ import annotations

import inspect

import apd_viewer


def python_page() -> str:
    """Markdown with a section for each name, functions first."""
    functions = [name for name in apd_viewer.__all__ if not inspect.isclass(getattr(apd_viewer, name))]
    classes = [name for name in apd_viewer.__all__ if name not in functions]
    sections = ["## Functions", *(_entry("autofunction", name) for name in functions)]
    sections += ["## Classes", *(_entry("autoclass", name) for name in classes)]
    return "\n\n".join(sections)


def _entry(directive: str, name: str) -> str:
    members = "\n   :members:" if directive == "autoclass" else ""
    return f"### {name}\n\n```{{eval-rst}}\n.. {directive}:: apd_viewer.{name}{members}\n```"
