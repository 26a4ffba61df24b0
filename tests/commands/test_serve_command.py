"""The solver for other programs: its messages, its shapes, and whatever else comes through a pipe."""

import io
import json
import os
import random
import re
import struct
import threading
import time
import tracemalloc
from pathlib import Path

import numpy as np
import pytest
from message_fuzz import answers_to, complaint_of, damaged_case, message_bytes, painted_ball, whole_messages
from solver_client import SolverClient, opening_arrays

import apd_viewer
from apd_viewer.commands import solver_service
from apd_viewer.commands.message_stream import MOST_ARRAY_BYTES, read_message, write_message
from apd_viewer.geometry.solver.path_iteration import PathIteration

PAGE = Path(__file__).parents[2] / "docs" / "reference" / "protocol.md"


@pytest.fixture
def ball():
    """A painted ball."""
    return painted_ball()


def targets_of(ball, shift):
    mesh, base, handle = ball
    return np.vstack([mesh.V[base], mesh.V[handle] + shift])


def split_arrays(told):
    """Head of a message in the manual, and the arrays written as lists in it."""
    given = {
        name: value for name, value in told.items() if name in ("V", "F", "fixed", "handle", "U", "targets")
    }
    kinds = {"F": "<i8", "fixed": "<i8", "handle": "<i8"}
    arrays = {name: np.array(value, kinds.get(name, "<f8")) for name, value in given.items()}
    return {name: value for name, value in told.items() if name not in given}, arrays


def test_serve_command_answers_as_the_manual_shows():
    lines = re.findall(r"^([<>]) (.+)$", PAGE.read_text(encoding="utf-8"), re.MULTILINE)
    assert len(lines) > 12
    with SolverClient() as client:
        for way, text in lines:
            head, arrays = split_arrays(json.loads(text))
            if way == ">":
                write_message(client.process.stdin, head, arrays)
                continue
            told = client.received("hello", "open", "frame", "cancel", "close", "error")
            assert {name: told.head[name] for name in head} == head
            assert told.arrays.keys() == arrays.keys()
            for name, array in arrays.items():
                np.testing.assert_allclose(told.arrays[name], array, atol=1e-12)
    assert client.process.returncode == 0


@pytest.mark.parametrize(
    "settings",
    [
        {},
        pytest.param({"method": "local"}, marks=pytest.mark.night),
        {"method": "wall", "wall_thickness": 0.01},
    ],
)
def test_serve_command_gives_the_bits_of_deform(ball, settings):
    mesh, base, handle = ball
    targets = targets_of(ball, [0.2, 0.0, 0.1])
    whole = apd_viewer.deform(mesh.V, mesh.F, np.r_[base, handle], targets, handle=handle, **settings)
    with SolverClient() as client:
        client.answer("open", opening_arrays(*ball), settings=settings)
        client.send("move", {"targets": targets}, id="there")
        last = client.last_frame()
    assert last.head["motion"] == "there"
    assert last.head["iteration"] == whole.iterations
    assert last.head["converged"] is whole.converged is True
    np.testing.assert_array_equal(last.arrays["U"], whole.U)


def test_serve_command_follows_a_path_as_deform_does(ball):
    mesh, base, handle = ball
    path = np.stack([targets_of(ball, [0.0, 0.0, height]) for height in (0.1, 0.2, 0.3)])
    whole = apd_viewer.deform(mesh.V, mesh.F, np.r_[base, handle], path, handle=handle)
    with SolverClient() as client:
        client.answer("open", opening_arrays(*ball))
        client.send("move", {"targets": path})
        last = client.last_frame()
    np.testing.assert_array_equal(last.arrays["U"], whole.U)


def test_serve_command_keeps_the_last_motion_when_the_next_one_is_refused(ball):
    with SolverClient() as client:
        client.answer("open", opening_arrays(*ball))
        client.send("move", {"targets": targets_of(ball, [0.0, 0.0, 0.1])}, id="old")
        before = client.last_frame()
        client.send("move", {"targets": np.zeros((1, 3))}, id="wrong")
        assert client.received("error").head["id"] == "wrong"
        client.send("frame")
        after = client.received("frame")
    assert (before.head["motion"], after.head["motion"]) == ("old", "old")
    np.testing.assert_array_equal(after.arrays["U"], before.arrays["U"])


def test_solver_service_answers_a_frame_asked_for_while_it_refuses_a_motion(ball):
    """Nothing is iterated then: a request taken as if something were would wait for ever."""
    reader, writer = os.pipe()
    told = []

    class Sink(io.BytesIO):
        def write(self, data):
            told.append(bytes(data))
            if b'"error"' in bytes(data):
                os.write(writer, message_bytes({"op": "frame", "id": "second"}))
                time.sleep(0.3)  # it is read meanwhile
            return len(data)

    def wait_for(name):
        end = time.monotonic() + 30.0
        while name not in b"".join(told):
            assert time.monotonic() < end
            time.sleep(0.01)

    with os.fdopen(reader, "rb") as source, os.fdopen(writer, "wb", buffering=0) as sink:
        service = solver_service.SolverService(source, Sink())
        running = threading.Thread(target=service.run, daemon=True)
        running.start()
        sink.write(message_bytes({"op": "open"}, opening_arrays(*ball)))
        sink.write(
            message_bytes({"op": "move", "iterations": 1}, {"targets": targets_of(ball, [0.0, 0.0, 0.1])})
        )
        sink.write(message_bytes({"op": "frame", "id": "first"}))
        wait_for(b'"first"')
        sink.write(message_bytes({"op": "move"}, {"targets": np.zeros((1, 3))}))
        wait_for(b'"second"')
        sink.close()
        running.join(30.0)


def test_serve_command_answers_the_newest_motion(ball):
    with SolverClient() as client:
        client.answer("open", opening_arrays(*ball), dtype="<f4")
        for number in range(200):
            client.send("move", {"targets": targets_of(ball, [0, 0, number / 400])}, id=number)
        last = client.last_frame()
    assert last.head["motion"] == 199
    assert last.arrays["U"].dtype == "<f4"
    np.testing.assert_allclose(
        last.arrays["U"][ball[2]], targets_of(ball, [0, 0, 199 / 400])[len(ball[1]) :], atol=1e-6
    )


def test_serve_command_finishes_no_motion_that_is_replaced(ball, monkeypatch):
    """A request read during an iteration, behind a newer motion, gets the shape before that motion."""
    reading, writing = os.pipe()
    has_read, iterate = threading.Event(), PathIteration.iterate

    def iterate_once_all_is_read(walk):
        if not has_read.is_set():
            with os.fdopen(writing, "wb") as pipe:
                write_message(pipe, {"op": "move", "id": "new"}, {"targets": targets_of(ball, [0, 0, 0.1])})
                write_message(pipe, {"op": "frame"}, {})
            assert has_read.wait(60)
        return iterate(walk)

    monkeypatch.setattr(PathIteration, "iterate", iterate_once_all_is_read)
    first = message_bytes({"op": "open"}, opening_arrays(*ball))
    first += message_bytes({"op": "move", "id": "old"}, {"targets": targets_of(ball, [0, 0, 0])})
    threading.Thread(target=os.write, args=(writing, first), daemon=True).start()
    sink = io.BytesIO()
    with os.fdopen(reading, "rb") as source:
        solver_service.SolverService(source, sink, has_read.set).run()
    sink.seek(0)
    frames = [told.head for told in iter(lambda: read_message(sink), None) if told.head["op"] == "frame"]
    assert [(head["motion"], head["finished"]) for head in frames] == [("old", False)]


def test_serve_command_keeps_a_new_volume(ball):
    with SolverClient() as client:
        client.answer("open", opening_arrays(*ball), settings={"method": "local", "contact": False})
        client.send("move", {"targets": targets_of(ball, [0, 0, 0.1])})
        before = client.last_frame().head
        client.send("keep", settings={"volume": 95.0}, id=8)
        after = client.last_frame().head
    rest = np.linalg.det(ball[0].V[ball[0].F]).sum() / 6.0
    assert after["motion"] == 8
    assert after["volume"] / rest == pytest.approx(0.95, abs=1e-8)
    assert before["volume"] / rest != pytest.approx(0.95, abs=1e-3)


def test_serve_command_cancels_a_motion_and_opens_another_mesh(ball):
    with SolverClient() as client:
        client.answer("open", opening_arrays(*ball))
        client.send("move", {"targets": targets_of(ball, [0.5, 0, 0.5])}, iterations=10**9)
        client.answer("frame")
        assert client.answer("cancel", id=4).head["id"] == 4
        first, again = client.answer("frame"), client.answer("frame")
        assert first.head["finished"]
        np.testing.assert_array_equal(first.arrays["U"], again.arrays["U"])
        assert client.answer("close").head["op"] == "close"
        assert client.answer("frame").head["message"] == "Send “move” first."
        assert client.answer("open", opening_arrays(*ball)).head["op"] == "open"


WRONG = [
    ({"op": "dance"}, {}, "op must be one of hello, open"),
    ({"op": ["hello"]}, {}, "op must be one of"),
    ({"op": "hello", "protocol": 2}, {}, "speaks protocol 1"),
    ({"op": "open"}, {}, "The array V is missing."),
    ({"op": "open", "dtype": "<i4"}, {}, "dtype must be"),
    ({"op": "open", "settings": {"methd": "exact"}}, {}, "“methd” is no setting"),
    ({"op": "open", "settings": 3}, {}, "settings must be an object"),
    ({"op": "open", "settings": {"method": 7}}, "ball", "7"),
    ({"op": "open", "settings": {"stiffness": -1}}, "ball", "stiffness"),
    ({"op": "open"}, {"V": np.zeros((0, 3)), "F": np.zeros((0, 3))}, "fixed is missing"),
    ({"op": "move"}, {"targets": np.zeros((2, 3))}, "Send “open” first."),
    ({"op": "keep"}, {}, "Send “open” first."),
    ({"op": "frame"}, {}, "Send “move” first."),
]


@pytest.mark.parametrize(("head", "arrays", "said"), WRONG)
def test_solver_service_answers_what_cannot_be_meant_in_a_sentence(ball, head, arrays, said):
    given = opening_arrays(*ball) if arrays == "ball" else arrays
    after = message_bytes({"op": "hello", "protocol": 1})
    (error, hello), _ = answers_to(message_bytes({**head, "id": 5}, given) + after)
    assert error.head["op"] == "error"
    assert error.head["id"] == 5
    assert error.head["kind"] == "input"
    assert said in error.head["message"]
    assert hello.head["op"] == "hello"


@pytest.mark.parametrize(
    ("name", "wrong"),
    [
        ("targets", {"targets": np.zeros((2, 3))}),
        ("targets", {}),
        ("finite", {"targets": np.full((2, 3), np.nan)}),
        ("handle", {"handle": np.full(3, -1)}),
        ("fixed", {"fixed": np.array([10**6])}),
        ("V", {"V": np.zeros((4, 2))}),
        ("F", {"F": np.full((1, 3), 10**6)}),
    ],
)
def test_solver_service_refuses_arrays_that_do_not_fit(ball, name, wrong):
    opening = opening_arrays(*ball)
    content = message_bytes({"op": "open"}, opening | {k: v for k, v in wrong.items() if k in opening})
    content += message_bytes({"op": "move"}, {k: v for k, v in wrong.items() if k == "targets"})
    found, _ = answers_to(content)
    assert {message.head["op"] for message in found} >= {"error"}
    assert {message.head.get("kind", "input") for message in found} == {"input"}, name


DAMAGED = {
    "huge head": struct.pack("<Q", 1 << 60),
    "no head": struct.pack("<Q", 0),
    "no JSON": struct.pack("<Q", 5) + b"hello",
    "no text": struct.pack("<Q", 2) + b"\xff\xff",
    "list": struct.pack("<Q", 2) + b"[]",
    "deep": struct.pack("<Q", 60_000) + b'{"a":' + b"[" * 59_995,
    **{
        name: struct.pack("<Q", len(text)) + text
        for name, text in {
            "infinite": b'{"id": 1e400}',
            "constant": b'{"id": NaN}',
            "pickle": b'{"arrays": [["V", "|O", [1]]]}',
            "big end": b'{"arrays": [["V", ">f8", [1]]]}',
            "negative": b'{"arrays": [["V", "<f8", [-1]]]}',
            "too large": b'{"arrays": [["V", "<f8", [1000000000, 1000000000]]]}',
            "fraction": b'{"arrays": [["V", "<f8", [1.5]]]}',
            "truth": b'{"arrays": [["V", "<f8", [true]]]}',
            "axes": b'{"arrays": [["V", "<f8", [1, 1, 1, 1]]]}',
            "twice": b'{"arrays": [["V", "<f8", [0]], ["V", "<f8", [0]]]}',
            "number": b'{"arrays": 7}',
            "short row": b'{"arrays": [["V", "<f8"]]}',
        }.items()
    },
}


@pytest.mark.parametrize("name", DAMAGED)
def test_solver_service_ends_with_a_sentence_after_what_is_no_message(name):
    found, sentence = answers_to(message_bytes({"op": "hello", "protocol": 1}) + DAMAGED[name])
    assert [message.head["op"] for message in found] == ["hello", "error"]
    assert found[1].head["kind"] == "protocol"
    assert found[1].head["message"] == sentence
    assert sentence.endswith(".")


def test_message_stream_ends_quietly_within_a_message(ball):
    whole = message_bytes({"op": "open"}, opening_arrays(*ball))
    for length in (0, 3, 8, 20, 400, len(whole) - 1):
        assert read_message(io.BytesIO(whole[:length])) is None
    assert read_message(io.BytesIO(whole)).head == {"op": "open"}


def test_message_stream_allocates_what_has_arrived_not_what_is_announced():
    count = MOST_ARRAY_BYTES // 8
    text = json.dumps({"op": "open", "arrays": [["V", "<f8", [count]]]}).encode()
    content = struct.pack("<Q", len(text)) + text + bytes(100)
    tracemalloc.start()
    try:
        assert read_message(io.BytesIO(content)) is None
        assert tracemalloc.get_traced_memory()[1] < 4 << 20
    finally:
        tracemalloc.stop()


def test_serve_command_ends_with_the_program_that_started_it(ball):
    client = SolverClient()
    client.answer("open", opening_arrays(*ball))
    client.send("move", {"targets": targets_of(ball, [0.5, 0, 0.5])}, iterations=10**9)
    client.answer("frame")
    started = time.monotonic()
    client.process.stdin.close()
    assert client.process.wait(20) == 0
    assert time.monotonic() - started < 5.0
    client.__exit__()


def test_serve_command_tells_damage_on_both_streams():
    with SolverClient() as client:
        client.process.stdin.write(DAMAGED["huge head"])
        client.process.stdin.flush()
        assert client.received("error").head["kind"] == "protocol"
        assert client.process.wait(20) == 2
        assert client.process.stderr.read().decode().startswith("error: A head must have")


def test_solver_service_tells_its_progress(ball, monkeypatch):
    monkeypatch.setattr(solver_service, "BEAT", 0.02)
    slow = solver_service.Deformation

    def opened(*given, **named):
        time.sleep(0.3)
        return slow(*given, **named)

    monkeypatch.setattr(solver_service, "Deformation", opened)
    found, _ = answers_to(message_bytes({"op": "open", "id": 3}, opening_arrays(*ball)))
    told = [message.head for message in found if message.head["op"] == "progress"]
    assert len(told) >= 3
    assert {(head["id"], head["stage"]) for head in told} == {(3, "opening")}
    assert all(0.0 <= head["compiled"] <= 1.0 for head in told)
    assert found[-1].head["op"] == "open"


def test_solver_service_reports_an_error_of_its_own_and_goes_on(ball, monkeypatch, caplog):
    def broken(*given, **named):
        raise ZeroDivisionError("nothing there")

    monkeypatch.setattr(solver_service, "Deformation", broken)
    content = message_bytes({"op": "open", "id": 3}, opening_arrays(*ball))
    (error, hello), _ = answers_to(content + message_bytes({"op": "hello", "protocol": 1}))
    assert error.head["kind"] == "internal"
    assert "nothing there" in error.head["message"]
    assert hello.head["op"] == "hello"
    assert "ZeroDivisionError" in caplog.text


def test_solver_service_meets_damaged_messages_with_sentences():
    messages, seen = whole_messages(), set()
    for number in range(300):
        complaint, ops = complaint_of(damaged_case(messages, random.Random(number)))
        assert not complaint, number
        seen.update(ops)
    assert seen >= {"hello", "open", "frame", "error", "cancel", "close"}
