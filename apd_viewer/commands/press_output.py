"""Output of the ``press`` command: table, report and summary."""

from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any, NamedTuple

from apd_viewer.commands.terminal.columns import format_signed
from apd_viewer.errors import InputError
from apd_viewer.files.report import shape_check_fields
from apd_viewer.files.tables import Cell
from apd_viewer.geometry.analysis.shape_check import check_shape
from apd_viewer.geometry.energy.rest_mesh import RestMesh
from apd_viewer.geometry.energy.wall_map import WallMap
from apd_viewer.geometry.mesh.mesh import Mesh
from apd_viewer.geometry.solver.plate_press import PressStep
from apd_viewer.geometry.solver.pressed_mesh import Pressed
from apd_viewer.language import comma_separated, tr
from apd_viewer.presentation import obstacle_readings
from apd_viewer.presentation.number_format import format_exact, format_short
from apd_viewer.session.quantities.expressions import parse_length, parse_number
from apd_viewer.session.quantities.newton_conversion import NewtonConversion
from apd_viewer.session.quantities.units import Unit
from apd_viewer.session.quantities.wall import Wall
from apd_viewer.session.quantities.wall_material import GPA

# Newtons of a unit of weight; what ends in another one is tried first.
_WEIGHTS = {"kg": 9.80665, "g": 9.80665e-3, "kn": 1e3, "n": 1.0}


def press_row(
    step: PressStep, is_opening: bool, pressed: Pressed, newtons: NewtonConversion | None = None
) -> dict[str, Cell]:
    """Table row of a step by column name, with newtons if known."""
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
        "stable": step.stable,
        "opening": is_opening,
    }
    if newtons is not None:
        row["load_low_newton"] = newtons.newtons_per_load * step.load_low
        row["load_high_newton"] = newtons.newtons_per_load * step.load_high
        row["newton_factor"] = newtons.underestimate_factor(step.stretching)
    return row


def press_rows(pressed: Pressed, newtons: NewtonConversion | None = None) -> list[dict[str, Cell]]:
    """Table rows of the closing, then of the opening plates."""
    closing = [press_row(step, False, pressed, newtons) for step in pressed.steps]
    return closing + [press_row(step, True, pressed, newtons) for step in pressed.released]


def press_report(
    mesh: Mesh,
    rest: RestMesh,
    pressed: Pressed,
    settings: Mapping[str, object],
    wall: Wall,
    newtons: NewtonConversion | None,
) -> dict[str, object]:
    """Fields of the JSON report on a press."""
    room: dict[str, object] = {}
    pascals = pressure_pascals(settings, newtons)
    for U, suffix in ((mesh.V, "_rest"), (pressed.U, "")):
        readings = shape_check_fields(check_shape(U, mesh.joined_F))
        room |= {f"{name}{suffix}": reading for name, reading in readings.items()}
    return {
        "mesh": mesh.name,
        "vertices": len(mesh.V),
        "faces": len(mesh.F),
        **{name: settings[name] for name in ("method", "stiffness", "yield_radius", "hardening")},
        **{name: settings[name] for name in ("gas", "pressure")},
        "area_rest": rest.area,
        "volume_rest": rest.volume,
        "volume_capped_rest": rest.volume_capped,
        **press_row(pressed.last, bool(pressed.released), pressed, newtons),
        "stopped": pressed.stopped,
        **pressed.curve._asdict(),
        **_wall_fields(wall, rest.area),
        **(_newton_fields(pressed, newtons) if newtons else {}),
        **({} if pascals is None else {"pressure_pascal": pascals}),
        **room,
    }


def pressure_pascals(settings: Mapping[str, Any], newtons: NewtonConversion | None) -> float | None:
    """Pressure inside less outside, Pa; None without one or without newtons."""
    pressure = settings["pressure"]
    return None if pressure is None or newtons is None else pressure * newtons.pascals_per_pressure


def _wall_fields(wall: Wall, area: float) -> dict[str, object]:
    """Report fields of the known wall properties."""
    material = wall.material
    fields = {
        "unit": wall.unit.symbol or None,
        "unit_is_guess": wall.unit.is_guess or None,
        "material": material and material.name,
        "material_source": material and material.source,
        "wall_thickness": wall.thickness,
        "density": wall.density,
        "young": wall.young,
        "poisson": None if wall.young is None else wall.nu,
        "mass_grams": wall.grams(area),
    }
    if isinstance(wall.thickness, WallMap):
        every = wall.thickness.triangles
        fields |= {"wall_thickness_least": float(every.min()), "wall_thickness_most": float(every.max())}
        for name in ("young", "yield_radius"):
            mean, mapped = getattr(wall, name), getattr(wall.thickness, name)
            if mean is not None and mapped is not None:
                ends = {"least": mapped.factors.min(), "most": mapped.factors.max()}
                fields |= {f"{name}_{end}": float(mean * factor) for end, factor in ends.items()}
    return {name: value for name, value in fields.items() if value is not None}


def _newton_fields(found: Pressed, newtons: NewtonConversion) -> dict[str, object]:
    """Report fields of the load curve in newtons, joules and N/mm."""
    curve = found.curve
    factors = {
        "yield_load_newton": (curve.yield_load, newtons.newtons_per_load),
        "apparent_stiffness_newton_per_mm": (curve.apparent_stiffness, newtons.newtons_per_millimetre),
        "work_joule": (curve.work, newtons.joules_per_work),
    }
    scaled = {name: None if value is None else value * unit for name, (value, unit) in factors.items()}
    return {"newtons_per_load": newtons.newtons_per_load, "stiffness_of_wall": newtons.stiffness, **scaled}


class PressWeight(NamedTuple):
    """Weight on the upper plate.

    Attributes
    ----------
    newtons, load : float
        In newtons, and in the units of the loads.
    drop : float or None
        Height from which it falls, mesh units; None if it is set down slowly.
    unit : Unit
        Of the mesh.
    """

    newtons: float
    load: float
    drop: float | None
    unit: Unit


def still_weight(
    text: str | None, drop: str | None, newtons: NewtonConversion | None, unit: Unit
) -> PressWeight | None:
    """Weight from its texts such as ``2kg`` and ``1.2m``; raises InputError."""
    if text is None:
        if drop is not None:
            raise InputError(tr("A drop needs a weight; add --weight such as 2kg."))
        return None
    if newtons is None:
        raise InputError(tr("A weight needs newtons; add --material, or --thickness and --young."))
    word = text.strip().lower()
    symbol = next((each for each in _WEIGHTS if word.endswith(each)), None)
    force = _WEIGHTS[symbol] * parse_number(word.removesuffix(symbol), {}) if symbol else 0.0
    height = None if drop is None else parse_length(drop, unit, {})
    if not force > 0.0 or (height is not None and height < 0.0):
        raise InputError(tr("Enter a weight such as 2kg, 500g or 20N, and a height of at least 0."))
    return PressWeight(force, force / newtons.newtons_per_load, height, unit)


def weight_fields(weight: PressWeight | None, pressed: Pressed) -> dict[str, object]:
    """Report fields of a weight."""
    if weight is None:
        return {}
    stops = {} if weight.drop is None else {"drop_deflection": pressed.deflection_under(*weight[1:3])}
    return {
        "weight_newton": weight.newtons,
        "weight_deflection": pressed.deflection_under(weight.load),
        "drop": weight.drop,
        **stops,
    }


def weight_lines(weight: PressWeight | None, pressed: Pressed) -> list[str]:
    """Terminal lines about the deflection under a weight, at rest and dropped."""
    if weight is None:
        return []
    force = f"{format_exact(weight.newtons, 4)}\u00a0N"
    cases = {tr("weight  {force} at rest: {deflection}"): pressed.deflection_under(weight.load)}
    if weight.drop is not None:
        said = tr("weight  {force} dropped, as far as the still load tells: {deflection}")
        cases[said] = pressed.deflection_under(weight.load, weight.drop)
    return [
        words.format(
            force=force,
            deflection=tr("never borne up to the last step")
            if found is None
            else tr("deflection {length}").format(length=weight.unit.format_length(format_exact(found, 4))),
        )
        for words, found in cases.items()
    ]


def press_summary(
    pressed: Pressed,
    rest: RestMesh,
    output: Path,
    wall: Wall,
    newtons: NewtonConversion | None,
    extent: float,
    is_alone: bool = True,
) -> str:
    """Terminal lines about a press, ``is_alone`` or the first of several.

    ``extent`` is that of the mesh at the first touch.
    """
    last, first = pressed.steps[-1], pressed.steps[0]
    lines = [
        tr("{output}: plates {distance:.4g} apart, {share:.1f} % of the extent").format(
            output=output, distance=last.distance, share=100 * last.distance / extent
        ),
        *_load_lines(last, pressed, newtons, wall),
        *_volume_line(first.volume is None, last, rest, tr("volume"), ""),
    ]
    if pressed.released:
        lines += _volume_line(first.volume is None, pressed.last, rest, tr("opened"), tr(" remain"))
    lines.append(tr("area    {change} %").format(change=format_signed(100 * last.area_error, 3)))
    lines += _curve_lines(pressed, newtons, is_alone)
    lines += _wall_lines(wall, rest.area, pressed, newtons)
    if last.crossings:
        lines.append(tr("{n:,} intersecting triangles").format(n=last.crossings))
    if pressed.stopped:
        lines.append(
            tr("Contact keeps the plates at least {distance:.4g} apart.").format(distance=last.distance)
        )
    if not all(step.settled for step in pressed.steps + pressed.released):
        lines.append(tr("Not every step came to rest; allow more iterations."))
    return "\n".join(lines)


def _load_lines(step: PressStep, found: Pressed, newtons: NewtonConversion | None, wall: Wall) -> list[str]:
    low, high = step.load_low, step.load_high
    lines = [
        tr("load    {low:.5g} below, {high:.5g} above (for a material of stiffness 1); {excess}").format(
            low=low, high=high, excess=obstacle_readings.excess_phrase(found.load_excess)
        )
    ]
    if newtons is not None:
        lines.append(
            tr("        {low:.3g} N below, {high:.3g} N above, {conditions}").format(
                low=newtons.newtons_per_load * low,
                high=newtons.newtons_per_load * high,
                conditions=load_conditions(step.stretching, newtons, wall),
            )
        )
    return lines


_CREASING = tr("for this thin wall that keeps creases")


def load_conditions(stretching: float, newtons: NewtonConversion, wall: Wall) -> str:
    """Phrase stating the conditions for newtons, by the share of stretching."""
    if newtons.matches_wall:
        return tr("for this thin elastic wall") if wall.yield_radius is None else _CREASING
    off = obstacle_readings.error_factor_phrase(newtons.underestimate_factor(stretching))
    return off or tr("if walls bend and hardly stretch")


_GAVE_WAY = tr(
    "        Beyond that, readings of a thin wall depend on small imperfections: add --runs 10 to see by how "
    "much."
)


def _curve_lines(found: Pressed, newtons: NewtonConversion | None, is_alone: bool) -> list[str]:
    curve, lines = found.curve, []
    if curve.yield_load is not None:
        force = "" if newtons is None else _in_parentheses(newtons.newtons_per_load * curve.yield_load, "N")
        lines.append(
            tr("yields at a load of {load:.5g}{newtons}, deflection {deflection:.4g}").format(
                load=curve.yield_load, newtons=force, deflection=curve.yield_deflection
            )
        )
        if is_alone and newtons is not None and newtons.matches_wall:
            lines.append(_GAVE_WAY)
    if curve.apparent_stiffness is not None:
        slope = (
            ""
            if newtons is None
            else _in_parentheses(newtons.newtons_per_millimetre * curve.apparent_stiffness, "N/mm")
        )
        work = "" if newtons is None else _in_parentheses(newtons.joules_per_work * curve.work, "J")
        lines.append(
            tr("apparent stiffness {stiffness:.5g}{slope}, work {work:.5g}{joules}").format(
                stiffness=curve.apparent_stiffness, slope=slope, work=curve.work, joules=work
            )
        )
    return lines


def _wall_lines(wall: Wall, area: float, found: Pressed, newtons: NewtonConversion | None) -> list[str]:
    lines, grams = [], wall.grams(area)
    if wall.material or newtons is not None or grams is not None:
        lines.append(tr("wall    {wall}").format(wall=_wall_text(wall)))
    if wall.material:
        lines.append(tr("        source: {source}").format(source=wall.material.source))
    if grams is not None:
        unit, fraction = wall.unit.mass_unit(grams)
        lines.append(tr("mass    {mass:.4g} {unit}").format(mass=grams * fraction, unit=unit))
    if newtons is not None and not newtons.matches_wall:
        lines.append(
            tr("Pressed at a stiffness of {stiffness:.3g}; this wall has {own:.1g}.").format(
                stiffness=newtons.pressed_stiffness, own=newtons.stiffness
            )
        )
        if phrase := obstacle_readings.error_factor_phrase(newtons.underestimate_factor(found.stretching)):
            lines.append(
                tr(
                    "Stretching takes up to {share:.0f} % of the energy: newtons, N/mm and joules over the "
                    "whole path may be {off}."
                ).format(share=100.0 * found.stretching, off=phrase)
            )
    return lines


def _wall_text(wall: Wall) -> str:
    """Description of the known wall properties."""
    parts = [wall.material and wall.material.title]
    mapped = wall.thickness if isinstance(wall.thickness, WallMap) else None
    if wall.thickness is not None:
        parts.append(_between(wall.thickness, mapped, wall.unit.format_length))
    if wall.density is not None:
        parts.append(f"{format_short(wall.density)}\u00a0g/cm³")
    if wall.young is not None:
        parts.append(_between(wall.young / GPA, mapped and mapped.young, "{}\u00a0GPa".format))
        parts.append(tr("Poisson's ratio {ratio}").format(ratio=format_short(wall.nu)))
    if wall.yield_radius is not None:
        radius = _between(wall.yield_radius, mapped and mapped.yield_radius, wall.unit.format_length)
        parts.append(tr("yields below a radius of {radius}").format(radius=radius))
    return comma_separated(filter(None, parts))


def _between(mean: float, mapped: WallMap | None, said: Callable[[str], str]) -> str:
    """Mean of a property with its unit, and its ends if it is mapped."""
    if mapped is None:
        return said(format_short(mean))
    least, most = (said(format_short(mean * end)) for end in (mapped.factors.min(), mapped.factors.max()))
    return tr("{mean} on average, {least} to {most}").format(
        mean=said(format_short(mean)), least=least, most=most
    )


def _volume_line(capped: bool, step: PressStep, rest: RestMesh, title: str, remains: str) -> list[str]:
    """Line on the volume at a step; no line if none is enclosed."""
    now, at_rest = (step.volume_capped, rest.volume_capped) if capped else (step.volume, rest.volume)
    if now is None or not at_rest:
        return []
    return [
        tr("{title}  {volume:.6g} of {rest:.6g} ({change} %){remains}{capped}").format(
            title=title,
            volume=now,
            rest=at_rest,
            change=format_signed(100 * (now / at_rest - 1), 3),
            remains=remains,
            capped=tr(", openings capped flat") if capped else "",
        )
    ]


def _in_parentheses(value: float, unit: str) -> str:
    return f" ({format_exact(value, 3)} {unit})"
