"""Steps of sweeps."""

from __future__ import annotations

from typing import NamedTuple

from apd_viewer.geometry.pose.frame import Frame
from apd_viewer.geometry.pose.held_turn import HeldTurn, most_lost_turn


class SweepStep(NamedTuple):
    """Shape on the way of a sweep, and its readings.

    Attributes
    ----------
    method : str
    number : int
        From 0, where nothing has moved yet.
    share : float
        Of the motion: 0 to 1, and beyond 1 past it.
    degrees : float
        By how much the first handle that moves has turned.
    displacement : float
        How far its pivot is from where it was, mesh units.
    frame : Frame
    volume_rest, volume_capped_rest : float or None
        With flat caps over its openings; None without any.
    energy : float
        ARAP energy (Eq. 1, each undirected edge counted twice) with optimal rotations, whatever the method.
    loads : tuple of float
        Length of the force on each obstacle, energy per length: that of a material of stiffness 1.
    turns : tuple of HeldTurn, of the handles so far
    """

    method: str
    number: int
    share: float
    degrees: float
    displacement: float
    frame: Frame
    volume_rest: float | None
    volume_capped_rest: float | None
    energy: float
    loads: tuple[float, ...] = ()
    turns: tuple[HeldTurn, ...] = ()

    @property
    def turn_degrees(self) -> tuple[float, float | None]:
        """Turn asked and held, degrees; of several handles the one with the largest loss."""
        return most_lost_turn(self.turns).degrees

    @property
    def volume_error(self) -> float | None:
        """Relative change of the volume, openings capped; None if none is enclosed."""
        now, rest = self.frame.volume, self.volume_rest
        if now is None:
            now, rest = self.frame.volume_capped, self.volume_capped_rest
        return None if now is None or not rest else now / rest - 1.0
