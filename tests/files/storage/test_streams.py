"""What is no regular file is written through, or refused by a sentence, and never replaced."""

import contextlib
import json
import os
import socket
import stat
import subprocess
import sys
import threading
from pathlib import Path

import pytest
from meshes import box

from apd_viewer import Mesh, save_mesh
from apd_viewer.__main__ import main
from apd_viewer.errors import InputError
from apd_viewer.files.storage.atomic_file import replacing_file, staging_folder

pytestmark = pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="streams of Unix")


def kind(path):
    return stat.S_IFMT(os.lstat(path).st_mode)


def write(path, text="new"):
    with replacing_file(path) as scratch:
        scratch.write_text(text)
    return scratch


@contextlib.contextmanager
def read(path, most=-1):
    """What a reader of a pipe finds until the end of the block, in a list after it."""
    found, source = [], os.open(path, os.O_RDONLY | os.O_NONBLOCK)
    holder = os.open(path, os.O_WRONLY)  # without any writer it would find the end at once
    os.set_blocking(source, True)

    def drain():
        with os.fdopen(source, "rb", buffering=0) as stream:
            found.append(stream.read(most))

    reader = threading.Thread(target=drain)
    reader.start()
    try:
        yield found
    finally:
        os.close(holder)
        reader.join(30.0)


@pytest.fixture
def bar():
    return Mesh(*box())


@pytest.fixture
def pipe(tmp_path):
    path = tmp_path / "pipe.obj"
    os.mkfifo(path)
    return path


def test_replacing_file_gives_all_to_a_pipe_that_is_read(pipe, tmp_path):
    link = tmp_path / "link.obj"
    link.symlink_to(pipe)
    for path in (pipe, link):
        with read(pipe) as found:
            scratch = write(path, "x" * 200_000)
        assert found == [b"x" * 200_000]
        assert not scratch.exists()
    assert kind(pipe) == stat.S_IFIFO
    assert kind(link) == stat.S_IFLNK
    assert sorted(tmp_path.iterdir()) == [link, pipe]


def test_replacing_file_takes_a_reader_that_has_seen_enough_for_no_error(pipe):
    with read(pipe, most=10) as found:
        write(pipe, "x" * 2_000_000)
    assert found == [b"x" * 10]


def test_replacing_file_refuses_a_pipe_that_nobody_reads_without_waiting(pipe):
    with pytest.raises(InputError, match="no program reads from it"):
        write(pipe)
    assert kind(pipe) == stat.S_IFIFO


@pytest.mark.parametrize(("device", "refused"), [("/dev/null", ""), ("/dev/full", "No space left on device")])
def test_replacing_file_lets_devices_and_links_to_them_stay(device, refused, tmp_path):
    link = tmp_path / "link.obj"
    link.symlink_to(device)
    for path in (Path(device), link):
        with pytest.raises(InputError, match=refused) if refused else contextlib.nullcontext():
            write(path)
    assert kind(link) == stat.S_IFLNK
    assert kind(device) == stat.S_IFCHR
    assert list(tmp_path.iterdir()) == [link]


def test_replacing_file_refuses_what_takes_no_content_before_any_work(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)  # names of sockets are short
    with socket.socket(socket.AF_UNIX) as own:
        own.bind("a.obj")
        loop = tmp_path / "loop.obj"
        loop.symlink_to(loop)
        for path, reason in ((tmp_path / "a.obj", "not a regular file"), (loop, "symbolic links")):
            before = kind(path)
            with pytest.raises(InputError, match=reason):
                replacing_file(path).__enter__()
            assert kind(path) == before
    assert sorted(each.name for each in tmp_path.iterdir()) == ["a.obj", "loop.obj"]


def test_staging_folder_fills_a_folder_around_a_pipe_never_over_it(tmp_path):
    os.mkfifo(tmp_path / "b.txt")
    with pytest.raises(InputError, match="not a regular file"), staging_folder(tmp_path) as scratch:
        (scratch / "b.txt").write_text("new")
    assert kind(tmp_path / "b.txt") == stat.S_IFIFO


def test_save_mesh_writes_a_mesh_through_a_link_to_nowhere(bar, tmp_path):
    path = tmp_path / "nowhere.obj"
    path.symlink_to("/dev/null")
    save_mesh(bar, bar.V, path)
    assert kind(path) == stat.S_IFLNK


def output_of(words, **streams):
    program = "import sys; from apd_viewer.__main__ import main; sys.exit(main())"
    done = subprocess.run(
        [sys.executable, "-c", program, *map(str, words)], check=False, stderr=subprocess.PIPE, **streams
    )
    assert done.returncode == 0, done.stderr
    return done.stdout


@pytest.mark.parametrize("to_file", [pytest.param(False, marks=pytest.mark.night), True])
def test_volumes_writes_a_report_on_the_standard_output_with_what_else_is_printed(bar, tmp_path, to_file):
    mesh, kept = tmp_path / "bar.obj", tmp_path / "kept.txt"
    save_mesh(bar, bar.V, mesh)
    words = "volumes", mesh, "--json", "/dev/stdout"
    if to_file:
        with kept.open("wb") as stream:
            output_of(words, stdout=stream)
        said = kept.read_bytes()
    else:
        said = output_of(words, stdout=subprocess.PIPE)
    report, end = json.JSONDecoder().raw_decode(said.decode())
    assert report
    assert "bar" in said.decode()[end:]


def test_volumes_says_in_a_sentence_that_no_space_is_left(bar, tmp_path, capsys):
    mesh, full = tmp_path / "bar.obj", tmp_path / "full.json"
    save_mesh(bar, bar.V, mesh)
    full.symlink_to("/dev/full")
    assert main(["volumes", str(mesh), "--json", str(full)]) == 2
    assert "No space left on device" in capsys.readouterr().err
    assert kind(full) == stat.S_IFLNK
