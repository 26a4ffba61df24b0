"""The ``thumbnail`` command: a small picture of a session or a mesh."""

import argparse
from pathlib import Path

import numpy as np

from apd_viewer.commands.terminal.command_output import CommandOutput
from apd_viewer.commands.terminal.parser import Parser, add_option
from apd_viewer.errors import InputError
from apd_viewer.files.meshes import check_readable, open_mesh
from apd_viewer.files.picture_files import png_content, read_png
from apd_viewer.files.storage.atomic_file import replacing_file
from apd_viewer.language import tr
from apd_viewer.presentation.palette import FREE_COLOR, label_colors
from apd_viewer.presentation.shape_picture import VIEW_DIRECTION, shape_picture
from apd_viewer.session.model.up_axis import UpAxis
from apd_viewer.session.model.view import SESSION_SUFFIX
from apd_viewer.session.storage.session_picture import session_picture

_USUAL, _LEAST, _MOST = 256, 16, 1024  # default, least and largest size in pixels
# Largest file in bytes; a larger one would exceed a file manager's time and memory limits.
MOST_BYTES = 1 << 26


def thumbnail_parser() -> Parser:
    """Argument parser for the ``thumbnail`` command."""
    parser = Parser(
        prog="apd-viewer thumbnail",
        description=tr("Draw a small picture of a session or a mesh, without OpenGL; file managers call it."),
    )
    add_option(parser, "FILE", type=Path)
    parser.add_argument("output", metavar="OUT.png", type=Path)
    add_option(
        parser, "--size N", tr("pixels of the longer side; default: %(default)s"), type=int, default=_USUAL
    )
    parser.set_defaults(run=_thumbnail)
    return parser


def _thumbnail(options: argparse.Namespace) -> CommandOutput:
    path, size = options.file, options.size
    if not _LEAST <= size <= _MOST:
        raise InputError(
            tr("--size is a number of pixels from {least} to {most:,}.").format(least=_LEAST, most=_MOST)
        )
    check_readable(path, more_suffixes=(SESSION_SUFFIX,))
    pixels = (
        _session_thumbnail(path, size)
        if path.suffix.lower() == SESSION_SUFFIX
        else _mesh_thumbnail(path, size)
    )
    with replacing_file(options.output) as scratch:
        scratch.write_bytes(png_content(pixels))
    return CommandOutput((), lambda: {"picture": str(options.output), "size": pixels.shape[1::-1]})


def _session_thumbnail(path: Path, size: int) -> np.ndarray:
    """Picture stored in a session; drawn from its shape if there is none."""
    picture = session_picture(path)
    if picture is not None:
        try:
            return read_png(picture, size)
        except ValueError as error:
            raise InputError(f"{path.name}: {error}.") from error
    _check_size(path)
    # Imported here: it is slow to load, and not needed for a stored picture.
    from apd_viewer.session.storage.session_file import open_session

    state, view = open_session(path)
    document = state.document
    colors = label_colors(document.labels, document.member)[:, :3]
    return _colored_picture(
        state.frame.U, document.mesh.F, colors, view.up_axis or _up_axis(document.mesh.path), size
    )


def _mesh_thumbnail(path: Path, size: int) -> np.ndarray:
    _check_size(path)
    mesh = open_mesh(path)
    return _colored_picture(mesh.V, mesh.F, mesh.colors, _up_axis(path), size)


def _check_size(path: Path) -> None:
    if path.stat().st_size > MOST_BYTES:
        raise InputError(tr("{name} is too large for a thumbnail.").format(name=path.name))


def _up_axis(path: Path | None) -> UpAxis:
    return UpAxis.from_suffix("" if path is None else path.suffix) or UpAxis.PLUS_Y


def _colored_picture(
    U: np.ndarray, F: np.ndarray, colors: np.ndarray | None, up: UpAxis, size: int
) -> np.ndarray:
    """Picture of a shape with its vertex colours (n, 3), if any."""
    paint = FREE_COLOR if colors is None else np.rint(colors[F].mean(axis=1)).astype(np.uint8)
    look = np.array(VIEW_DIRECTION) @ up.frame
    return shape_picture([U], F, [paint], size, tuple(look), tuple(up.direction))
