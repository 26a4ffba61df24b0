"""The line icons in the colours of theme and parts."""

import pytest
from PySide6.QtCore import QSize
from PySide6.QtGui import QColor, QIcon

from apd_viewer.presentation.palette import BASE_COLOR, HANDLE_COLORS, REGION_COLORS
from apd_viewer.ui.widgets.theme import DARK, LIGHT, icon

PARTS = {"base": BASE_COLOR, "handle": HANDLE_COLORS[0], "region": REGION_COLORS[0]}


def colors(image):
    pixels = [image.pixelColor(x, y) for x in range(image.width()) for y in range(image.height())]
    return {color.name() for color in pixels if color.alpha() == 255}


@pytest.mark.parametrize("theme", [LIGHT, DARK])
@pytest.mark.parametrize("part", PARTS)
def test_icon_of_a_part_is_in_its_color(qapp, theme, part):
    drawn, own = icon(f"paint-{part}", theme), QColor(*PARTS[part]).name()
    size = QSize(80, 80)
    assert {own, theme.ink} <= colors(drawn.pixmap(size).toImage())
    chosen = colors(drawn.pixmap(size, QIcon.Mode.Normal, QIcon.State.On).toImage())
    assert own not in chosen
    assert theme.on_accent in chosen
