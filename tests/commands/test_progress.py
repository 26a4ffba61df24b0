"""Progress: a bar on a terminal, which goes away, and nothing where nobody would read it."""

import sys

from apd_viewer.commands.terminal.progress import Progress


def drawn(text, width=100):
    """What stands on a line of a terminal after the text."""
    line, at = [" "] * width, 0
    for sign in text:
        if sign == "\r":
            at = 0
        else:
            line[at], at = sign, at + 1
    return "".join(line).rstrip()


def test_progress_is_a_bar_on_a_terminal_that_goes_away(monkeypatch, capsys):
    monkeypatch.setattr(sys.stderr, "isatty", lambda: True)
    clock = iter(range(10))
    monkeypatch.setattr("time.monotonic", lambda: float(next(clock)))
    progress = Progress()
    progress.show(0.0, "a long word for what is done")
    progress.show(0.5, "Exact")
    text = capsys.readouterr().err
    assert drawn(text) == "━" * 12 + "╌" * 12 + "  50 %  Exact"
    progress.end()
    assert drawn(text + capsys.readouterr().err) == ""


def test_progress_is_said_no_more_often_than_can_be_read(monkeypatch, capsys):
    monkeypatch.setattr(sys.stderr, "isatty", lambda: True)
    monkeypatch.setattr("time.monotonic", lambda: 1.0)
    progress = Progress()
    for k in range(1000):
        progress.show(k / 1000, "Exact")
    assert capsys.readouterr().err.count("\r") == 1


def test_progress_gives_a_file_nothing(capsys):
    progress = Progress()
    progress.show(0.5, "Exact")
    progress.end()
    assert capsys.readouterr() == ("", "")
