"""A child process alone: messages, its end, and what the log gets of one that fails."""

import subprocess
import sys
import time

import pytest

from apd_viewer.session.processes.child_process import START_SCRIPT, ChildProcess

ECHO = """
import sys
from apd_viewer.session.processes import array_pipe, child_boot
def serve(source, sink):
    while (message := array_pipe.read_message(source)) is not None:
        if message == b"fail":
            raise RuntimeError("out of luck")
        if message == b"crash":
            import faulthandler
            faulthandler._sigsegv()
        if message == b"sleep":
            import time
            time.sleep(60)
        print("printed")
        array_pipe.write_message(sink, message)
child_boot.set_up_process(parent_pid=int(sys.argv[1]))
child_boot.run_service(replies, serve)
"""
LINES = START_SCRIPT.split("from apd_viewer")[0] + ECHO


@pytest.fixture
def child():
    child = ChildProcess("echo", LINES)
    yield child
    child.kill()
    child.end()


def test_child_process_sends_and_receives_messages_until_it_is_ended(child, caplog):
    child.start()
    assert child.pid
    for message in (b"one", b"", b"two" * 10_000):
        assert child.send_messages(message)
        assert child.receive_message() == message
    child.end()
    assert child.pid is None
    assert not child.send_messages(b"one")
    assert child.receive_message() is None
    child.end()
    assert caplog.text == "", "it was ended on purpose"


def test_child_process_logs_what_it_prints(child, caplog):
    caplog.set_level("INFO", "apd_viewer")
    child.start()
    assert child.send_messages(b"one")
    assert child.receive_message() == b"one"
    child.end()
    assert caplog.messages == ["The echo process says: printed"]


def test_child_process_killed_on_purpose_is_no_failure(child, caplog):
    child.start()
    child.send_messages(b"sleep")
    started = time.monotonic()
    child.kill()
    assert child.receive_message() is None
    child.end()
    assert time.monotonic() - started < 5.0
    assert caplog.text == ""


def test_child_process_logs_an_exception_with_the_exit_code(child, caplog, capfd):
    child.start()
    child.send_messages(b"fail")
    assert child.receive_message() is None
    child.end()
    assert "echo process ended with exit code 1" in caplog.text
    assert "RuntimeError: out of luck" in caplog.text
    assert "RuntimeError: out of luck" in capfd.readouterr().err, "and a terminal, where there is one"


@pytest.mark.skipif(sys.platform == "win32", reason="Windows has no signals to crash by")
def test_child_process_logs_a_crash_with_where_it_was(child, caplog):
    child.start()
    child.send_messages(b"crash")
    assert child.receive_message() is None
    child.end()
    assert "exit code -" in caplog.text
    assert "Fatal Python error" in caplog.text
    assert "in serve" in caplog.text


def test_child_process_can_be_started_again_after_a_failure(child):
    child.start()
    child.send_messages(b"fail")
    assert child.receive_message() is None
    child.restart()
    assert child.send_messages(b"one")
    assert child.receive_message() == b"one"


def test_child_process_logs_that_it_cannot_be_started(child, caplog, monkeypatch):
    monkeypatch.setattr(sys, "executable", "/no/such/python")
    with pytest.raises(OSError, match="such"):
        child.start()
    assert "echo process cannot be started" in caplog.text


@pytest.mark.skipif(
    not sys.platform.startswith("linux"), reason="prctl is of Linux; elsewhere a child ends with its input"
)
def test_child_process_ends_at_once_when_its_owner_has_gone_before_it_began():
    script, nobody = START_SCRIPT.format(module="no_such_module"), "0"
    done = subprocess.run([sys.executable, "-c", script, nobody, *sys.path], check=False, timeout=60)
    assert done.returncode == 0
