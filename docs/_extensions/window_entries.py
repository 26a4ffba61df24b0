"""Print the menu entries of a window as JSON; a script that is run in a process of its own.

Without a display Qt's platform "offscreen" makes all of the window but its pixels.
"""

import json
import os
import sys

from PySide6.QtCore import QSettings

from apd_viewer.ui.actions.action_factory import plain
from apd_viewer.ui.application import make_application
from apd_viewer.ui.help.help import _full, _leaves, _menu
from apd_viewer.ui.shell import Shell
from apd_viewer.ui.workbench import Workbench

application = make_application(["apd-viewer"])
window = Workbench(Shell(QSettings(f"{sys.argv[1]}/settings.ini", QSettings.Format.IniFormat)))
entries = {entry.action: entry for entry in window.actions_.entries}
rows = [
    (plain(top.text()), entry.name, _full(within, entry.title), entry.keys, entry.tip)
    for top in window.shell.menuBar().actions()
    for action, within in _leaves(_menu(top))
    if (entry := entries.get(action)) is not None
]
print(json.dumps(rows), flush=True)
os._exit(0)  # nothing is kept, and a window without pixels is not taken down in order
