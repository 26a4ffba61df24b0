"""Panel of the timeline: controls of a press, steps, readings and curves."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import zip_longest

from PySide6.QtCore import QSize, Qt, Signal
from PySide6.QtGui import QResizeEvent
from PySide6.QtWidgets import QBoxLayout, QGridLayout, QHBoxLayout, QLabel, QPushButton, QSizePolicy, QWidget

from apd_viewer.language import tr, trc
from apd_viewer.presentation.plate_readings import ReadingText
from apd_viewer.ui.plots.chart_drawing import Chart
from apd_viewer.ui.plots.plots import ChartTexts, ChartView
from apd_viewer.ui.widgets.box_layouts import STRETCH, column_layout, row_layout
from apd_viewer.ui.widgets.fields import ComboBox, ErrorBubble, NumberField, TextField, small_button
from apd_viewer.ui.widgets.folding_section import quiet_label
from apd_viewer.ui.widgets.slider_field import Slider, SliderScale
from apd_viewer.ui.widgets.theme import Theme, icon
from apd_viewer.ui.widgets.thin_bar import ElidedLabel

_AT_FIRST, _STEPS, _MOST_STEPS = "40 %", 16, 1000
_SIZE, _SMALLEST = QSize(760, 216), QSize(420, 190)
_LEFT = 286  # px: smallest width of the readings
_WIDE = 860  # px: width with room for both charts
_ONE_STEP = SliderScale(1, float, float, 0)
_LOAD = ChartTexts(tr("Load"), tr("Load over the way of the plates; not at rest is a cross"))
_VOLUME = ChartTexts(tr("Volume"), tr("Volume over the way of the plates, percent of that at rest"))
_SIZE_CHANGE = ChartTexts(tr("Area and volume"), tr("In percent of rest, step by step"))
_EFFORT = ChartTexts(
    tr("Energy or strain"), tr("Energy of each step, or the mean edge strain; not at rest is a cross")
)


class TimelinePanel(QWidget):
    """Controls of a press, and the timeline of its steps with readings and curves.

    Attributes
    ----------
    direction_chosen : Signal(int)
        Axis 0, 1 or 2 along which the plates shall close.
    press_requested, stop_requested, open_requested : Signal()
        Close the plates or pause, stop, and open the plates again.
    step_shown : Signal(int)
        Number of a step to display; ``show_ended`` follows once it is chosen.
    play_requested : Signal()
        Replay all steps, or stop the replay.
    wall_requested : Signal()
        Solve the steps by the Wall method as well, or stop that run.
    wall_chosen : Signal(bool)
        True to display the states solved by the Wall method.
    reading_rows : list of tuple of QLabel
        Title, value and note of each reading; then value and note of the other solution of the step.
    solution_names : (QLabel, QLabel)
        Names of the displayed solution and of the other one.
    """

    direction_chosen = Signal(int)
    press_requested = Signal()
    stop_requested = Signal()
    open_requested = Signal()
    step_shown = Signal(int)
    show_ended = Signal()
    show_cancelled = Signal()
    play_requested = Signal()
    wall_requested = Signal()
    wall_chosen = Signal(bool)
    export_requested = Signal()
    clear_requested = Signal()

    def __init__(self) -> None:
        super().__init__(objectName="timeline")
        self.setAttribute(Qt.WidgetAttribute.WA_StyledBackground)
        self._theme: Theme | None = None
        self.load_view = ChartView(_LOAD, lambda: Chart(""))
        self.volume_view = ChartView(_VOLUME, lambda: Chart(""))
        self.size_view = ChartView(_SIZE_CHANGE, lambda: Chart(""))
        self.effort_view = ChartView(_EFFORT, lambda: Chart(""))
        self._charts_of_press, self._charts_of_steps = (
            (self.load_view, self.volume_view),
            (self.size_view, self.effort_view),
        )
        self._is_press = True
        self.controls, self.fields = QWidget(), QWidget()
        self._make_controls()
        transport = self._make_transport()
        name = tr("Whether the shape is at rest")
        self.calm, self.warning = quiet_label(name), quiet_label(name, style="unreached")
        self._grid = QGridLayout(horizontalSpacing=12, verticalSpacing=2)
        self.reading_rows: list[tuple[QLabel, ...]] = []
        self.solution_names = QLabel(objectName="value"), QLabel(objectName="value")
        for k, label in enumerate(self.solution_names):
            self._grid.addWidget(label, 0, 2 * k + 1, 1, 2, Qt.AlignmentFlag.AlignRight)
        self.solution_names[0].setToolTip(tr("Of the shape on screen"))
        self.solution_names[1].setToolTip(tr("Of the same step by the other method"))
        self._left = QWidget()
        self._left.setMinimumWidth(_LEFT)
        self._left.setSizePolicy(QSizePolicy.Policy.Fixed, QSizePolicy.Policy.Preferred)
        column_layout(self.calm, self.warning, 4, self._grid, STRETCH, parent=self._left)
        views = [(view, 1) for view in self._chart_views]
        lower = row_layout(self._left, *views, spacing=12)
        column = column_layout(
            self.controls, transport, (lower, 1), spacing=6, margins=(12, 6, 12, 8), parent=self
        )
        column.setSizeConstraint(QBoxLayout.SizeConstraint.SetNoConstraint)

    # Construction

    def _make_controls(self) -> None:
        tip = tr("Axis along which the plates close; they are put anew")
        self.direction = ComboBox(accessibleName=tr("Direction to press in"), toolTip=tip)
        self.direction.activated.connect(self.direction_chosen)
        tip = tr("Where the plates end: a share of the extent such as 40 %, or a length such as 3cm")
        self.end = TextField(accessibleName=tr("Distance of the plates in the end"), toolTip=tip)
        self.end.setText(_AT_FIRST)
        self.end.show_unit("%")
        self.end.setFixedWidth(72)
        self.end.returnPressed.connect(self.press_requested)
        self.problem = ErrorBubble(self.end)
        self.end.textChanged.connect(self.problem.hide)
        self.end.focus_lost.connect(self.problem.hide_later)
        self.steps = NumberField(
            accessibleName=tr("Number of steps"),
            toolTip=tr("In so many steps; the shape comes to rest after each"),
            minimum=1,
            maximum=_MOST_STEPS,
            value=_STEPS,
            decimals=0,
        )
        self.steps.setFixedWidth(52)
        self.steps.lineEdit().returnPressed.connect(self.press_requested)
        tip = tr("Close the plates in steps")
        self.press = QPushButton(tr("Press"), objectName="primary", toolTip=tip)
        self.press.clicked.connect(self.press_requested)
        self.stop = QPushButton(tr("Stop"), toolTip=tr("End with the present step, once it is at rest"))
        self.stop.clicked.connect(self.stop_requested)
        self.open = QPushButton(tr("Open again"), toolTip=tr("Open the plates again, to see what remains"))
        self.open.clicked.connect(self.open_requested)
        self.progress = ElidedLabel(objectName="quiet", accessibleName=tr("Progress"))
        self.wall = QPushButton()
        self.wall.clicked.connect(self.wall_requested)
        words = [
            QLabel(text)
            for text in (
                trc("press", "Along"),
                trc("press", "to"),
                trc("press", "in"),
                trc("press", "steps"),
            )
        ]
        row_layout(
            *(words[0], self.direction, words[1], self.end, words[2], self.steps, words[3], 4),
            spacing=6,
            parent=self.fields,
        )
        buttons = self.press, self.stop, self.open, (self.progress, 1), self.wall
        row_layout(self.fields, *buttons, spacing=6, parent=self.controls)

    def _make_transport(self) -> QHBoxLayout:
        self.back = small_button(tr("Previous step"), tr("Show the step before"))
        self.replay = small_button(tr("Play the timeline"), tr("Go along all steps that were solved"))
        self.forward = small_button(tr("Next step"), tr("Show the next step"))
        self.loop = small_button(tr("Repeat"), tr("Begin again at the end"))
        self.loop.setCheckable(True)
        self.replay.clicked.connect(self.play_requested)
        tip = tr("Shapes that were solved: drag to go back to any of them")
        self.slider = Slider(_ONE_STEP, accessibleName=tr("Timeline"), toolTip=tip)
        self.slider.setPageStep(5)
        self.back.clicked.connect(lambda: self.slider.setValue(self.slider.value() - 1))
        self.forward.clicked.connect(lambda: self.slider.setValue(self.slider.value() + 1))
        self.slider.valueChanged.connect(self._choose_step)
        self.slider.sliderReleased.connect(self.show_ended)
        self.slider.drag_cancelled.connect(self.show_cancelled)
        self.position = QLabel(accessibleName=tr("Step of the timeline"))
        self.position.setMinimumWidth(self.fontMetrics().horizontalAdvance("000 / 000"))
        tip = tr("Shapes to look at: of the method that pressed, or of the wall itself")
        self.shape_choice = ComboBox(accessibleName=tr("Shapes to look at"), toolTip=tip)
        self.shape_choice.activated.connect(lambda k: self.wall_chosen.emit(k == 1))
        tip = tr("Export the readings of all steps as a table, or their shapes as an animation")
        self.export = QPushButton(tr("Export…"), toolTip=tip)
        self.export.clicked.connect(self.export_requested)
        self.clear = QPushButton(tr("Clear"), toolTip=tr("Forget the steps; the shape on screen stays"))
        self.clear.clicked.connect(self.clear_requested)
        return row_layout(
            *(self.back, self.replay, self.forward, self.loop, (self.slider, 1), self.position),
            *(self.shape_choice, self.export, self.clear),
            spacing=4,
        )

    def sizeHint(self) -> QSize:
        """Height for readable charts below the view."""
        return _SIZE

    def minimumSizeHint(self) -> QSize:
        """Height of the controls with small charts."""
        return _SMALLEST

    def resizeEvent(self, event: QResizeEvent) -> None:
        """Show the second chart if there is room for it."""
        super().resizeEvent(event)
        self._show_charts()

    @property
    def _chart_views(self) -> tuple[ChartView, ...]:
        return *self._charts_of_press, *self._charts_of_steps

    def _show_charts(self) -> None:
        shown = self._charts_of_press if self._is_press else self._charts_of_steps
        for view in self._chart_views:
            view.setVisible(view in shown and (view is shown[0] or self.width() >= _WIDE))

    # Display

    def show_kind(self, is_press: bool, is_playing: bool, is_solving_wall: bool) -> None:
        """Show controls and charts of a press, or those of any other motion.

        The progress of the Wall method stays, and its button, also if the plates are gone.
        """
        self.controls.setVisible(is_press or is_playing or is_solving_wall)
        self.press.setVisible(is_press or is_playing)
        self.fields.setVisible(is_press)
        if not is_press:
            self.open.hide()
        if is_press is not self._is_press:
            self._is_press = is_press
            self._show_charts()

    def show_directions(self, titles: Sequence[str], axis: int) -> None:
        """Show the axes with their extents, and the current one."""
        if [self.direction.itemText(k) for k in range(self.direction.count())] != list(titles):
            self.direction.clear()
            self.direction.addItems(list(titles))
        self.direction.setCurrentIndex(axis)

    def show_run(self, is_playing: bool, is_paused: bool, may_open: bool) -> None:
        """Show whether a press is running."""
        go_on = tr("Continue") if is_paused else tr("Pause")
        self.press.setText(go_on if is_playing else tr("Press"))
        self.press.setToolTip(
            tr("Let the motion stand still, or go on") if is_playing else tr("Close the plates in steps")
        )
        self.stop.setVisible(is_playing)
        self.open.setVisible(not is_playing)
        self.open.setEnabled(may_open)
        for field in (self.direction, self.end, self.steps):
            field.setEnabled(not is_playing)

    def show_steps(self, count: int, shown: int | None, is_replaying: bool) -> None:
        """Show the number of steps, and the position of the displayed one."""
        self.slider.blockSignals(True)
        self.slider.setRange(0, max(1, count - 1))
        if shown is not None and not self.slider.isSliderDown():
            self.slider.setValue(shown)
        self.slider.blockSignals(False)
        self.slider.update()
        some = count > 1
        for part in (self.slider, self.replay, self.loop, self.export):
            part.setEnabled(some)
        self.back.setEnabled(some and self.slider.value() > 0)
        self.forward.setEnabled(some and self.slider.value() < count - 1)
        self.clear.setEnabled(count > 0)
        said = tr("{k} of {count}").format(k=0 if shown is None else shown + 1, count=count)
        self.position.setText(said if shown is not None else "")
        if self._theme is not None:
            self.replay.setIcon(icon("pause" if is_replaying else "play", self._theme))

    def show_wall(self, is_running: bool, may_begin: bool, names: Sequence[str], shows_wall: bool) -> None:
        """Show whether the Wall method is running or can run, and the choice of shapes."""
        self.wall.setVisible(is_running or may_begin)
        self.wall.setText(tr("Stop") if is_running else tr("Solve as wall"))
        self.wall.setToolTip(
            tr("Solve the wall no further; what has come stays")
            if is_running
            else tr("Solve these steps by the method Wall, too, in the background: it has true newtons")
        )
        if [self.shape_choice.itemText(k) for k in range(self.shape_choice.count())] != list(names):
            self.shape_choice.clear()
            self.shape_choice.addItems(list(names))
            if not names:  # the second column is gone
                self._left.setMinimumWidth(_LEFT)
        self.shape_choice.setVisible(bool(names))
        self.shape_choice.setCurrentIndex(int(shows_wall))

    def show_readings(
        self, texts: Sequence[ReadingText], verdict: str, is_calm: bool, names: Sequence[str] = ()
    ) -> None:
        """Show the readings of the displayed shape; a warning comes first.

        ``names`` are those of the displayed solution and of another one with readings of its own, if any.
        """
        headings = (tr("{name}, on screen").format(name=names[0]), names[1]) if names else ("", "")
        for label, words in zip(self.solution_names, headings, strict=True):
            label.setText(words)
            label.setVisible(bool(names))
        while len(self.reading_rows) < len(texts):
            styles = "quiet", "value", "quiet", "value", "quiet"
            labels = tuple(QLabel(objectName=style) for style in styles)
            for column, label in enumerate(labels):
                aside = Qt.AlignmentFlag.AlignRight if column else Qt.AlignmentFlag.AlignLeft
                self._grid.addWidget(label, len(self.reading_rows) + 1, column, aside)
            self._grid.setColumnStretch(1, 1)
            self._grid.setColumnMinimumWidth(2, self.fontMetrics().horizontalAdvance("excess 100 %"))
            self.reading_rows.append(labels)
        for labels, text in zip_longest(self.reading_rows, texts):
            for column, label in enumerate(labels):
                label.setVisible(text is not None and (column < 3 or bool(names)))
            if text is None:
                continue
            shown = text.title, text.value, text.note, text.other, text.other_note
            for label, words in zip(labels, shown, strict=True):
                label.setText(words)
                label.setToolTip(text.tip)
            titles = text.title, f"{text.title}, {names[1]}" if names else ""
            for title, value, note in zip(titles, labels[1::2], labels[2::2], strict=True):
                value.setAccessibleName(title)
                note.setAccessibleName(tr("{title}, note").format(title=title))
        # It only grows, so that the charts do not move with every number.
        self._left.setMinimumWidth(max(self._left.minimumWidth(), self._left.sizeHint().width()))
        for label in (self.calm, self.warning):
            label.setText(verdict)
            label.setVisible(is_calm is (label is self.calm))

    def show_problem(self, sentence: str) -> None:
        """Show why the entered final distance of the plates is impossible."""
        self.problem.show_message(sentence)
        self.end.setFocus()
        self.end.selectAll()

    def set_theme(self, theme: Theme) -> None:
        """Redraw icons and charts."""
        self._theme = theme
        for button, image in (
            (self.back, "step-back"),
            (self.replay, "play"),
            (self.forward, "step-forward"),
            (self.loop, "loop"),
        ):
            button.setIcon(icon(image, theme))
        for view in self._chart_views:
            view.theme = theme
        self.update_charts()

    def update_charts(self) -> None:
        """Draw the charts again."""
        for view in self._chart_views:
            view.update()

    def _choose_step(self, k: int) -> None:
        self.step_shown.emit(k)
        if not self.slider.isSliderDown():
            self.show_ended.emit()
