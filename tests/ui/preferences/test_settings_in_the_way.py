"""What is no file in the place of the settings, or of the language, is not waited for at the start."""

import os
import subprocess
import sys
from pathlib import Path

import pytest
from watched_pipe import WatchedPipe

CHILD = """
from apd_viewer.ui.application import make_application, user_settings
application = make_application([])
settings = user_settings()
settings.setValue("kept", 1)
settings.sync()
print(settings.fileName())
"""


@pytest.mark.skipif(sys.platform != "linux", reason="others keep settings elsewhere")
@pytest.mark.parametrize("name", ["apd-viewer.conf", "apd-viewer/apd-viewer.conf", "apd-viewer/language"])
def test_user_settings_do_not_wait_for_a_pipe_in_the_place_of_settings_or_language(name, tmp_path):
    (tmp_path / "apd-viewer").mkdir()
    pipe = WatchedPipe(tmp_path / name)
    own = {"XDG_CONFIG_HOME": str(tmp_path), "QT_QPA_PLATFORM": "offscreen", "APD_VIEWER_LANGUAGE": ""}
    done = subprocess.run(
        [sys.executable, "-c", CHILD],
        env=os.environ | own,
        cwd=Path(__file__).parents[3],
        capture_output=True,
        text=True,
        timeout=60,
        check=True,
    )
    pipe.close()
    assert not pipe.opened
    assert "kept=1" in Path(done.stdout.split()[-1]).read_text()
