"""Formats of animations, for people."""

from __future__ import annotations

from collections.abc import Mapping

from apd_viewer.language import tr
from apd_viewer.ui.widgets.fields import ComboBox

ANIMATION_FORMATS: Mapping[str, str] = {
    ".glb": tr("glTF with morph targets (GLB)"),
    ".pc2": tr("Blender point cache (PC2)"),
    ".mdd": tr("Blender point cache (MDD)"),
    ".pvd": tr("ParaView series (PVD)"),
    ".gif": tr("film (GIF)"),
}


def format_choice(first: str) -> ComboBox:
    """Choice of a format by its ending; ``first`` is chosen to begin with."""
    choice = ComboBox()
    choice.setAccessibleName(tr("Format of the animation"))
    for ending, title in ANIMATION_FORMATS.items():
        choice.addItem(title, ending)
    choice.setCurrentIndex(choice.findData(first))
    return choice
