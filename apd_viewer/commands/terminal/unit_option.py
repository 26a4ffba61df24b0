"""The option for the unit of a mesh, named where a length needs it."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager

from apd_viewer.errors import InputError
from apd_viewer.language import tr
from apd_viewer.session.quantities.units import NoUnitError


@contextmanager
def naming_unit_option() -> Iterator[None]:
    """Name the option in the refusal of a length without the unit of the mesh."""
    try:
        yield
    except NoUnitError as error:
        raise InputError(
            tr(
                "The unit of the mesh is not set; add --unit mm, cm, m, in or ft for a length in {word}."
            ).format(word=error.word)
        ) from error
