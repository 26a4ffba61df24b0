"""Table of a press, row by row."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from apd_viewer.commands.press_wall import Newtons
    from apd_viewer.files.tables import Cell
    from apd_viewer.geometry.pressing.press import Pressed
    from apd_viewer.geometry.pressing.press_step import PressStep


def row_of(step: PressStep, opening: bool, found: Pressed, newtons: Newtons | None = None) -> dict[str, Cell]:
    """Row of the table by column name, with newtons where they are known."""
    row: dict[str, Cell] = {
        "distance": step.distance,
        "load_low": step.load_low,
        "load_high": step.load_high,
        "load_excess_percent": None if found.load_excess is None else 100.0 * found.load_excess,
        "stretching_percent": 100.0 * step.stretching,
        "energy": step.energy,
        "volume": step.volume,
        "volume_capped": step.volume_capped,
        "area_error": step.area_error,
        "crossings": step.crossings,
        "iterations": step.iterations,
        "settled": step.settled,
        "opening": opening,
    }
    if newtons is not None:
        row["load_low_newton"] = newtons.per_load * step.load_low
        row["load_high_newton"] = newtons.per_load * step.load_high
        row["newton_factor"] = newtons.too_low(step.stretching)
    return row


def rows_of(found: Pressed, newtons: Newtons | None = None) -> list[dict[str, Cell]]:
    """Rows of the table: as the plates close, then as they open."""
    closing = [row_of(step, False, found, newtons) for step in found.steps]
    return closing + [row_of(step, True, found, newtons) for step in found.released]
