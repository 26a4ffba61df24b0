"""Print the menu entries and controls of a window as JSON; a script that is run in a process of its own.

Without a display Qt's platform "offscreen" makes all of the window but its pixels.
"""

import json
import os
import sys
import time
from pathlib import Path

from PySide6.QtCore import QSettings

from apd_viewer.ui.application import make_application
from apd_viewer.ui.shell import Shell
from apd_viewer.ui.workbench import Workbench

sys.path.insert(0, str(Path(__file__).parent))
from window_controls import described, listed
from window_tour import show_all

_PATIENCE = 120  # s

application = make_application(["apd-viewer"])
window = Workbench(Shell(QSettings(f"{sys.argv[1]}/settings.ini", QSettings.Format.IniFormat)))


def wait(done):
    """Run events until a condition holds."""
    end = time.monotonic() + _PATIENCE
    while not done():
        if time.monotonic() > end:
            raise TimeoutError("The window did not come so far.")
        application.processEvents()
        time.sleep(0.01)


show_all(window, wait)
print(json.dumps({"entries": listed(window), "controls": described()}), flush=True)
window.comparison.close()
window.session.close()
os._exit(0)  # nothing is kept, and a window without pixels is not taken down in order
