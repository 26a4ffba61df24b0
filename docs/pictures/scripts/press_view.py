"""The sample bottle of clear PET between two plates, with the results of the method Wall in the curves."""

from PySide6.QtGui import QImage
from stage import Stage

from apd_viewer.ui.scene.surface_shading import Finish


def draw(stage: Stage) -> QImage:
    """Press the bottle to 90 percent of its width, and wait for the first answers of the wall."""
    stage.open_sample("bottle")
    window = stage.window
    window.display_options.choose_finish(Finish.PET)
    window.actions_.simulate.press_live.trigger()
    panel, player, run = window.press.panel, window.session.player, window.session.wall_run
    panel.steps.setValue(2 if stage.quick else 3)
    panel.end.setText("90")
    panel.press.click()
    stage.wait(lambda: not player.is_playing)
    if not stage.quick:
        stage.wait(lambda: not run.is_running, patience=600.0)
    stage.settle()
    return stage.picture()
