"""Whatever names the keys of an action names those that it has now."""

import meshes
import numpy as np
import pytest
from driving import document, idle
from PySide6.QtWidgets import QAbstractButton, QLabel, QWidget

from apd_viewer.geometry.mesh.mesh import Mesh
from apd_viewer.geometry.pose.constraints import BASE, HANDLE
from apd_viewer.ui.preferences.shortcuts import native_keys, text_with_keys
from apd_viewer.ui.tools.tool_modes import Tool

MODIFIERS = "Alt+", "Alt+Shift+", "Ctrl+Alt+"


def words(window):
    """All that the window says, but for dialogs opened before, whose F1 is no action of the window."""
    said = []
    for widget in window.shell.findChildren(QWidget):
        if widget.window() is not window.shell:
            continue
        said += [widget.toolTip(), widget.text() if isinstance(widget, QLabel | QAbstractButton) else ""]
    return [text for text in said if text]


def change_all(window):
    """Give every action keys that no other word has; the old ones by their entries."""
    entries = [entry for entry in window.help.shortcuts.entries if entry.keys]
    old = {entry: native_keys(entry.keys) for entry in entries}
    for number, entry in enumerate(entries):
        entry.keys = f"{MODIFIERS[number // 35]}F{number % 35 + 1}"
    assert len({entry.keys for entry in entries}) == len(entries)
    return old


def paint(window, label, ids):
    window.session.gestures.begin()
    window.session.painting.paint(np.asarray(ids), label)
    window.session.painting.end_stroke("Paint")


@pytest.fixture
def ball(qtbot, kept_window):
    """A ball with nothing painted, and with a finding."""
    V, F = meshes.sphere(2)
    kept_window.session.files.open_mesh(Mesh(np.vstack([V, 3 * np.ones(3)]), F))
    idle(qtbot, kept_window)
    return kept_window


def test_shortcut_hints_name_no_keys_that_an_action_had(ball):
    before = words(ball)
    old = change_all(ball)
    after = words(ball)
    for entry, keys in old.items():
        named = [text for text in before if f"({keys})" in text]
        assert not [text for text in after if f"({keys})" in text], entry.title
        assert len([text for text in after if f"({native_keys(entry.keys)})" in text]) == len(named)
    keys = [f"({native_keys(entry.keys)})" for entry in old]
    named = [text for text in after if any(key in text for key in keys) and "\n" not in text]
    assert len(named) >= 6, "panel, badge, legend, section and invitation name some"
    assert ball.findings.badge.toolTip() == text_with_keys(
        "Issues found in the mesh, and where they are", ball.actions_.view.findings
    )


@pytest.mark.parametrize(
    ("painted", "tool"),
    [((), Tool.BASE), ((BASE,), Tool.HANDLE), ((BASE, HANDLE), Tool.MOVE)],
    ids=["base", "handle", "move"],
)
def test_next_step_hint_follows_the_keys_of_the_tool_that_it_names(ball, painted, tool):
    for label in painted:
        paint(ball, label, np.argsort(document(ball).mesh.V[:-1, 1])[slice(-9, None) if label else slice(9)])
    ball.tools.choose_tool(Tool.ORBIT)
    action = ball.actions_.tools[tool]
    assert ball.invitation.text().endswith(f" ({tool.traits.key})")
    entry = next(entry for entry in ball.help.shortcuts.entries if entry.action is action)
    ball.help.shortcuts.assign_keys(entry, "Ctrl+J")
    assert ball.invitation.text().endswith(" (Ctrl+J)")
    ball.help.shortcuts.assign_keys(entry, "")
    assert not ball.invitation.text().endswith(")")
