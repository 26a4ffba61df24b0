"""Kernels are kept from one start to the next; files that are damaged, old or refused are done without."""

import importlib.util
import logging
import random
import shutil
import sys

import platformdirs
import pytest

LOGGER = "apd_viewer.geometry.linalg.kernels"
INNER = """
from apd_viewer.geometry.linalg.kernels import njit

@njit(cache=True)
def step(x):
    return x + {step}
"""
OUTER = """
from apd_viewer.geometry.linalg.kernels import njit
from inner import step

@njit(cache=True, nogil=True)
def walk(x):
    for _ in range(10):
        x = step(x)
    return x

@njit(cache=True)
def double(x):
    return 2.0 * x
"""
START = 2.0


class Modules:
    """Two modules with kernels, in a folder."""

    def __init__(self, home):
        self.home, self.beside = home, home / "__pycache__"

    def write(self, step=1):
        self.home.mkdir(exist_ok=True)
        (self.home / "inner.py").write_text(INNER.format(step=step))
        (self.home / "outer.py").write_text(OUTER)
        return self

    def file(self, name):
        (found,) = self.beside.glob(f"outer.{name}-*.nbc")
        return found

    def kernel(self, name):
        """A kernel as it is after a start."""
        for each in ("inner", "outer"):
            spec = importlib.util.spec_from_file_location(each, self.home / f"{each}.py")
            sys.modules[each] = importlib.util.module_from_spec(spec)
            spec.loader.exec_module(sys.modules[each])
        return getattr(sys.modules["outer"], name)

    def compiles(self, step=1):
        """Whether a start has to compile the kernel; what it computes is right either way."""
        walk = self.kernel("walk")
        assert walk(START) == START + 10 * step
        return bool(sum(walk.stats.cache_misses.values()))


@pytest.fixture
def modules(tmp_path, monkeypatch, caplog):
    monkeypatch.delenv("NUMBA_CACHE_DIR", raising=False)
    monkeypatch.setattr(platformdirs, "user_cache_dir", lambda *_, **__: str(tmp_path / "users"))
    monkeypatch.setattr(sys, "dont_write_bytecode", True)
    caplog.set_level(logging.INFO, LOGGER)
    yield Modules(tmp_path / "modules").write()
    for name in ("inner", "outer"):
        sys.modules.pop(name, None)


def flipped(content):
    """The content with one bit changed, at each of some places."""
    for place in random.Random(1).sample(range(8 * len(content)), 4):
        changed = bytearray(content)
        changed[place // 8] ^= 1 << place % 8
        yield bytes(changed)


def test_kernel_cache_compiles_a_kernel_once_and_the_log_says_so(modules, caplog):
    assert modules.compiles()
    assert f"Compiled {modules.file('walk')}" in caplog.messages
    caplog.clear()
    assert not modules.compiles()
    assert caplog.messages == []


def test_kernel_cache_notes_damaged_files_and_makes_them_anew(modules, caplog):
    modules.compiles()
    modules.kernel("double")(START)
    file, other = modules.file("walk"), modules.file("double").read_bytes()
    whole = file.read_bytes()
    damaged = [b"", whole[:1], whole[: len(whole) // 2], whole[:-1], whole + b"0", b"text\n", *flipped(whole)]
    for content in damaged:
        file.write_bytes(content)
        caplog.clear()
        assert modules.compiles()
        assert caplog.messages[0] == f"{file} is compiled again: the file is damaged"
        assert not modules.compiles(), "made anew"
    file.write_bytes(other)
    assert modules.compiles(), "another kernel's file is none of this one's"
    file.unlink()
    assert modules.compiles()
    assert not modules.compiles()
    assert {path.suffix for path in modules.beside.iterdir()} == {".nbc"}, "nothing unfinished is left"


def test_kernel_cache_compiles_a_kernel_again_where_one_within_it_has_changed(modules, tmp_path, caplog):
    modules.compiles()
    shutil.copytree(modules.home, tmp_path / "moved")
    moved = Modules(tmp_path / "moved")
    assert not moved.compiles(), "the place of the modules makes no difference"
    shutil.copytree(modules.home, tmp_path / "changed")
    changed = Modules(tmp_path / "changed").write(step=2)
    caplog.clear()
    assert changed.compiles(step=2)
    assert not any("again" in line for line in caplog.messages), "an old file is no damaged one"
    assert not changed.compiles(step=2)


def test_kernel_cache_keeps_no_old_kernel_of_sources_that_change_while_the_program_runs(modules):
    walk = modules.kernel("walk")
    modules.write(step=2)
    assert walk(START) == START + 10
    shutil.copytree(modules.home, modules.home.parent / "next")
    assert Modules(modules.home.parent / "next").compiles(step=2)


def test_kernel_cache_uses_the_user_s_folder_where_none_can_be_written_beside_the_modules(
    modules, tmp_path, caplog
):
    modules.beside.touch()  # no folder, which not even root can write into
    assert modules.compiles()
    assert [path.parts[-3] for path in tmp_path.glob("users/kernels/*/outer.walk-*.nbc")] == ["kernels"]
    caplog.clear()
    assert not modules.compiles()


def test_kernel_cache_without_any_folder_compiles_kernels_for_this_run(modules, tmp_path, caplog):
    modules.beside.touch()
    (tmp_path / "users").touch()
    assert modules.compiles()
    assert modules.compiles()
    said = "Compiled kernels are not kept (Not a directory); name a folder in NUMBA_CACHE_DIR, or wait"
    assert caplog.messages == [f"{said} at each start."], "once, and not for each kernel"


def test_kernel_cache_takes_a_named_folder_as_the_only_one(modules, tmp_path, monkeypatch):
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(tmp_path / "named"))
    assert modules.compiles()
    assert list(tmp_path.glob("named/modules_*/outer.walk-*.nbc"))
    assert not modules.beside.exists()
    assert not modules.compiles()
