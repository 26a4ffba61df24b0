"""Self-intersection reading: a quiet line, or a button to the places."""

from __future__ import annotations

from dataclasses import replace

from PySide6.QtCore import QSize, Qt
from PySide6.QtGui import QIcon, QPixmap
from PySide6.QtWidgets import QToolButton

from apd_viewer.language import tr
from apd_viewer.ui.widgets.icons import icon
from apd_viewer.ui.widgets.theme import LIGHT, Theme

_KEPT_APART = tr("Contact keeps walls apart: no triangles intersect, and the volume counts nothing twice")


class CrossingsButton(QToolButton):
    """Line under the volume about self-intersections; empty if there are none."""

    def __init__(self) -> None:
        super().__init__(
            objectName="crossings", iconSize=QSize(16, 16), focusPolicy=Qt.FocusPolicy.StrongFocus
        )
        self.setToolButtonStyle(Qt.ToolButtonStyle.ToolButtonTextBesideIcon)
        self._theme, self._symbol = LIGHT, ""
        self.show_moving()

    def show_moving(self, cannot_cross: bool = False) -> None:
        """The shape is on its way to somewhere else, kept from crossing itself or not."""
        if cannot_cross:
            self._say(tr("no self-intersections"), _KEPT_APART, "sound")
            return
        tip = tr("Self-intersections are checked when the shape stops moving")
        self._say(tr("self-intersections: checked when it stops"), tip)

    def show_checking(self) -> None:
        """It is being found out."""
        self._say(tr("checking for self-intersections…"), tr("Checking whether triangles intersect"))

    def show_count(self, triangles: int | None, kept_apart: bool = False) -> None:
        """Show the number of intersecting triangles; None if unknown.

        With ``kept_apart`` contact is on.
        """
        if triangles is None:
            tip = tr("The library ipctk, which checks this, is missing or does not respond")
            self._say(tr("self-intersections: not checked"), tip)
        elif triangles == 0:
            self._say(
                tr("no self-intersections"),
                _KEPT_APART if kept_apart else tr("No triangles intersect"),
                "sound",
            )
        else:
            said = tr("{n:,} intersecting triangles")
            tip = tr("The volume counts overlaps twice. Show where this is")
            if kept_apart:
                tip = tr(
                    "Contact leaves what crosses at rest as it is, and keeps no loose part apart from what "
                    "carries it; the volume counts such overlaps twice. Show where this is"
                )
            self._say(said.format(n=triangles), tip, "warning")

    def set_theme(self, theme: Theme) -> None:
        """Redraw the icon."""
        self._theme = theme
        self._draw()

    def _say(self, text: str, tip: str, symbol: str = "") -> None:
        self.setText(text)
        self.setToolTip(tip)
        self.setAccessibleName(text)
        self.setEnabled(symbol == "warning")
        self._symbol = symbol
        self._draw()

    def _draw(self) -> None:
        theme = self._theme
        if self._symbol == "warning":
            self.setIcon(icon("warning", replace(theme, ink=theme.warm, on_accent=theme.warm)))
        elif self._symbol:
            self.setIcon(icon(self._symbol, replace(theme, faint=theme.quiet)))
        else:  # an unknown state has no icon, but its text is aligned as if it had one
            nothing = QPixmap(self.iconSize())
            nothing.fill(Qt.GlobalColor.transparent)
            self.setIcon(QIcon(nothing))
