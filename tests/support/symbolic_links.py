"""Tests that need symbolic links."""

import tempfile
from pathlib import Path

import pytest


def can_link():
    """True if this user may make symbolic links; on Windows that takes a right that few have."""
    with tempfile.TemporaryDirectory() as folder:
        try:
            Path(folder, "link").symlink_to("nothing")
        except OSError:
            return False
    return True


needs_links = pytest.mark.skipif(not can_link(), reason="this user may not make symbolic links here")
