"""Sentences about files opened and written."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from apd_viewer.files.known_file import Fate
from apd_viewer.geometry.mesh.arrays import frozen
from apd_viewer.geometry.turns.held_turn import passing_warnings
from apd_viewer.language import tr, trn
from apd_viewer.notation import written
from apd_viewer.session.quantities.units import Unit

if TYPE_CHECKING:
    from apd_viewer.files.fe_deck import Deck
    from apd_viewer.files.selections.selection import Selection
    from apd_viewer.geometry.analysis.findings import Finding
    from apd_viewer.geometry.analysis.shape_check import ShapeCheck
    from apd_viewer.geometry.analysis.target_shape import TargetShape
    from apd_viewer.geometry.mesh.mesh import Mesh
    from apd_viewer.session.model.document import Document
    from apd_viewer.session.model.state import State


def about_findings(findings: Sequence[Finding]) -> str | None:
    """Sentences about the findings of an opened mesh; None if there are none.

    Those about its file are told as they are, since much else is found in any file of some formats.
    """
    said = [finding.sentence for finding in findings if finding.is_about_file or len(findings) == 1]
    if len(findings) > len(said):
        # Without their number: those about the current shape are searched for in the background.
        said.append(tr("The mesh check has found issues; click the badge at the lower right to see them."))
    return " ".join(said) or None


def about_export(name: str, area: float, at_rest: float, unit: Unit) -> str:
    """Sentence about an exported mesh: the area measured on the file."""
    return tr("Exported {name}: area {area}, {percent:.3f} % of the rest area.").format(
        name=name, area=unit.area(written(f"{area:.6g}")), percent=100.0 * area / at_rest
    )


def about_deck(name: str, deck: Deck) -> str:
    """Sentence about an FE deck: its size, and how much of it is held."""
    said = trn(
        "{name}: {shells:,} shells, {held:,} held nodes, {n} step.",
        "{name}: {shells:,} shells, {held:,} held nodes, {n} steps.",
        len(deck.steps),
    )
    held = sum(len(part.vertices) for part in deck.held)
    return said.format(name=name, shells=len(deck.used), held=held, n=len(deck.steps))


def about_baking(area: float, before: float, unit: Unit) -> str:
    """Sentence about a new rest area, and its share of the one before."""
    return tr(
        "New rest shape: 100 % is now {area}, {percent} % of before, and motions count from here. "
        "Undo to go back."
    ).format(area=unit.area(written(f"{area:.6g}")), percent=written(f"{100.0 * area / before:.3f}"))


def about_session(name: str, embedded: bool) -> str:
    """Sentence about a saved session."""
    said = tr("Saved {name}, including a copy of the mesh.") if embedded else tr("Saved {name}.")
    return said.format(name=name)


_LOST = {
    Fate.CHANGED: tr("{name} has been changed by another window or program."),
    Fate.GONE: tr("{name} has been moved or deleted."),
    Fate.INCOMPLETE: tr("The mesh of {name} has been moved, changed or deleted."),
}


def lost_file(name: str, found: Fate) -> str:
    """Sentence about a session file changed or gone; empty if it is neither."""
    return _LOST[found].format(name=name) if found in _LOST else ""


def about_lost_file(name: str, found: Fate) -> str:
    """Sentences about a lost file, and what to do."""
    remedy = tr("What is shown here is in no file until you save it.")
    return f"{lost_file(name, found)} {remedy}"


def about_selection(name: str, left_out: Sequence[str]) -> str:
    """Sentence about a saved selection."""
    said = tr("Saved {name}, without the {things}.") if left_out else tr("Saved {name}.")
    return said.format(name=name, things=tr(" and the ").join(left_out))


def about_loaded_selection(name: str, selection: Selection) -> str:
    """Sentence about a loaded selection."""
    if selection.same_mesh:
        return tr("Selection loaded from {name}.").format(name=name)
    return tr(
        "Selection loaded from {name}; it was made for another shape with the same number of vertices."
    ).format(name=name)


def about_missing_target(document: Document) -> str | None:
    """Sentence about a target shape that was not found again; None if there is none."""
    missing = document.missing_target
    return None if missing is None else tr("The target shape is not shown: {why}").format(why=missing.why)


def about_target(target: TargetShape, mesh: Mesh) -> str:
    """Sentence about a loaded target shape, and about its size if that is another."""
    name, factor = target.mesh.name, target.misfit(mesh)
    if factor is None:
        return tr("Comparing with {name}.").format(name=name)
    return tr(
        "{name} is {factor} times as large as {mesh}; check its unit of length and scale its file."
    ).format(name=name, factor=written(f"{factor:.3g}"), mesh=mesh.name)


def about_lock(name: str) -> str:
    """Sentence about a locked part refusing a change."""
    return tr("{name} is locked; unlock it in the panel first.").format(name=name)


def about_caps(openings: int) -> str:
    """Phrase about capped openings in a volume."""
    said = trn("with its opening capped flat", "with its {n:,} openings capped flat", openings)
    return said.format(n=openings)


def of_exempt(mesh: Mesh, crossing: np.ndarray | None) -> tuple[Finding, ...]:
    """Finding about what contact leaves as it is, by the triangles crossing at rest."""
    if crossing is None or not len(crossing):
        return ()
    # Here, because the window shows some of these sentences before they are loaded.
    from apd_viewer.geometry.analysis.findings import Finding
    from apd_viewer.geometry.contact.exempt_zones import near_crossing

    near = near_crossing(mesh.joined_F, crossing, len(mesh.V))
    where = frozen(np.flatnonzero(near[mesh.weld.representative]))
    said = tr(
        "{n:,} triangles cross at rest; contact leaves the {vertices:,} vertices near them as they are."
    ).format(n=len(crossing), vertices=len(where))
    return (Finding("exempt from contact", said, where),)


def of_crossings(mesh: Mesh, crossing: np.ndarray | None) -> tuple[Finding, ...]:
    """Finding about intersecting triangles; empty if there are none."""
    if crossing is None or not len(crossing):
        return ()
    # Here, because the window shows some of these sentences before it is loaded.
    from apd_viewer.geometry.analysis.findings import Finding

    said = tr("{n:,} intersecting triangles; the volume counts overlaps twice.")
    where = frozen(np.unique(mesh.F[crossing]))
    return (Finding("self-intersections", said.format(n=len(crossing)), where),)


def of_passing(state: State, found: ShapeCheck | None) -> tuple[str, ...]:
    """Sentences on signs of a surface passing through itself, as far as known."""
    if found is None:
        return ()
    names = [handle.name for handle in state.document.handles]
    touch = state.keeps_apart, state.document.traits.may_touch
    return passing_warnings(found.turns, state.frame, state.inspection.volume, *touch, names)


def of_held_turn(found: ShapeCheck | None, k: int) -> str:
    """Turn of handle ``k`` held by the surface, as a phrase; empty without a turn."""
    held = found.turns[k].degrees[1] if found is not None and k < len(found.turns) else None
    return "" if held is None else tr("the surface holds {angle:.1f}°").format(angle=held).replace("-", "−")
