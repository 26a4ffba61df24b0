"""Motion of the active handle: a typed amount, and symmetric posing."""

from PySide6.QtCore import QEvent, QObject, Qt, QTimer, Signal
from PySide6.QtGui import QFocusEvent
from PySide6.QtWidgets import QLabel, QPushButton, QWidget

from apd_viewer.language import tr, trc, trn
from apd_viewer.notation import editable_number
from apd_viewer.session.posing.motion import LINE, MOTIONS, AmountKind, Motion
from apd_viewer.session.quantities.units import Unit
from apd_viewer.ui.widgets.box_layouts import column_layout, row_layout
from apd_viewer.ui.widgets.fields import CheckBox, ComboBox, NumberField, TextField, return_focus
from apd_viewer.ui.widgets.folding_section import name_label, quiet_label

_LINE_TIP = tr("Click two points of the mesh: the bend is about the line through them")
_MOST_STEPS = 1000
_PAUSE = 600  # ms without typing before an error is shown
_RELATION = tr("“by” adds to the current pose, “to” sets the total from rest")


class MotionField(QWidget):
    """Fields to move the handle by a typed amount, as one undo step.

    Attributes
    ----------
    motion_entered : Signal(Motion, str, bool)
        The motion, what was typed, and whether it is the total to go to.
    edited : Signal(Motion, str, bool)
        The same while it is chosen and typed, to be previewed.
    editing_ended : Signal()
        Emitted when typing has ended.
    line_requested : Signal()
        The line to bend about is to be picked on the mesh.
    steps : NumberField
        Number of steps of the motion, each solved and put on the timeline; 1 moves the handle at once.
    problem : QLabel
        Error in the amount.
    """

    motion_entered = Signal(Motion, str, bool)
    edited = Signal(Motion, str, bool)
    editing_ended = Signal()
    line_requested = Signal()

    def __init__(self) -> None:
        super().__init__()
        self.choice = ComboBox(accessibleName=tr("Handle motion"))
        for name, motion in MOTIONS.items():
            self.choice.addItem(motion.title, name)
        self.relation = ComboBox(accessibleName=tr("By an amount or to a total"), toolTip=_RELATION)
        self.relation.addItem(trc("amount", "by"), False)
        self.relation.addItem(trc("amount", "to"), True)
        self.pick = QPushButton(tr("Pick line"), toolTip=_LINE_TIP)
        self.pick.clicked.connect(self.line_requested)
        self.amount = TextField(accessibleName=tr("Amount"))
        self.steps = NumberField(
            accessibleName=tr("Number of steps"),
            toolTip=tr("In so many steps, each at rest and kept on the timeline; 1 moves it at once"),
            minimum=1,
            maximum=_MOST_STEPS,
            value=1,
            decimals=0,
        )
        self.steps.setFixedWidth(44)
        self.amount.returnPressed.connect(self._type)
        self.amount.textEdited.connect(self.request_preview)
        self.amount.focus_gained.connect(self.request_preview)
        self.amount.focus_lost.connect(self._leave)
        self.choice.currentIndexChanged.connect(self._choose)
        self.choice.activated.connect(self.request_preview)
        self.choice.installEventFilter(self)
        self.problem = quiet_label(tr("Error in the amount"), style="unreached")
        self.problem.hide()
        self._later = QTimer(self, singleShot=True, interval=_PAUSE, timeout=self._show_problem)
        self._kind, self._unit = self.motion.kind.amount, Unit.NONE
        word = QLabel(trn("step", "steps", 1))
        word.setMinimumWidth(word.fontMetrics().horizontalAdvance(trn("step", "steps", 2)))
        self.steps.valueChanged.connect(lambda count: word.setText(trn("step", "steps", round(count))))
        inside = QLabel(trc("motion", "in"))
        line = row_layout(self.relation, (self.amount, 1), inside, self.steps, word, spacing=6)
        column_layout(self.choice, line, self.pick, self.problem, margins=(0, 4, 0, 4), parent=self)
        self._choose()

    @property
    def motion(self) -> Motion:
        """Motion currently selected."""
        return MOTIONS[self.choice.currentData()]

    @property
    def is_about_line(self) -> bool:
        """True for a motion about a line picked on the mesh."""
        return self.motion.axis == LINE

    def clear(self) -> None:
        """Reset the fields for another mesh."""
        self.choice.setCurrentIndex(0)
        self.relation.setCurrentIndex(0)
        self.amount.clear()
        self.steps.setValue(1)
        self.problem.hide()

    def eventFilter(self, watched: QObject, event: QEvent) -> bool:
        """End the preview once the choice of the motion is left, but not for its list."""
        if watched is self.choice and isinstance(event, QFocusEvent):
            kept = event.gotFocus() or event.reason() is Qt.FocusReason.PopupFocusReason
            if not kept:
                self._leave()
        return super().eventFilter(watched, event)

    def show_error_later(self, sentence: str) -> None:
        """Show an input error once typing pauses; an empty text clears it."""
        self.problem.setText(sentence)
        if sentence:
            self._later.start()
        else:
            self._later.stop()
            self.problem.hide()

    def finish_entry(self) -> None:
        """Hide the error and return the focus after a motion, so that Ctrl+Z undoes it."""
        self.problem.hide()
        return_focus(self.amount)

    def show_error(self, sentence: str) -> None:
        """Show an input error and keep the text for correction."""
        self.problem.setText(sentence)
        self.problem.show()
        self.amount.selectAll()

    def _type(self) -> None:
        self.motion_entered.emit(self.motion, self.amount.text(), self.relation.currentData())

    def request_preview(self) -> None:
        """Request a preview of the typed motion."""
        self.edited.emit(self.motion, self.amount.text(), self.relation.currentData())

    def _leave(self) -> None:
        self._later.stop()
        self.editing_ended.emit()

    def _show_problem(self) -> None:
        self.problem.show()

    def _choose(self) -> None:
        tip = _LINE_TIP if self.is_about_line else self.motion.kind.tip
        self.pick.setVisible(self.is_about_line)
        self.amount.setToolTip(tip)
        self.choice.setToolTip(tip)
        self.amount.setPlaceholderText(editable_number(self.motion.kind.example))
        if self.motion.kind.amount is not self._kind:
            self._kind = self.motion.kind.amount
            self.amount.clear()
        self._show_symbol()
        self.problem.hide()

    def show_unit(self, unit: Unit) -> None:
        """Show the unit of the mesh after lengths."""
        self._unit = unit
        self._show_symbol()

    def _show_symbol(self) -> None:
        length, kind = self._unit.format_length("").strip(), self.motion.kind.amount
        symbols = {AmountKind.ANGLE: "°", AmountKind.LENGTH: length, AmountKind.LENGTH_OR_PERCENT: length}
        self.amount.show_unit(symbols.get(kind, ""))


_TIP = tr("Move each handle together with its mirror image on the other side of the mesh")
_AXIS = tr("Axis to mirror along, through the middle of the mesh at rest")


class SymmetryRow(QWidget):
    """Check box for symmetric posing, its axis, and a label naming the mirror partner.

    Attributes
    ----------
    axis_chosen : Signal(object)
        The axis to mirror along, 0, 1 or 2, or None.
    paint_requested : Signal()
        The mirror image of the active handle is to be painted.
    """

    axis_chosen = Signal(object)
    paint_requested = Signal()

    def __init__(self) -> None:
        super().__init__()
        self.box = CheckBox(tr("Symmetric"), toolTip=_TIP)
        self.axis = ComboBox(accessibleName=tr("Axis of symmetry"), toolTip=_AXIS)
        for number, letter in enumerate("xyz"):
            self.axis.addItem(tr("along {axis}").format(axis=letter), number)
        self.partner = name_label(tr("Mirror partner of the handle"))
        self.partner.hide()
        self.paint = QPushButton(
            tr("Paint mirror handle"),
            toolTip=tr("Add a handle on the free vertices at the mirror image of the active one"),
        )
        self.paint.hide()
        line = row_layout((self.box, 1), self.axis)
        column_layout(line, self.partner, self.paint, margins=(0, 0, 0, 4), parent=self)
        self.box.toggled.connect(self._choose)
        self.axis.currentIndexChanged.connect(self._choose)
        self.paint.clicked.connect(self.paint_requested)

    def show_settings(self, axis: int | None, sentence: str, may_paint: bool) -> None:
        """Show the axis, the text on the mirror partner, and the button to paint one."""
        for control in (self.box, self.axis):
            control.blockSignals(True)
        self.box.setChecked(axis is not None)
        if axis is not None:
            self.axis.setCurrentIndex(axis)
        for control in (self.box, self.axis):
            control.blockSignals(False)
        self.partner.setText(sentence)
        self.partner.setVisible(bool(sentence))
        self.paint.setVisible(may_paint)

    def _choose(self) -> None:
        self.axis_chosen.emit(self.axis.currentData() if self.box.isChecked() else None)
