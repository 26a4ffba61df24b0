"""Legend of an overlay as SVG, for pictures and pages; no Qt."""

from html import escape

import numpy as np

from apd_viewer.language import tr
from apd_viewer.presentation.scales import Scale
from apd_viewer.session.quantities.units import Unit

# SVG user units, equal to pixels of the window.
WIDTH, HEIGHT = 264, 88
_LEFT, _TOP, _BAR = 8, 28, 14
_STOPS = 33
_LETTERS = 'font-family="system-ui, sans-serif" font-size="12"'


def legend_svg(scale: Scale, unit: Unit, span: tuple[float, float] | None, ink: str = "currentColor") -> str:
    """Draw a scale with labels, title and the largest change within ``span`` as SVG.

    The id of its colours is "scale", which must be unique in a page.
    """
    wide, low = WIDTH - 2 * _LEFT, _TOP + _BAR
    offsets = np.linspace(0.0, 1.0, _STOPS)
    stops = "".join(
        f'<stop offset="{offset:.5f}" stop-color="rgb({red}, {green}, {blue})"/>'
        for offset, (red, green, blue) in zip(offsets, scale.colors(offsets), strict=True)
    )
    places = [(scale.position(value), scale.format_value(value, unit)) for value in scale.tick_values]
    figures = "".join(
        f'<text x="{_LEFT + place * wide:g}" y="{low + 16}" {_LETTERS} '
        f'text-anchor="{_anchor(place)}" fill="{ink}">{escape(text)}</text>'
        for place, text in places
    )
    largest = ""
    if span is not None:
        value = scale.format_value(scale.largest_change(span), unit)
        said = escape(tr("largest {value}").format(value=value))
        # A line of its own: title and value need not fit side by side in every language.
        below = f'x="{WIDTH - _LEFT}" y="{low + 34}" {_LETTERS} text-anchor="end"'
        largest = f'<text {below} fill="{ink}">{said}</text>'
    title = escape(scale.measure.traits.title)
    return (
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {WIDTH} {HEIGHT}" role="img">'
        f"<title>{title}</title>"
        f'<defs><linearGradient id="scale">{stops}</linearGradient></defs>'
        f'<text x="{_LEFT}" y="18" {_LETTERS} font-weight="600" fill="{ink}">{title}</text>{largest}'
        f'<rect x="{_LEFT}" y="{_TOP}" width="{wide}" height="{_BAR}" fill="url(#scale)" '
        f'stroke="#808894" stroke-width="0.75"/>{figures}</svg>'
    )


def _anchor(place: float) -> str:
    return "start" if place <= 0.0 else "end" if place >= 1.0 else "middle"
