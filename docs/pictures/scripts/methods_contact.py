"""The bottle twisted by 150 degrees without and with contact."""

from pairs import side_by_side
from PySide6.QtGui import QImage
from stage import Stage

from apd_viewer.session.quantities.units import Unit


def draw(stage: Stage) -> QImage:
    """Twist twice, and read the volume of each."""
    pictures, words = [], []
    for contact in (False, True):
        stage.open_sample("bottle")
        stage.window.choose_unit(Unit.CENTIMETRE)
        stage.window.session.settings.set_contact(contact)
        stage.twist("150deg")
        stage.look(0.42, 0.2, 0.85)
        pictures.append(stage.scene(300, 380))
        words.append(_words(stage, contact))
    return side_by_side(pictures, words)


def _words(stage: Stage, contact: bool) -> str:
    state = stage.state
    change = 100.0 * (state.frame.volume / state.inspection.volume - 1.0)
    check = stage.window.session.shape_checks.shape_check
    count = 0 if check is None or check.crossing is None else len(check.crossing)
    crossing = f"{count:,} triangles cross" if count else "nothing crosses"
    return f"{'With' if contact else 'Without'} contact\nvolume −{-change:.1f} %, {crossing}"
