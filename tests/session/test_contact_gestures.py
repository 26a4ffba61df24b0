"""Contact in a session with its real process: no gesture leads to a frame that crosses itself."""

import contact_gestures


def test_no_frame_crosses_itself_whatever_the_user_does():
    frames, touched = contact_gestures.play(60, seed=2)
    assert frames > 60
    assert touched > 5
