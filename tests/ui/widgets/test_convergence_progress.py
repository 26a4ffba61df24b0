"""Progress and the time left in the status bar, with a clock of the test."""

from dataclasses import replace

import pytest
from driving import idle
from meshes import box
from PySide6.QtWidgets import QMainWindow

from apd_viewer.geometry.mesh.mesh import Mesh
from apd_viewer.presentation.time_left import duration_text
from apd_viewer.session.model.state import initial_state
from apd_viewer.session.posing.motion import MOTIONS
from apd_viewer.ui.widgets.convergence_progress import ConvergenceProgress


class Solving:
    """Frames whose gap falls by a tenth every 0.2 s, and the progress that follows them."""

    def __init__(self):
        self.now, self.rest = 100.0, initial_state(Mesh(*box(2, 2, 6))).frame
        self.compiles = False
        self.progress = ConvergenceProgress(lambda: self.now, lambda: self.compiles)
        self.frame = replace(self.rest, iteration=900)
        self.progress.set_frame(self.frame, solving=True)

    def go_on(self, frames, first=1, gap=1e6):
        for k in range(first, first + frames):
            self.now += 0.2
            self.frame = replace(self.rest, iteration=k, gap=gap * 0.9**k)
            self.progress.set_frame(self.frame, solving=True)


@pytest.fixture
def solving(qtbot):
    solving, window = Solving(), QMainWindow()
    window.setCentralWidget(solving.progress)
    window.show()
    yield solving
    window.close()
    window.deleteLater()


def test_convergence_progress_comes_after_a_while_and_goes_at_the_end(solving):
    progress = solving.progress
    solving.go_on(8)
    assert not progress.isVisible()
    solving.go_on(30, first=9)
    assert progress.isVisible()
    assert "about" in progress.time_left.text()
    done = progress.bar.value()
    solving.go_on(30, first=39)
    assert progress.bar.value() > done > 0
    solving.now += 30.0
    progress.set_frame(replace(solving.frame, iteration=100, gap=0.0), solving=True)
    assert progress.time_left.text() == "looking for a lower energy…"
    progress.set_frame(solving.frame, solving=False)
    assert not progress.isVisible()


def test_convergence_progress_tells_no_time_while_kernels_compile(solving):
    solving.go_on(38)
    assert solving.progress.isVisible()
    solving.compiles = True
    solving.go_on(1, first=39)
    assert not solving.progress.isVisible()
    solving.compiles = False
    solving.go_on(1, first=40)
    assert solving.progress.isVisible()


def test_convergence_progress_begins_anew_for_another_motion(solving):
    solving.go_on(60)
    assert solving.progress.isVisible()
    solving.go_on(5)
    assert not solving.progress.isVisible()
    assert solving.progress.bar.value() == 0


def test_convergence_progress_has_no_number_while_it_is_not_known(solving):
    solving.go_on(20, gap=1e6)
    solving.now += 50.0
    solving.progress.set_frame(replace(solving.frame, iteration=21, gap=None), solving=True)
    assert solving.progress.time_left.text() == "iteration 21, 54 s so far"


def test_convergence_progress_tells_soon_what_is_prepared_before_anything_moves(solving):
    progress = solving.progress
    for later in (0.4, 0.2, 4.0):
        solving.now += later
        progress.set_frame(solving.frame, solving=True, prepared="Wall")
        assert progress.isVisible() is (solving.now >= 100.5)
    assert progress.time_left.text() == "preparing the method Wall, 5 s so far"
    solving.go_on(1)
    assert progress.time_left.text() == "estimating the time left…"


def test_convergence_progress_counts_iterations_where_no_time_is_known_for_long(solving):
    """As by the method Wall on a large mesh, whose measure does not fall for minutes."""
    progress, began = solving.progress, solving.now
    solving.now += 7.0
    progress.set_frame(solving.frame, solving=True)
    assert progress.time_left.text() == "estimating the time left…"
    solving.now += 2.0
    progress.set_frame(solving.frame, solving=True)
    assert progress.time_left.text() == "first iteration, 9 s so far", "900 are of the motion before"
    for k in range(1, 31):
        solving.now += 3.0
        progress.set_frame(replace(solving.rest, iteration=k, gap=1e6), solving=True)
        assert progress.time_left.text() == f"iteration {k}, {duration_text(solving.now - began)} so far"
    solving.go_on(60, first=31)
    assert "about" in progress.time_left.text()


def test_convergence_progress_is_not_shown_for_a_quick_motion(qtbot, bottle):
    bottle.session.handles.move_by(MOTIONS["TWIST"], "1", 0)
    idle(qtbot, bottle)
    assert not bottle.status.progress.isVisible()
