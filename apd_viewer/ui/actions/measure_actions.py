"""Actions of the tool Measure."""

from __future__ import annotations

from functools import partial

from PySide6.QtWidgets import QMenu

from apd_viewer.language import tr
from apd_viewer.ui.actions.action_maker import ActionMaker
from apd_viewer.ui.measuring.kind_words import KIND_WORDS
from apd_viewer.ui.measuring.measure_controller import MeasureController


class MeasureActions:
    """Actions of the kinds of measurements, and of all of them together.

    Parameters
    ----------
    maker : ActionMaker
    measurements : MeasureController

    Attributes
    ----------
    kinds : dict of MeasurementKind to QAction
    copy, clear : QAction
    """

    def __init__(self, maker: ActionMaker, measurements: MeasureController) -> None:
        self.kinds = {
            kind: maker.make(
                f"measure_kind:{kind.name}",
                words.title,
                words.icon,
                words.tip,
                None,
                partial(measurements.choose_kind, kind),
            )
            for kind, words in KIND_WORDS.items()
        }
        maker.make_exclusive(self.kinds.values())
        self.kinds[measurements.tool.kind].setChecked(True)
        measurements.kind_chosen.connect(lambda kind: self.kinds[kind].setChecked(True))
        tip = tr("Copy the values of all measurements as text, for a spreadsheet")
        self.copy = maker.make(
            "copy_measurements", tr("&Copy measurements"), "copy", tip, None, measurements.copy
        )
        tip = tr("Remove all measurements")
        title = tr("&Remove all measurements")
        self.clear = maker.make("clear_measurements", title, "remove", tip, None, measurements.clear)

    def fill(self, menu: QMenu) -> None:
        """Put all of them into the menu of the tools."""
        menu.addSeparator()
        own = menu.addMenu(tr("Me&asurements"))
        own.addActions(list(self.kinds.values()))
        own.addSeparator()
        own.addActions([self.copy, self.clear])
