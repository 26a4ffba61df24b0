"""Threads begun by the test that runs: the window that tests share has its own."""

import threading

_earlier = set()


def note_threads():
    """Take all threads alive for those of earlier tests."""
    _earlier.clear()
    _earlier.update(threading.enumerate())


def new_threads(name):
    """Running threads of a name that have begun since."""
    return [
        thread
        for thread in threading.enumerate()
        if thread.name == name and thread.ident and thread not in _earlier
    ]
