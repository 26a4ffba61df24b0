"""What is told of files that were opened and written."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from apd_viewer.geometry.mesh.arrays import frozen
from apd_viewer.language import tr, trn
from apd_viewer.session.quantities.units import Unit

if TYPE_CHECKING:
    from apd_viewer.files.selections.selection import Selection
    from apd_viewer.geometry.analysis.findings import Finding
    from apd_viewer.geometry.mesh.mesh import Mesh


def about_findings(findings: Sequence[Finding]) -> str | None:
    """What is unusual about a mesh that was opened; None if nothing is."""
    if len(findings) > 1:
        n = len(findings)
        return trn(
            "Mesh check: {n} issue; click the badge at the lower right to see it.",
            "Mesh check: {n} issues; click the badge at the lower right to see them.",
            n,
        ).format(n=n)
    return findings[0].sentence if findings else None


def about_export(name: str, area: float, at_rest: float, unit: Unit) -> str:
    """What is in a mesh file that was written: the area measured on it."""
    return tr("Exported {name}: area {area}, {percent:.3f} % of the rest area.").format(
        name=name, area=unit.area(f"{area:.6g}"), percent=100.0 * area / at_rest
    )


def about_baking(area: float, before: float, unit: Unit) -> str:
    """What is 100 % from now on, and what it was of the rest area before."""
    return tr("New rest shape: 100 % is now {area}, {percent} % of before. Undo to go back.").format(
        area=unit.area(f"{area:.6g}"), percent=f"{100.0 * area / before:.3f}"
    )


def about_session(name: str, embedded: bool) -> str:
    """What is in a session file that was written."""
    said = tr("Saved {name}, including a copy of the mesh.") if embedded else tr("Saved {name}.")
    return said.format(name=name)


def about_selection(name: str, left_out: Sequence[str]) -> str:
    """What is in a selection file that was written."""
    said = tr("Saved {name}, without the {things}.") if left_out else tr("Saved {name}.")
    return said.format(name=name, things=tr(" and the ").join(left_out))


def about_loaded_selection(name: str, selection: Selection) -> str:
    """What a selection file was made for."""
    if selection.same_mesh:
        return tr("Selection loaded from {name}.").format(name=name)
    return tr(
        "Selection loaded from {name}; it was made for another shape with the same number of vertices."
    ).format(name=name)


def about_caps(openings: int) -> str:
    """How a surface with so many openings was closed to measure its volume."""
    said = trn("with its opening capped flat", "with its {n:,} openings capped flat", openings)
    return said.format(n=openings)


def of_crossings(mesh: Mesh, crossing: np.ndarray | None) -> tuple[Finding, ...]:
    """What there is to say of the triangles that pass through others; nothing where there are none."""
    if crossing is None or not len(crossing):
        return ()
    # Here, because the window shows some of these sentences before it is loaded.
    from apd_viewer.geometry.analysis.findings import Finding

    said = tr("{n:,} intersecting triangles; the volume counts overlaps twice.")
    where = frozen(np.unique(mesh.F[crossing]))
    return (Finding("self-intersections", said.format(n=len(crossing)), where),)
