"""Controller, list and marks of the findings of the open mesh."""

from collections.abc import Callable, Sequence
from typing import NamedTuple

from PySide6.QtCore import QObject, QPointF, QRectF, Qt, Signal
from PySide6.QtGui import QColor, QKeyEvent, QMouseEvent, QPainter, QPaintEvent, QPen
from PySide6.QtWidgets import QApplication, QFrame, QLabel, QPushButton, QScrollArea, QVBoxLayout, QWidget

from apd_viewer.geometry.analysis.mesh_findings import SEPARATE_COMPONENTS, Finding
from apd_viewer.geometry.analysis.shape_check import SEAMS
from apd_viewer.language import tr
from apd_viewer.presentation.palette import MARK_COLOR
from apd_viewer.session.session import Session
from apd_viewer.session.shape_checks import loose_component_findings
from apd_viewer.ui.overlays.findings_badge import ENTER_KEYS, Badge, issue_count_text
from apd_viewer.ui.scene.viewport import Viewport
from apd_viewer.ui.tools.canvas import Canvas
from apd_viewer.ui.widgets.box_layouts import STRETCH, column_layout, row_layout
from apd_viewer.ui.widgets.fields import CheckBox, small_button
from apd_viewer.ui.widgets.theme import Theme, icon, set_style_property
from apd_viewer.ui.widgets.wheel import block_mouse_events

_NONE_FOUND = tr(
    "No issues. Checked: file, size and position, vertices, faces, edges, holes, orientation "
    "and loose components."
)


class ListedFinding(NamedTuple):
    """Row of the list: a finding, and the loose components it concerns."""

    finding: Finding
    components: tuple[int, ...] = ()


class FindingsController(QObject):
    """Keeps the badge, the list and the marks of the findings in step.

    The camera can be moved while the list is open. The list closes, and the marks are removed, on Esc, on a
    click beside it, at the first stroke or drag of a handle, and on loss of the keyboard focus.

    Parameters
    ----------
    say : callable
        Shows a sentence over the canvas.
    """

    def __init__(self, canvas: Canvas, badge: Badge, session: Session, say: Callable[[str], object]) -> None:
        super().__init__(canvas)
        self._canvas, self._session, self._say = canvas, session, say
        self._of_mesh: tuple[Finding, ...] = ()
        self._findings: tuple[Finding, ...] = ()
        self._listed: list[ListedFinding] = []
        self.badge = badge
        self.list = FindingList(canvas.viewport)
        self.badge.toggled.connect(self._toggle)
        self.list.chosen.connect(self._show)
        self.list.stay_toggled.connect(
            lambda k, on: session.settings.set_components_immobile(self._listed[k].components, on)
        )
        self.list.weld_requested.connect(session.shapes.weld)
        self.list.dismissed.connect(self._dismiss)
        canvas.viewport.clicked.connect(self._close_on_click)
        for begun in (canvas.strokes.began, canvas.drag_began):
            begun.connect(self.close)

    def show_mesh_findings(self, findings: tuple[Finding, ...]) -> None:
        """Replace the findings by those of a new mesh, and count them."""
        self._of_mesh = findings
        self._count(findings)

    def show_shape_findings(self, findings: tuple[Finding, ...]) -> None:
        """Add findings about the current shape; they expire when it changes."""
        if findings or len(self._findings) > len(self._of_mesh):
            self._count(self._of_mesh + findings)

    def _count(self, findings: tuple[Finding, ...]) -> None:
        if findings and [each.sentence for each in findings] == [each.sentence for each in self._findings]:
            self._findings = findings
            return
        self.close()
        self._findings = findings
        self.badge.show_count(len(findings))

    def open_at_last_finding(self) -> None:
        """Open the list and mark the last finding."""
        if self._findings and not self.badge.isChecked():
            self.toggle_list()
            self._show(len(self._listed) - 1)
            self.list.rows[-1].setFocus()

    def toggle_list(self) -> None:
        """Open the list or close it; say so where there is nothing to list."""
        if self._findings:
            self.badge.click()
        elif self._session.store.state is not None:
            self._say(_NONE_FOUND)

    def close(self) -> bool:
        """Close the list and remove the marks; True if it was open."""
        was_open = self.badge.isChecked()
        self.badge.setChecked(False)
        return was_open

    def _toggle(self, on: bool) -> None:
        application = QApplication.instance()
        assert isinstance(application, QApplication)
        if on:
            self._listed = self._listed_findings()
            rows = [FindingRow(each.sentence, parts, each.kind == SEAMS) for each, parts in self._listed]
            self.list.open(issue_count_text(len(self._findings)), rows)
            self.refresh()
            application.focusChanged.connect(self._close_on_focus_change)
        else:
            application.focusChanged.disconnect(self._close_on_focus_change)
            self.list.hide()
            self._canvas.coloring.mark(None)

    def refresh(self) -> None:
        """Update the check boxes of the immobile loose components."""
        if self.badge.isChecked():
            self.list.show_immobile_components(
                self._session.store.required_state().document.immobile_components
            )

    def _listed_findings(self) -> list[ListedFinding]:
        """All findings, with loose components listed below the finding about them."""
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
        self.list.show_marked_finding(number)
        vertices = self._listed[number].finding.vertices
        self._canvas.coloring.mark(vertices)
        self._canvas.view.show_vertices(vertices, QRectF(self.list.geometry()))

    def _close_on_click(self, _: QPointF) -> None:
        self.close()

    def _close_on_focus_change(self, _: QWidget | None, now: QWidget | None) -> None:
        """Close the list when the focus leaves the list, the badge and the canvas."""
        stays = self.badge, self._canvas.viewport
        if now is not None and now not in stays and not self.list.isAncestorOf(now) and now is not self.list:
            self.close()


_MARGIN = 12
_WIDEST = 380
_INDENT = 22  # indent of a loose component below its parent finding
_ROOM = 0.5  # largest height as a fraction of the canvas; keeps its middle, with the marked finding, free


class _Spot(QWidget):
    """Indicator ring, filled while its finding is marked on the mesh."""

    def __init__(self) -> None:
        super().__init__()
        self.setFixedSize(14, 18)
        self.on = False

    def paintEvent(self, _: QPaintEvent) -> None:
        painter = QPainter(self)
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        color = QColor(*MARK_COLOR) if self.on else self.palette().placeholderText().color()
        painter.setPen(QPen(color, 1.5))
        painter.setBrush(color if self.on else Qt.BrushStyle.NoBrush)
        painter.drawEllipse(QPointF(7, 9), 4.25, 4.25)


class FindingRow(QFrame):
    """Clickable row with the sentence of a finding.

    Attributes
    ----------
    step_requested : Signal(int)
        The arrow keys ask for the row above, -1, or below, 1.
    stay_toggled : Signal(bool)
        The parts of this row are to stay, or to go along.
    weld_requested : Signal()
        Request to weld the seams of the finding.

    Parameters
    ----------
    components : tuple of int
        The loose parts that it is about: each may stay.
    weldable : bool
        Whether it is about seams that can be welded.
    """

    chosen = Signal()
    step_requested = Signal(int)
    stay_toggled = Signal(bool)
    weld_requested = Signal()

    def __init__(self, sentence: str, components: tuple[int, ...] = (), weldable: bool = False) -> None:
        super().__init__(objectName="finding", focusPolicy=Qt.FocusPolicy.StrongFocus)
        self.setToolTip(tr("Show where this is"))
        self._sentence, self._parts = sentence, components
        self._spot = _Spot()
        centre = Qt.AlignmentFlag.AlignVCenter
        self.stay = CheckBox(tr("Stays"), visible=bool(components))
        self.stay.setToolTip(tr("Leave it in place; otherwise it goes along with the nearest surface"))
        self.stay.setAccessibleName(tr("{sentence} Stays in place.").format(sentence=sentence))
        self.stay.clicked.connect(self.stay_toggled)
        self.weld = QPushButton(tr("Weld"), visible=weldable)
        self.weld.setToolTip(tr("Hold the seams together; the file keeps all its vertices"))
        self.weld.clicked.connect(self.weld_requested)
        text = QLabel(sentence, wordWrap=True, textFormat=Qt.TextFormat.PlainText)
        spot = self._spot, 0, centre if components else Qt.AlignmentFlag.AlignTop
        margins = (_INDENT, 3, 8, 3) if components else (8, 6, 8, 6)
        row_layout(
            spot, (text, 1), (self.stay, 0, centre), (self.weld, 0, centre), margins=margins, parent=self
        )
        self.show_mark(False)

    def show_immobile_components(self, immobile: tuple[int, ...]) -> None:
        """Check the box if all components of the row are among the ``immobile`` ones."""
        self.stay.setChecked(set(self._parts) <= set(immobile))

    def show_mark(self, on: bool) -> None:
        """Show whether the finding is marked on the mesh."""
        self.setAccessibleName(
            tr("{sentence} Shown on the mesh.").format(sentence=self._sentence) if on else self._sentence
        )
        self._spot.on = on
        self._spot.update()
        set_style_property(self, "marked", on)

    def mousePressEvent(self, event: QMouseEvent) -> None:
        """Request the finding to be marked on the mesh."""
        if event.button() == Qt.MouseButton.LeftButton:
            self.setFocus()
            self.chosen.emit()

    def keyPressEvent(self, event: QKeyEvent) -> None:
        """Request the finding on Enter or Space; request a neighbour row on arrows."""
        if event.key() in (*ENTER_KEYS, Qt.Key.Key_Space):
            self.chosen.emit()
        elif event.key() in (Qt.Key.Key_Up, Qt.Key.Key_Down):
            self.step_requested.emit(-1 if event.key() == Qt.Key.Key_Up else 1)
        else:
            super().keyPressEvent(event)


class FindingList(QFrame):
    """All findings, at the lower right of the canvas, over the badge.

    Attributes
    ----------
    chosen : Signal(int)
        The row to be shown, by its number.
    stay_toggled : Signal(int, bool)
        The loose parts of a row, by its number, are to stay, or to go along.
    weld_requested : Signal()
        The seams are to be welded.
    dismissed : Signal()
        Esc, or the cross.
    """

    chosen = Signal(int)
    stay_toggled = Signal(int, bool)
    weld_requested = Signal()
    dismissed = Signal()

    def __init__(self, canvas: Viewport) -> None:
        super().__init__(canvas, objectName="findings")
        block_mouse_events(self)
        self._canvas = canvas
        self.rows: list[FindingRow] = []
        self._title = QLabel(objectName="heading")
        self.close_button = small_button(tr("Close mesh check"), tr("Close (Esc)"))
        self.close_button.clicked.connect(self.dismissed)
        head = row_layout((self._title, 1), self.close_button, margins=(8, 0, 0, 0), spacing=-1)
        self._lines = QVBoxLayout()
        self._scroll = QScrollArea(widgetResizable=True, focusPolicy=Qt.FocusPolicy.NoFocus)
        self._scroll.setHorizontalScrollBarPolicy(Qt.ScrollBarPolicy.ScrollBarAlwaysOff)
        column_layout(head, self._scroll, margins=(6, 6, 6, 6), parent=self)
        self.hide()
        canvas.resized.connect(self._place)

    def open(self, title: str, rows: Sequence[FindingRow]) -> None:
        """Open the list with the rows, none marked, and focus the first."""
        body = QWidget(objectName="rows")
        self.rows = list(rows)
        self._lines = column_layout(*self.rows, STRETCH, spacing=2, parent=body)
        for k, row in enumerate(self.rows):
            row.chosen.connect(lambda k=k: self.chosen.emit(k))
            row.step_requested.connect(lambda step, k=k: self._step(k + step))
            row.stay_toggled.connect(lambda on, k=k: self.stay_toggled.emit(k, on))
            row.weld_requested.connect(self.weld_requested)
        self._scroll.setWidget(body)
        self._title.setText(title)
        self.setAccessibleName(self._title.text())
        self.show()
        self.raise_()
        self._place()
        self.rows[0].setFocus(Qt.FocusReason.PopupFocusReason)

    def show_marked_finding(self, number: int) -> None:
        """Emphasise the finding marked on the mesh."""
        for k, row in enumerate(self.rows):
            row.show_mark(k == number)

    def show_immobile_components(self, immobile: tuple[int, ...]) -> None:
        """Check the boxes of the rows with ``immobile`` components."""
        for row in self.rows:
            row.show_immobile_components(immobile)

    def set_theme(self, theme: Theme) -> None:
        """Redraw the icon."""
        self.close_button.setIcon(icon("cancel", theme))

    def _step(self, k: int) -> None:
        if 0 <= k < len(self.rows):
            self.rows[k].setFocus()
            self._scroll.ensureWidgetVisible(self.rows[k])
            self.chosen.emit(k)

    def _place(self) -> None:
        if self.isHidden():
            return
        canvas = self._canvas
        width = max(120, min(_WIDEST, canvas.width() - 2 * _MARGIN))
        around = self.contentsMargins()
        inner = width - 12 - around.left() - around.right()
        lines = self._lines.heightForWidth(inner)
        room = max(96, round(_ROOM * canvas.height()) - 52)
        if lines > room:
            lines = self._lines.heightForWidth(inner - self._scroll.verticalScrollBar().sizeHint().width())
        self._scroll.setFixedHeight(min(lines, room))
        self.setFixedWidth(width)
        self.adjustSize()
        self.move(canvas.width() - width - _MARGIN, canvas.height() - self.height() - _MARGIN)

    def keyPressEvent(self, event: QKeyEvent) -> None:
        """Close the list on Esc."""
        if event.key() == Qt.Key.Key_Escape:
            self.dismissed.emit()
        else:
            super().keyPressEvent(event)
