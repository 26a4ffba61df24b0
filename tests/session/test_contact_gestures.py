"""Contact in a session: no gesture leads to a frame that crosses itself."""

import contact_gestures
import pytest


@pytest.mark.parametrize(("gestures", "seed"), [(20, 7), pytest.param(60, 2, marks=pytest.mark.night)])
def test_session_shows_no_frame_that_crosses_itself_whatever_the_user_does(gestures, seed):
    frames, touched = contact_gestures.play(gestures, seed)
    assert frames > gestures
    assert touched > 5
