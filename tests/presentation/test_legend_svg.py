"""The legend of an overlay as SVG: its words stay apart in every language."""

import gettext
import re
from html import unescape

import pytest
from PySide6.QtGui import QFont, QFontMetricsF

from apd_viewer import language
from apd_viewer.presentation import legend_svg
from apd_viewer.presentation.scales import Measure, default_scale
from apd_viewer.session.quantities.units import Unit


def extents(svg):
    """The ends of each text, measured, by its baseline."""
    rows = {}
    for marks, words in re.findall(r"<text ([^>]*)>([^<]*)</text>", svg):
        held = dict(re.findall(r'([\w-]+)="([^"]*)"', marks))
        font = QFont("sans-serif")
        font.setPixelSize(int(held["font-size"]))
        font.setBold(held.get("font-weight") == "600")
        width = QFontMetricsF(font).horizontalAdvance(unescape(words))
        share = {"middle": 0.5, "end": 1.0}.get(held.get("text-anchor"), 0.0)
        left = float(held["x"]) - share * width
        rows.setdefault(float(held["y"]), []).append((left, left + width))
    return rows


@pytest.mark.parametrize("name", ["de", "zh_CN"])
@pytest.mark.parametrize("measure", Measure)
def test_legend_svg_keeps_its_words_apart_in_other_languages(qapp, monkeypatch, measure, name):
    folder = language.__file__.replace("language.py", "languages")
    say = gettext.translation("apd_viewer", folder, [name]).gettext
    said = measure.traits._replace(title=say(measure.traits.title))
    monkeypatch.setattr(Measure, "traits", property(lambda _: said))
    monkeypatch.setattr(legend_svg, "tr", say)
    rows = extents(legend_svg.legend_svg(default_scale(measure, 10.0), Unit.MILLIMETRE, (-0.3, 0.546)))
    assert sum(map(len, rows.values())) == len(default_scale(measure, 10.0).tick_values) + 2
    for baseline, row in rows.items():
        assert baseline < legend_svg.HEIGHT - 4
        ends = [end for pair in sorted(row) for end in pair]
        assert ends == sorted(ends)
        assert ends[0] >= 0.0
        assert ends[-1] <= legend_svg.WIDTH
