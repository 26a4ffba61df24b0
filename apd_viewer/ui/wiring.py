"""What is set in the panel, brought to the session."""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from apd_viewer.session.session import Session
    from apd_viewer.ui.panel import Panel


def connect_settings(panel: Panel, session: Session) -> None:
    """Have the session do what is set in the panel; the sweep of a slider is one gesture."""
    panel.area.target.chosen.connect(session.set_area)
    panel.area.held.connect(session.hold_area)
    panel.volume.kept.connect(session.set_volume)
    panel.volume.target.chosen.connect(session.set_volume)
    panel.method.method_chosen.connect(session.set_method)
    panel.method.tolerance_chosen.connect(session.set_tolerance)
    panel.method.stiffness.chosen.connect(session.set_stiffness)
    panel.method.area_stiffness_chosen.connect(lambda x: session.set_material(area_stiffness=x))
    panel.method.shear_stiffness_chosen.connect(lambda x: session.set_material(shear_stiffness=x))
    gestures = "Change area", "Change volume", "Change stiffness"
    for dial, gesture in zip(panel.dials, gestures, strict=True):
        dial.sweep_began.connect(session.begin_gesture)
        dial.sweep_ended.connect(partial(session.end_gesture, gesture))
        dial.sweep_given_up.connect(session.cancel_gesture)
