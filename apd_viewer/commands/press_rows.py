"""Table of a press, row by row."""

from __future__ import annotations

from apd_viewer.commands.press_wall import NewtonConversion
from apd_viewer.files.tables import Cell
from apd_viewer.geometry.pressing.press_step import PressStep
from apd_viewer.geometry.pressing.pressed_mesh import Pressed


def press_row(
    step: PressStep, is_opening: bool, pressed: Pressed, newtons: NewtonConversion | None = None
) -> dict[str, Cell]:
    """Row of the table by column name, with newtons where they are known."""
    row: dict[str, Cell] = {
        "distance": step.distance,
        "load_low": step.load_low,
        "load_high": step.load_high,
        "load_excess_percent": None if pressed.load_excess is None else 100.0 * pressed.load_excess,
        "stretching_percent": 100.0 * step.stretching,
        "energy": step.energy,
        "volume": step.volume,
        "volume_capped": step.volume_capped,
        "area_error": step.area_error,
        "crossings": step.crossings,
        "iterations": step.iterations,
        "settled": step.settled,
        "opening": is_opening,
    }
    if newtons is not None:
        row["load_low_newton"] = newtons.newtons_per_load * step.load_low
        row["load_high_newton"] = newtons.newtons_per_load * step.load_high
        row["newton_factor"] = newtons.underestimate_factor(step.stretching)
    return row


def press_rows(pressed: Pressed, newtons: NewtonConversion | None = None) -> list[dict[str, Cell]]:
    """Rows of the table: as the plates close, then as they open."""
    closing = [press_row(step, False, pressed, newtons) for step in pressed.steps]
    return closing + [press_row(step, True, pressed, newtons) for step in pressed.released]
