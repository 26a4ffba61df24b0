"""Output of the ``press`` command about several runs."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from apd_viewer.commands.press_output import press_rows
from apd_viewer.files.tables import Cell
from apd_viewer.geometry.energy.material import Material
from apd_viewer.geometry.energy.rest_mesh import RestMesh
from apd_viewer.geometry.mesh.arrays import used_vertices
from apd_viewer.geometry.solver.linear_buckling import classical_load, knock_down_factor, round_radius
from apd_viewer.geometry.solver.press_band import PressBand
from apd_viewer.language import tr
from apd_viewer.presentation.number_format import format_exact, format_grouped, format_short
from apd_viewer.presentation.obstacle_readings import force_text
from apd_viewer.session.quantities.newton_conversion import NewtonConversion


class CylinderAsWide(NamedTuple):
    """Perfect cylinder of the pressed wall, as wide as a round body.

    Attributes
    ----------
    classical_load : float
        Axial load at which it buckles, at a material of stiffness 1.
    slenderness : float
        Radius over wall thickness.
    """

    classical_load: float
    slenderness: float

    @classmethod
    def between_plates(cls, rest: RestMesh, axis: np.ndarray, material: Material) -> CylinderAsWide | None:
        """Cylinder as wide as a mesh across an axis; None unless round and thin."""
        shape = rest.solve_mesh
        radius = round_radius(shape.V[used_vertices(shape.F)], axis)
        if radius is None or not material.thickness:
            return None
        return cls(classical_load(material), radius / material.thickness)

    @property
    def knock_down_factor(self) -> float | None:
        """Share of the classical load that designs count on; None if unknown."""
        return knock_down_factor(self.slenderness)


def band_rows(band: PressBand, newtons: NewtonConversion | None) -> list[dict[str, Cell]]:
    """Table rows of all runs, with their numbers."""
    return [{"run": k + 1} | row for k, each in enumerate(band.presses) for row in press_rows(each, newtons)]


def band_fields(
    band: PressBand,
    dents: float,
    heights: np.ndarray,
    newtons: NewtonConversion | None,
    cylinder: CylinderAsWide | None,
) -> dict[str, object]:
    """Fields of the JSON report on several runs."""
    yields = [(each.curve.yield_deflection, each.curve.yield_load) for each in band.presses]
    scale = None if newtons is None else newtons.newtons_per_load
    loads = [load for _, load in yields]
    fields: dict[str, object] = {
        "runs": len(band.presses),
        "dents_percent": dents,
        "yield_loads": loads,
        "yield_deflections": [deflection for deflection, _ in yields],
        "buckle_heights": [None if np.isnan(height) else float(height) for height in heights],
        "last_loads": [each.steps[-1].load for each in band.presses],
        "settled": [all(step.settled for step in each.steps) for each in band.presses],
    }
    if scale is not None:
        fields["yield_loads_newton"] = [None if load is None else scale * load for load in loads]
    if cylinder is not None:
        fields["classical_load"] = cylinder.classical_load
        fields["radius_over_thickness"] = cylinder.slenderness
        fields["knock_down_factor"] = cylinder.knock_down_factor
    return fields


def band_lines(
    band: PressBand,
    dents: float,
    heights: np.ndarray,
    newtons: NewtonConversion | None,
    cylinder: CylinderAsWide | None,
) -> list[str]:
    """Terminal lines about several runs; the lines before are about the first one.

    ``heights`` (r,) are those of the first buckles: see :meth:`PressBand.buckle_heights`.
    """
    deflections, loads = band.yields.T
    n, known = len(loads), np.isfinite(loads)
    lines = [
        tr(
            "{n} runs, each with other dents of {depth} % of the wall thickness; the lines above are of the "
            "first"
        ).format(n=n, depth=format_short(dents))
    ]
    if known.any():
        lines.append(
            tr("        yield at {loads}, mean {mean}, deflection {deflections}").format(
                loads=_range_text(loads[known], newtons),
                mean=force_text(float(loads[known].mean()), newtons),
                deflections=_between(*(format_exact(d, 4) for d in _ends(deflections[known]))),
            )
        )
        shares = (format_grouped(100.0 * share, 0) for share in _ends(heights[known]))
        lines.append(
            tr("        the first buckle comes at {heights} % of the height").format(
                heights=_between(*shares)
            )
        )
    counts = {
        tr("        the load only rises in {n} of them"): int(n - known.sum()),
        tr("        steps of {n} of them did not come to rest"): sum(
            not all(step.settled for step in each.steps) for each in band.presses
        ),
    }
    lines += [said.format(n=count) for said, count in counts.items() if count]
    if cylinder is not None:
        lines += [f"        {line}" for line in cylinder_lines(loads[known], newtons, cylinder)]
    return lines


def cylinder_lines(
    loads: np.ndarray, newtons: NewtonConversion | None, cylinder: CylinderAsWide
) -> list[str]:
    """Sentences on a perfect cylinder as wide, and the share of it at ``loads``."""
    share = ""
    if len(loads):
        least, most = (100.0 * load / cylinder.classical_load for load in _ends(loads))
        share = tr("; the runs yield at {range} % of it").format(
            range=_between(format_grouped(least, 0), format_grouped(most, 0))
        )
    lines = [
        tr("A perfect cylinder as wide would buckle at {load} along its axis{share}.").format(
            load=force_text(cylinder.classical_load, newtons), share=share
        )
    ]
    factor = cylinder.knock_down_factor
    if factor is not None:
        lines.append(
            tr("Designs by NASA SP-8007 count on {share:.0f} % of that, at R/t {ratio:.3g}.").format(
                share=100.0 * factor, ratio=cylinder.slenderness
            )
        )
    return lines


def _ends(values: np.ndarray) -> tuple[float, float]:
    return float(values.min()), float(values.max())


def _between(low: str, high: str) -> str:
    return low if low == high else tr("{low} to {high}").format(low=low, high=high)


def _range_text(loads: np.ndarray, newtons: NewtonConversion | None) -> str:
    return _between(*(force_text(load, newtons) for load in _ends(loads)))
