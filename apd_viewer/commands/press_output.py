"""Output of a press: table, report and summary."""

from __future__ import annotations

from typing import TYPE_CHECKING

from apd_viewer.commands.plain_numbers import signed
from apd_viewer.files.report import room_of
from apd_viewer.geometry.analysis.shape_check import check_shape
from apd_viewer.language import tr

if TYPE_CHECKING:
    from pathlib import Path

    from apd_viewer.files.tables import Cell
    from apd_viewer.geometry.energy.rest_mesh import RestMesh
    from apd_viewer.geometry.mesh.mesh import Mesh
    from apd_viewer.geometry.pressing.plate_press import PressStep
    from apd_viewer.geometry.pressing.press import Pressed
    from apd_viewer.geometry.pressing.press_options import PressOptions


def row_of(step: PressStep, opening: bool) -> dict[str, Cell]:
    """Row of the table by column name, of plates that close or open."""
    return {
        "distance": step.distance,
        "load_low": step.load_low,
        "load_high": step.load_high,
        "energy": step.energy,
        "volume": step.volume,
        "volume_capped": step.volume_capped,
        "area_error": step.area_error,
        "crossings": step.crossings,
        "iterations": step.iterations,
        "settled": step.settled,
        "opening": opening,
    }


def rows_of(found: Pressed) -> list[dict[str, Cell]]:
    """Rows of the table: as the plates close, then as they open."""
    closing = [row_of(step, False) for step in found.steps]
    return closing + [row_of(step, True) for step in found.released]


def report_of(mesh: Mesh, rest: RestMesh, found: Pressed, options: PressOptions) -> dict[str, object]:
    """Fields of the report."""
    last = found.last
    room: dict[str, object] = {}
    for U, suffix in ((mesh.V, "_rest"), (found.U, "")):
        readings = room_of(check_shape(U, mesh.joined_F))
        room |= {f"{name}{suffix}": reading for name, reading in readings.items()}
    return {
        "mesh": mesh.name,
        "vertices": len(mesh.V),
        "faces": len(mesh.F),
        "method": options.method,
        "stiffness": options.stiffness,
        "yield_radius": options.yield_radius,
        "area_rest": rest.area,
        "volume_rest": rest.volume,
        "volume_capped_rest": rest.volume_capped,
        **row_of(last, bool(found.released)),
        "stopped": found.stopped,
        **found.curve._asdict(),
        **room,
    }


def summary(found: Pressed, rest: RestMesh, output: Path) -> str:
    """Lines on a press, for the terminal."""
    last, first = found.steps[-1], found.steps[0]
    lines = [
        tr("{output}: plates {distance:.4g} apart, {share:.1f} % of the first distance").format(
            output=output, distance=last.distance, share=100 * last.distance / first.distance
        ),
        tr("load    {low:.5g} below, {high:.5g} above (of a material of stiffness 1)").format(
            low=last.load_low, high=last.load_high
        ),
    ]
    lines += _volume_line(tr("volume  {volume:.6g} of {rest:.6g} ({change} %)"), last, rest)
    if found.released:
        lines += _volume_line(tr("opened  {volume:.6g} of {rest:.6g} ({change} %) remain"), found.last, rest)
    lines.append(tr("area    {change} %").format(change=signed(100 * last.area_error, 3)))
    curve = found.curve
    if curve.yield_load is not None:
        lines.append(
            tr("yields at a load of {load:.5g}, pressed by {deflection:.4g}").format(
                load=curve.yield_load, deflection=curve.yield_deflection
            )
        )
    if curve.apparent_stiffness is not None:
        lines.append(
            tr("apparent stiffness {stiffness:.5g}, work {work:.5g}").format(
                stiffness=curve.apparent_stiffness, work=curve.work
            )
        )
    if last.crossings:
        lines.append(tr("{count:,} triangles cross others").format(count=last.crossings))
    if found.stopped:
        lines.append(
            tr("Contact lets the plates come no nearer to each other than {distance:.4g}.").format(
                distance=last.distance
            )
        )
    if not all(step.settled for step in found.steps + found.released):
        lines.append(tr("Not every step came to rest; allow more iterations."))
    return "\n".join(lines)


def _volume_line(words: str, step: PressStep, rest: RestMesh) -> list[str]:
    """Line on the volume of a step; none where nothing is enclosed."""
    now, at_rest = step.volume, rest.volume
    if now is None:
        now, at_rest = step.volume_capped, rest.volume_capped
    if now is None or not at_rest:
        return []
    return [words.format(volume=now, rest=at_rest, change=signed(100 * (now / at_rest - 1), 3))]
