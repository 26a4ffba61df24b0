"""Target of the volume from a text: percent of the rest volume, or a volume."""

from __future__ import annotations

from typing import NamedTuple

from apd_viewer.errors import InputError
from apd_viewer.geometry.goals.target_values import PERCENT_SIGN, percentage
from apd_viewer.language import tr
from apd_viewer.session.quantities.expressions import parse_volume
from apd_viewer.session.quantities.units import Unit


class VolumeTarget(NamedTuple):
    """Target of the volume, named as in :class:`Settings`; one of both is None.

    Attributes
    ----------
    volume : float or None
        Percent of the rest volume.
    filled_volume : float or None
        Cubic mesh units.
    """

    volume: float | None
    filled_volume: float | None


def is_percentage(text: str) -> bool:
    """True if a text is a bare number or ends with a percent sign."""
    number = text.strip()
    if number.endswith(PERCENT_SIGN):
        return True
    try:
        float(number)
    except ValueError:
        return False
    return True


def parse_volume_target(text: str, unit: Unit) -> VolumeTarget:
    """Volume target from a text such as ``120%``, ``120`` or ``250ml``.

    Parameters
    ----------
    text : str
    unit : Unit
        Unit of the mesh.

    Raises
    ------
    InputError
        If it is none, or a unit is written and that of the mesh is unknown.
    """
    if is_percentage(text):
        return VolumeTarget(percentage(text, "the volume"), None)
    filled = parse_volume(text, unit)
    if not filled > 0.0:
        raise InputError(tr("A volume to hold is greater than 0; enter one such as 250ml."))
    return VolumeTarget(None, filled)
