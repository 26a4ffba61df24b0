"""Status messages about files, findings and warnings."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from apd_viewer.files.known_file import FileState
from apd_viewer.geometry.mesh.arrays import frozen, used_vertices
from apd_viewer.geometry.pose.held_turn import pass_through_warnings
from apd_viewer.language import tr, trn
from apd_viewer.notation import localized_number
from apd_viewer.session.quantities.units import Unit

if TYPE_CHECKING:
    from apd_viewer.files.fe_deck import Deck
    from apd_viewer.files.selections.selection import Selection
    from apd_viewer.geometry.analysis.mesh_findings import Finding
    from apd_viewer.geometry.analysis.shape_check import ShapeCheck
    from apd_viewer.geometry.analysis.target_shape import TargetShape
    from apd_viewer.geometry.mesh.mesh import Mesh
    from apd_viewer.session.model.document import Document
    from apd_viewer.session.model.state import State

LOAD_AGAIN = tr("Another mesh was opened meanwhile; load the file again.")


def findings_sentences(findings: Sequence[Finding]) -> str | None:
    """Sentences about the findings of an opened mesh; None if there is none.

    Findings about its file are quoted; others are only mentioned, as meshes of some formats always have some.
    """
    sentences = [finding.sentence for finding in findings if finding.is_about_file or len(findings) == 1]
    if len(findings) > len(sentences):
        # No count is given: findings on the current shape are still computed in the background.
        sentences.append(
            tr("The mesh check has found issues; click the badge at the lower right to see them.")
        )
    return " ".join(sentences) or None


def export_sentence(name: str, area: float, rest_area: float, unit: Unit) -> str:
    """Sentence about an exported mesh: the area measured on the file."""
    return tr("Exported {name}: area {area}, {percent:.3f} % of the rest area.").format(
        name=name, area=unit.format_area(localized_number(f"{area:.6g}")), percent=100.0 * area / rest_area
    )


def deck_sentence(name: str, deck: Deck) -> str:
    """Sentence about an FE deck: its size and number of held nodes."""
    sentence = trn(
        "{name}: {shells:,} shells, {held:,} held nodes, {n} step.",
        "{name}: {shells:,} shells, {held:,} held nodes, {n} steps.",
        len(deck.steps),
    )
    return sentence.format(name=name, shells=len(deck.used_faces), held=deck.held_count, n=len(deck.steps))


def baking_sentence(area: float, before: float, unit: Unit) -> str:
    """Sentence about a new rest area, with its ratio to the previous one."""
    return tr(
        "New rest shape: 100 % is now {area}, {percent} % of before, and motions count from here. "
        "Undo to go back."
    ).format(
        area=unit.format_area(localized_number(f"{area:.6g}")),
        percent=localized_number(f"{100.0 * area / before:.3f}"),
    )


def saved_session_sentence(name: str, embedded: bool, left_out: int = 0) -> str:
    """Sentences about a saved session and the steps that it leaves out."""
    sentence = tr("Saved {name}, including a copy of the mesh.") if embedded else tr("Saved {name}.")
    if left_out:
        some = trn(
            "It leaves out the first step of the timeline.",
            "It leaves out {n:,} steps of the timeline.",
            left_out,
        )
        sentence = f"{sentence} {some.format(n=left_out)}"
    return sentence.format(name=name)


_LOST = {
    FileState.CHANGED: tr("{name} has been changed by another window or program."),
    FileState.GONE: tr("{name} has been moved or deleted."),
    FileState.INCOMPLETE: tr("The mesh of {name} has been moved, changed or deleted."),
}


def lost_file_text(name: str, file_state: FileState) -> str:
    """Sentence about a changed or missing session file; empty otherwise."""
    return _LOST[file_state].format(name=name) if file_state in _LOST else ""


def lost_file_sentences(name: str, file_state: FileState) -> str:
    """Sentences about a lost file, with a remedy."""
    remedy = tr("The changes shown here are in no file until you save them.")
    return f"{lost_file_text(name, file_state)} {remedy}"


def saved_selection_sentence(name: str, left_out: Sequence[str]) -> str:
    """Sentence about a saved selection."""
    sentence = tr("Saved {name}, without the {things}.") if left_out else tr("Saved {name}.")
    return sentence.format(name=name, things=tr(" and the ").join(left_out))


def loaded_selection_sentence(name: str, selection: Selection) -> str:
    """Sentence about a loaded selection."""
    if selection.is_for_same_mesh:
        return tr("Selection loaded from {name}.").format(name=name)
    return tr(
        "Selection loaded from {name}; it was made for another shape with the same number of vertices."
    ).format(name=name)


def missing_target_sentence(document: Document) -> str | None:
    """Sentence about a missing target shape; None if nothing is missing."""
    missing = document.missing_target_shape
    return None if missing is None else tr("The target shape is not shown: {why}").format(why=missing.reason)


def target_sentence(target: TargetShape, mesh: Mesh) -> str:
    """Sentence about a loaded target shape, with a warning if its size differs."""
    name, factor = target.mesh.name, target.size_ratio(mesh)
    if factor is None:
        return tr("Comparing with {name}.").format(name=name)
    return tr(
        "{name} is {factor} times as large as {mesh}; check its unit of length and scale its file."
    ).format(name=name, factor=localized_number(f"{factor:.3g}"), mesh=mesh.name)


def lock_sentence(name: str) -> str:
    """Sentence about a locked part that prevents a change."""
    return tr("{name} is locked; unlock it in the panel first.").format(name=name)


def caps_phrase(openings: int) -> str:
    """Phrase about capped openings in a volume."""
    phrase = trn("with its opening capped flat", "with its {n:,} openings capped flat", openings)
    return phrase.format(n=openings)


def exempt_zone_findings(mesh: Mesh, crossing: np.ndarray | None) -> tuple[Finding, ...]:
    """Finding on vertices exempt from contact, near triangles crossing at rest."""
    if crossing is None or not len(crossing):
        return ()
    # Imported here: other functions of this file are needed before these modules are loaded.
    from apd_viewer.geometry.analysis.mesh_findings import Finding
    from apd_viewer.geometry.contact.contact import is_near_crossing

    near = is_near_crossing(mesh.joined_F, crossing, len(mesh.V))
    where = frozen(np.flatnonzero(near[mesh.weld.representative]))
    sentence = tr(
        "{n:,} triangles cross at rest; contact ignores the {vertices:,} vertices near them."
    ).format(n=len(crossing), vertices=len(where))
    return (Finding("exempt from contact", sentence, where),)


def crossing_findings(mesh: Mesh, crossing: np.ndarray | None) -> tuple[Finding, ...]:
    """Finding about intersecting triangles; empty if there are none."""
    if crossing is None or not len(crossing):
        return ()
    # Imported here: other functions of this file are needed before that module is loaded.
    from apd_viewer.geometry.analysis.mesh_findings import Finding

    sentence = tr("{n:,} intersecting triangles; the volume counts overlaps twice.")
    where = frozen(used_vertices(mesh.F[crossing]))
    return (Finding("self-intersections", sentence.format(n=len(crossing)), where),)


def self_intersection_warnings(state: State, check: ShapeCheck | None) -> tuple[str, ...]:
    """Warnings about a surface passing through itself; empty if unchecked."""
    if check is None:
        return ()
    names = [handle.name for handle in state.document.handles]
    touch = state.is_contact_active, state.document.settings.traits.may_use_contact
    return pass_through_warnings(check.turns, state.frame, state.inspection.volume, *touch, names)


def held_turn_phrase(check: ShapeCheck | None, k: int) -> str:
    """Phrase about the turn of handle ``k`` reached by the surface; empty if unknown."""
    held = check.turns[k].degrees[1] if check is not None and k < len(check.turns) else None
    return "" if held is None else tr("the surface holds {angle:.1f}°").format(angle=held).replace("-", "−")
