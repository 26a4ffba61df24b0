"""Files that a mesh file names: those of its own folder, and no others.

A mesh may come from a stranger, and what it names is read without asking. So a name is resolved first, links
included, and only what then lies in the folder of the mesh or below it is opened.
"""

from __future__ import annotations

import os
import re
from pathlib import Path

from apd_viewer.errors import InputError
from apd_viewer.files.storage.regular_files import open_regular
from apd_viewer.language import tr

# Bytes: 44 million vertices with normals in single precision, far more than can be deformed. What a small
# file names, or holds packed, may be without end (sparse files, archives made to burst).
LARGEST_FILE = 1 << 30
_LONGEST = 80  # characters quoted from a file
# Schemes and drives; a file beside needs no colon.
_ELSEWHERE = re.compile(r"[/\\]|[^/\\]*:")
# No link made since the name was resolved is followed.
_FLAGS = getattr(os, "O_NOFOLLOW", 0)


def sibling_content(name: str, mesh: Path | None, most: int | None = None) -> bytes | None:
    """Content of a file that a mesh file names; None if there is no such file.

    Parameters
    ----------
    name : str
        As the mesh says it, relative to its folder; backslashes are slashes.
    mesh : path or None
        Of the mesh; without one there are no neighbours.
    most : int or None
        Bytes read at most; None is all of them.

    Raises
    ------
    InputError
        If the name leads out of the folder of the mesh, or there is more than :data:`LARGEST`.
    OSError
        If the file cannot be read.
    """
    place = _resolved(name, mesh)
    # os.path: Path raises on names that are too long.
    if place is None or not os.path.isfile(place):  # noqa: PTH113
        return None
    with open_regular(place, _FLAGS) as stream:
        size = os.fstat(stream.fileno()).st_size
        wanted = size if most is None else min(most, size)
        if wanted > LARGEST_FILE:
            raise too_large_error(name)
        return stream.read(wanted)


def too_large_error(name: str) -> InputError:
    """Error for a neighbour or an embedded part beyond :data:`LARGEST`."""
    return InputError(
        tr("The file names or holds more than {limit:.0f} GiB ({named}); reduce the mesh first.").format(
            limit=LARGEST_FILE / 2**30, named=_shown(name)
        )
    )


def _resolved(name: str, mesh: Path | None) -> str | None:
    """Real path of a name; raises InputError if outside, None if it can be no file."""
    if mesh is None or not name or "\0" in name:
        return None
    slashed = name.replace("\\", "/")
    # Before the disk is asked: on Windows a look at another computer already tells it who asks.
    if _ELSEWHERE.match(slashed) or Path(os.path.normpath(slashed)).parts[:1] == (os.pardir,):
        raise _outside(name, mesh)
    folder = os.path.realpath(mesh.parent)
    place = os.path.realpath(os.path.join(folder, slashed))  # noqa: PTH118
    if not Path(place).is_relative_to(folder):
        raise _outside(name, mesh)
    return place


def _outside(name: str, mesh: Path) -> InputError:
    return InputError(
        tr(
            "{mesh} names a file outside its folder ({named}), which is not read; "
            "copy that into the folder of the mesh and correct its name there."
        ).format(mesh=mesh.name, named=_shown(name))
    )


def _shown(name: str) -> str:
    said = "".join(sign if sign.isprintable() else " " for sign in name)
    return said if len(said) <= _LONGEST else said[:_LONGEST] + "…"
