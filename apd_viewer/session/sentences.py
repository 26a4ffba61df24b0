"""What is told of files that were opened and written."""

from __future__ import annotations

from collections.abc import Sequence

from apd_viewer.files.selection import Selection
from apd_viewer.geometry.inspection import Finding
from apd_viewer.language import tr
from apd_viewer.session.units import Unit


def about_findings(findings: Sequence[Finding]) -> str | None:
    """What is unusual about a mesh that was opened; None if nothing is."""
    if len(findings) > 1:
        count = f"{len(findings)} findings"
        return f"The mesh has {count}: the badge at the lower right lists and shows them."
    return findings[0].sentence if findings else None


def about_export(name: str, area: float, at_rest: float, unit: Unit) -> str:
    """What is in a mesh file that was written: the area measured on it."""
    return (
        f"Exported {name}: area {unit.area(f'{area:.6g}')}, {100.0 * area / at_rest:.3f} % of the rest area."
    )


def about_baking(area: float, before: float, unit: Unit) -> str:
    """What is 100 % from now on, and what it was of the rest area before."""
    return tr("This is the rest shape now: 100 % is {area}, {percent} % of before. Undo goes back.").format(
        area=unit.area(f"{area:.6g}"), percent=f"{100.0 * area / before:.3f}"
    )


def about_session(name: str, embedded: bool) -> str:
    """What is in a session file that was written."""
    return f"Saved {name}, with a copy of the mesh in it." if embedded else f"Saved {name}."


def about_selection(name: str, left_out: Sequence[str]) -> str:
    """What is in a selection file that was written."""
    return f"Saved {name}, without the {' and the '.join(left_out)}." if left_out else f"Saved {name}."


def about_loaded_selection(name: str, selection: Selection) -> str:
    """What a selection file was made for."""
    other = "" if selection.same_mesh else "; it was made for another shape of as many vertices"
    return f"Painted as {name} says{other}."
