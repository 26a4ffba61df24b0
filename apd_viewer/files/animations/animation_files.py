"""Formats of animations by the endings of their names."""

from __future__ import annotations

import os
from pathlib import Path

from apd_viewer.errors import InputError
from apd_viewer.files.animations.animation_shapes import Animation
from apd_viewer.files.animations.morph_targets import write_morph_targets
from apd_viewer.files.animations.point_cache import write_mdd, write_pc2
from apd_viewer.files.mesh_writing import check_writable
from apd_viewer.language import tr

_SERIES = ".pvd"
_WRITERS = {".pc2": write_pc2, ".mdd": write_mdd, ".glb": write_morph_targets}
ANIMATION_FORMATS = (*_WRITERS, _SERIES)


def check_animation(path: Path) -> None:
    """Raise InputError unless an animation can be written to ``path``."""
    check_writable(path)
    if os.path.isdir(path):  # noqa: PTH112
        raise InputError(
            tr("{path} cannot be written (it is a folder); choose another name.").format(path=path)
        )
    beside = path.with_suffix("")
    if path.suffix.lower() == _SERIES and beside.exists() and not beside.is_dir():
        raise InputError(
            tr("{name} needs a folder {folder} beside it, which is a file; choose another name.").format(
                name=path.name, folder=beside.name
            )
        )


def write_animation(animation: Animation, path: Path) -> None:
    """Write the shapes in the format of the ending, one of ``ANIMATION_FORMATS``.

    Raises
    ------
    InputError
        If the file cannot be written.
    """
    kind = path.suffix.lower()
    if kind == _SERIES:
        # Here: VTK is slow to import, and no other format needs it.
        from apd_viewer.files.animations.paraview_series import write_series

        write_series(animation, path)
    else:
        _WRITERS[kind](animation, path)
