"""A pipe in one's own folder of recovery is no leftover, and holds up nothing."""

import pytest
from watched_pipe import WatchedPipe

from apd_viewer.session.storage.recovery_file import find_recovery_files


@pytest.mark.parametrize("ending", ["apd", "lock"])
def test_find_recovery_files_does_not_wait_for_a_pipe_among_them(ending, tmp_path):
    pipe = WatchedPipe(tmp_path / f"1-1.{ending}")
    try:
        assert find_recovery_files(tmp_path) == []
        assert not pipe.opened
    finally:
        pipe.close()
