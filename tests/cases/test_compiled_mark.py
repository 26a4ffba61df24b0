"""The mark of compiled kernels lies in a folder for all, which anybody may have filled before."""

import os
import subprocess
import sys
import tempfile

import pytest

from apd_viewer.cases.case_worker import compile_kernels_once

pytestmark = pytest.mark.skipif(sys.platform == "win32", reason="folders of Unix that are for all")


@pytest.fixture
def compilations(tmp_path, monkeypatch):
    """Commands that would compile; temporary files lie in a folder of their own."""
    commands = []
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path))
    monkeypatch.setattr(subprocess, "run", lambda command, **_: commands.append(command))
    return commands


def test_compile_kernels_once_compiles_kernels_once_on_a_machine(compilations, tmp_path):
    compile_kernels_once()
    compile_kernels_once()
    assert len(compilations) == 1
    (folder,) = tmp_path.iterdir()
    assert folder.stat().st_mode & 0o777 == 0o700


@pytest.mark.parametrize("kind", ["link", "open"])
def test_compile_kernels_once_writes_nothing_into_a_folder_that_others_made(kind, compilations, tmp_path):
    compile_kernels_once()
    (own,) = tmp_path.iterdir()
    for file in own.iterdir():
        file.unlink()
    if kind == "open":
        own.chmod(0o777)
    else:
        own.rename(tmp_path / "elsewhere")
        own.symlink_to("elsewhere")
    compile_kernels_once()
    assert list(own.iterdir()) == []


@pytest.mark.skipif(sys.platform == "win32" or os.getuid() != 0, reason="only root can give a folder away")
def test_compile_kernels_once_writes_nothing_into_a_folder_that_is_somebody_else_s(compilations, tmp_path):
    compile_kernels_once()
    (own,) = tmp_path.iterdir()
    os.chown(own, 54321, -1)
    for file in own.iterdir():
        file.unlink()
    compile_kernels_once()
    assert list(own.iterdir()) == []
