"""Findings of the open mesh: counted, listed and marked."""

from __future__ import annotations

from typing import NamedTuple

from PySide6.QtCore import QObject, QPointF, QRectF
from PySide6.QtWidgets import QApplication, QWidget

from apd_viewer.geometry.analysis.mesh_findings import SEPARATE_COMPONENTS, Finding
from apd_viewer.geometry.analysis.shape_check import SEAMS
from apd_viewer.session.model.loose_findings import loose_component_findings
from apd_viewer.session.session import Session
from apd_viewer.ui.overlays.finding_list import FindingList, FindingRow
from apd_viewer.ui.overlays.findings_badge import Badge, issue_count_text
from apd_viewer.ui.tools.canvas import Canvas


class ListedFinding(NamedTuple):
    """A finding in the list, and the loose parts that it is about."""

    finding: Finding
    components: tuple[int, ...] = ()


class FindingsController(QObject):
    """Keeps badge, list and marks in step.

    While the list is open the camera can be moved as ever. It closes, and the marks go, on Esc, on a
    click beside it, with the first stroke or drag of a handle, and when the keys go elsewhere.

    Parameters
    ----------
    canvas : Canvas
    badge : Badge
    session : Session

    Attributes
    ----------
    list : FindingList
    """

    def __init__(self, canvas: Canvas, badge: Badge, session: Session) -> None:
        super().__init__(canvas)
        self._canvas, self._session = canvas, session
        self._of_mesh: tuple[Finding, ...] = ()
        self._findings: tuple[Finding, ...] = ()
        self._listed: list[ListedFinding] = []
        self.badge = badge
        self.list = FindingList(canvas.viewport)
        self.badge.toggled.connect(self._toggle)
        self.list.chosen.connect(self._show)
        self.list.stay_toggled.connect(
            lambda k, on: session.settings.set_staying(self._listed[k].components, on)
        )
        self.list.weld_requested.connect(session.shapes.weld)
        self.list.dismissed.connect(self._dismiss)
        canvas.viewport.clicked.connect(self._clicked)
        for begun in (canvas.strokes.began, canvas.drag_began):
            begun.connect(self.close)

    def show_mesh_findings(self, findings: tuple[Finding, ...]) -> None:
        """Count the findings of another mesh; those of the one before are no longer shown."""
        self._of_mesh = findings
        self._count(findings)

    def show_shape_findings(self, findings: tuple[Finding, ...]) -> None:
        """Add the findings about the current shape until it changes."""
        if findings or len(self._findings) > len(self._of_mesh):
            self._count(self._of_mesh + findings)

    def _count(self, findings: tuple[Finding, ...]) -> None:
        self.close()
        self._findings = findings
        self.badge.show_count(len(findings))

    def open_at_last(self) -> None:
        """List the findings and mark the last one."""
        if self._findings and not self.badge.isChecked():
            self.toggle_list()
            self._show(len(self._listed) - 1)
            self.list.rows[-1].setFocus()

    def toggle_list(self) -> None:
        """List the findings, if there are any, or close the list."""
        self.badge.click()

    def close(self) -> bool:
        """Close the list and take the marks away; True if it was open."""
        was_open = self.badge.isChecked()
        self.badge.setChecked(False)
        return was_open

    def _toggle(self, on: bool) -> None:
        application = QApplication.instance()
        assert isinstance(application, QApplication)
        if on:
            self._listed = self._all_listed()
            rows = [FindingRow(each.sentence, parts, each.kind == SEAMS) for each, parts in self._listed]
            self.list.open(issue_count_text(len(self._findings)), rows)
            self.refresh()
            application.focusChanged.connect(self._follow_keys)
        else:
            application.focusChanged.disconnect(self._follow_keys)
            self.list.hide()
            self._canvas.coloring.mark(None)

    def refresh(self) -> None:
        """Show which loose parts stay."""
        if self.badge.isChecked():
            self.list.show_staying(self._session.store.required_state().document.staying_components)

    def _all_listed(self) -> list[ListedFinding]:
        """The findings, with the loose parts below the one about separate parts."""
        document = self._session.store.required_state().document
        listed = []
        for finding in self._findings:
            listed.append(ListedFinding(finding))
            if finding.kind == SEPARATE_COMPONENTS:
                listed += [ListedFinding(*each) for each in loose_component_findings(document)]
        return listed

    def _dismiss(self) -> None:
        self.close()
        self.badge.setFocus()

    def _show(self, number: int) -> None:
        self.list.show_marked(number)
        vertices = self._listed[number].finding.vertices
        self._canvas.coloring.mark(vertices)
        self._canvas.view.show_vertices(vertices, QRectF(self.list.geometry()))

    def _clicked(self, _: QPointF) -> None:
        self.close()

    def _follow_keys(self, _: QWidget | None, now: QWidget | None) -> None:
        """Close the list when the keys go to anything but it, the badge and the canvas."""
        stays = self.badge, self._canvas.viewport
        if now is not None and now not in stays and not self.list.isAncestorOf(now) and now is not self.list:
            self.close()
