"""Damaged messages to the ``serve`` command: each is answered in a sentence.

    python tests/support/message_fuzz.py [minutes] [seed]

runs it for so long, and prints what fails, what takes over 5 s and how much memory was used.
"""

import io
import random
import re
import resource
import sys
import time
from collections import Counter

import numpy as np
from fuzz import FOREIGN
from meshes import sphere
from solver_client import opening_arrays

from apd_viewer.commands.message_stream import read_message, write_message
from apd_viewer.commands.solver_service import SolverService
from apd_viewer.errors import InputError
from apd_viewer.geometry.mesh.mesh import Mesh

ODD_NUMBERS = b"-1", b"0", b"1e400", b"null", b"7", b'"x"', b"99999999999", b"true", b"[]", b"{}", b"0.5"


def painted_ball():
    """A ball with its lowest vertices as base and its highest ones as handle."""
    V, F = sphere(2)
    return Mesh(V, F), np.flatnonzero(V[:, 2] < -0.8), np.flatnonzero(V[:, 2] > 0.8)


def message_bytes(head, arrays=None):
    """Content of a message."""
    sink = io.BytesIO()
    write_message(sink, head, arrays or {})
    return sink.getvalue()


def answers_to(content):
    """Messages of a service in this process to a stream, and the sentence that ended it."""
    sink, sentence = io.BytesIO(), ""
    try:
        SolverService(io.BytesIO(content), sink).run()
    except InputError as error:
        sentence = str(error)
    sink.seek(0)
    found = []
    while (message := read_message(sink)) is not None:
        found.append(message)
    return found, sentence


def whole_messages():
    """Contents of one message of each op, that make sense in this order."""
    ball = painted_ball()
    mesh, base, handle = ball
    targets = np.vstack([mesh.V[base], mesh.V[handle] + [0, 0, 0.1]])
    settings = {"method": "arap", "contact": False, "stiffness": 0.01, "loose": "go"}
    return [
        message_bytes({"op": "hello", "id": 1, "protocol": 1}),
        message_bytes({"op": "open", "id": 2, "settings": settings, "dtype": "<f4"}, opening_arrays(*ball)),
        message_bytes({"op": "move", "id": 3, "iterations": 3}, {"targets": targets}),
        message_bytes({"op": "keep", "id": 4, "settings": {"area": 100, "calm": False}}),
        message_bytes({"op": "frame", "id": 5}),
        message_bytes({"op": "cancel", "id": 6}),
        message_bytes({"op": "close", "id": 7}),
    ]


def mutated(content, chance):
    """Content with damage: bytes changed, removed or repeated, or a number in its head replaced."""
    damaged = bytearray(content)
    for _ in range(chance.randint(1, 4)):
        at, length = chance.randrange(len(damaged)), chance.randint(1, 40)
        kind = chance.randrange(4)
        if kind == 0:
            damaged[at] = chance.randrange(256)
        elif kind == 1:
            del damaged[at : at + min(length, len(damaged) - 1)]
        elif kind == 2:
            damaged[at:at] = damaged[at : at + length]
        elif numbers := [*re.finditer(rb"\d+", bytes(damaged[:400]))]:
            one = chance.choice(numbers)
            damaged[one.start() : one.end()] = chance.choice(ODD_NUMBERS)
            # With its length mended, the head itself is tried and not only its frame.
            end = damaged.find(b"]}", 8) + 2
            if end > 8:
                damaged[:8] = (end - 8).to_bytes(8, "little")
    return bytes(damaged)


def damaged_case(messages, chance):
    """A stream of messages, one of them damaged."""
    number = chance.randrange(len(messages))
    return b"".join([*messages[:number], mutated(messages[number], chance), *messages[number + 1 :]])


def complaint_of(content):
    """What is wrong with the answers to a stream, or "", and their ops."""
    found, sentence = answers_to(content)
    said = [message.head["message"] for message in found if message.head["op"] == "error"]
    inner = [message.head for message in found if message.head.get("kind") == "internal"]
    own = [each.replace("dtype", "") for each in (*said, sentence)]  # without a key of heads
    foreign = [each for each in own if FOREIGN.search(each)]
    return str((*inner, *foreign)) if inner or foreign else "", [message.head["op"] for message in found]


def main(minutes=1.0, seed=0):
    """Fuzz for some minutes; print each failure, and what was answered in all."""
    messages, ops, count, failures = whole_messages(), Counter(), 0, 0
    complaint_of(b"".join(messages))  # imports and kernels are not counted as memory
    used = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    end = time.monotonic() + 60.0 * minutes
    while time.monotonic() < end:
        count += 1
        content = damaged_case(messages, random.Random(f"{seed} {count}"))
        started = time.monotonic()
        complaint, found = complaint_of(content)
        ops.update(found)
        if complaint or time.monotonic() - started > 5.0:
            failures += 1
            print(f"seed {seed}, case {count}, {time.monotonic() - started:.1f} s: {complaint}", flush=True)  # noqa: T201
    grown = (resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - used) >> 10
    print(f"{count} cases, {failures} failures, {grown} MiB more at most; answers: {dict(ops)}")  # noqa: T201
    return failures


if __name__ == "__main__":
    sys.exit(main(*map(float, sys.argv[1:])) > 0)
