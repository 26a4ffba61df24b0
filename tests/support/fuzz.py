"""Damaged files of all formats: each opens, and can be inspected and written, or is refused in one sentence.

    python tests/support/fuzz.py [count] [seed]

A process of its own opens them, with little memory and a watch over its time: whatever stops it is one
failure and not the end. Each failure is printed with what makes the same file again:

    python tests/support/fuzz.py --one index seed
"""

import csv
import json
import logging
import multiprocessing
import random
import re
import struct
import sys
import tempfile
import time
import traceback
import warnings
from collections import Counter
from pathlib import Path
from xml.etree.ElementTree import ParseError

import numpy as np
from mesh_contents import FILES

from apd_viewer.errors import InputError
from apd_viewer.files.mesh_writing import save_mesh
from apd_viewer.files.meshes import open_mesh
from apd_viewer.geometry.analysis.inspection import inspect

NAMES = sorted(FILES)
SECONDS = 2.0  # of work on a file
WATCH = 20.0  # seconds without an answer after which the process is killed
MEMORY = 1 << 30  # bytes more than the process has at its start
ABSURD = (
    "1e308",
    "-1e308",
    "1e39",
    "nan",
    "inf",
    "-1",
    "0",
    "4294967295",
    "99999999999999999999",
    "0x10",
    "",
)
ABSURD += ("1e-320", "3.5", "-2147483648", "9" * 5000, "word")
NUMBER = re.compile(rb"(?<![\w.])[-+]?\d+(?:\.\d+)?(?:e[-+]?\d+)?(?![\w.])")
COUNT = re.compile(rb"(?m)(?<=^element vertex )\d+|(?<=^element face )\d+|(?<=^element camera )\d+")
# Words of the interpreter, which say nothing to who has the file.
FOREIGN = re.compile(
    r"Traceback|Error|Exception|NoneType|dtype|numpy|ndarray|tuple|\bdict\b|\bstr\b|\bint\b|b'"
    r"|values to unpack|subscript|iterable|argument|literal|codec|operand|broadcast|int64"
    r"|buffer of|has no attribute '|convert"
)


# ---- damage: each takes the content and chance, and gives other content


def flipped(content, chance):
    body = bytearray(content)
    for _ in range(chance.choice((1, 1, 2, 8))):
        body[chance.randrange(len(body))] = chance.choice((chance.randrange(256), 0, 255, 32, 45))
    return bytes(body)


def cut(content, chance):
    return content[: chance.randrange(len(content))]


def rearranged(content, chance):
    """Lines, or pieces of a binary file, swapped, written twice or left out."""
    is_text = content.count(b"\n") * 200 > len(content)
    size = chance.choice((1, 4, 12, 50))
    parts = content.split(b"\n") if is_text else [content[k : k + size] for k in range(0, len(content), size)]
    a, b = chance.randrange(len(parts)), chance.randrange(len(parts))
    match chance.randrange(4):
        case 0:
            parts[a], parts[b] = parts[b], parts[a]
        case 1:
            parts.insert(b, parts[a])
        case 2:
            parts.insert(b, (b"\n" if is_text else b"").join([parts[a]] * chance.choice((3, 300))))
        case 3:
            del parts[a]
    return (b"\n" if is_text else b"").join(parts)


def absurd_number(content, chance):
    """A number of the text replaced; in a binary file some bytes that make one."""
    found = list(NUMBER.finditer(content[: _text_ends(content)]))
    if found and chance.random() < 0.7:
        at = chance.choice(found)
        return content[: at.start()] + chance.choice(ABSURD).encode() + content[at.end() :]
    values = (
        struct.pack("<f", chance.choice((np.nan, np.inf, 3e38, -1.0, 1e-45))),
        struct.pack(">f", chance.choice((np.nan, np.inf, 3e38, -1.0))),
        struct.pack("<d", chance.choice((np.nan, 1e308, -np.inf))),
        struct.pack(">d", chance.choice((np.nan, 1e308))),
        struct.pack("<i", chance.choice((-1, 2**31 - 1, 65536, 1000))),
    )
    value, at = chance.choice(values), chance.randrange(len(content))
    return content[:at] + value + content[at + len(value) :]


def other_counts(content, chance):
    """The numbers of vertices and faces that a file begins with."""
    if content.startswith(b"ply"):
        found = list(COUNT.finditer(content))
    else:
        found = list(NUMBER.finditer(content[:100]))
    if content.startswith(b"glTF") or not found:
        at = chance.choice((8, 12, 80))
        return content[:at] + struct.pack("<I", chance.choice((0, 3, 2**31, 2**32 - 1))) + content[at + 4 :]
    at = chance.choice(found)
    near = str(int(at[0]) + chance.choice((-1, 1, 2))) if at[0].isdigit() and len(at[0]) < 20 else "7"
    number = near if chance.random() < 0.5 else chance.choice(ABSURD)
    return content[: at.start()] + number.encode() + content[at.end() :]


def other_words(content, chance):
    """Two words of the text swapped: types, names, keywords, numbers."""
    found = list(re.finditer(rb"[^\s\"{}\[\],:]+", content[: min(_text_ends(content), 5000)]))
    if len(found) < 2:
        return content
    a, b = sorted(chance.sample(found, 2), key=lambda word: word.start())
    return content[: a.start()] + b[0] + content[a.end() : b.start()] + a[0] + content[b.end() :]


def blown_up(content, chance):
    """A long run of one byte somewhere, which a careless pattern takes for ever to look through."""
    at = chance.randrange(len(content))
    return (
        content[:at] + chance.choice((b" ", b"\t", b"\\\n", b"0", b"/", b"\n", b"1 ")) * 30_000 + content[at:]
    )


def other_json(content, chance):
    """A value of the JSON of a glTF replaced, left out, or made to lead back to itself."""
    try:
        document, binary = _document(content)
    except (ValueError, RecursionError, struct.error):
        return flipped(content, chance)
    places = list(_places(document))
    if not places:
        return content
    holder, key = chance.choice(places)
    nodes = document.get("nodes") if isinstance(document, dict) else None
    match chance.randrange(6):
        case 0 if isinstance(nodes, list) and nodes and isinstance(nodes[-1], dict):
            nodes[-1]["children"] = [
                chance.randrange(-1, len(nodes) + 1) for _ in range(chance.choice((1, 2)))
            ]
        case 1:
            del holder[key]
        case 2:
            holder[key] = chance.choice(places)[0]
        case _:
            holder[key] = chance.choice(
                (
                    None,
                    True,
                    -1,
                    0,
                    1,
                    2**31,
                    10**20,
                    10**400,
                    1e308,
                    float("nan"),
                    0.5,
                    "",
                    "word",
                    [],
                    {},
                    [[]],
                )
                + (
                    "../a.bin",
                    "\0",
                    [1e308] * 16,
                    [0] * 16,
                    [-1],
                    {"a": 1},
                    "data:,",
                    "data:;base64,A",
                    5,
                    5121,
                )
            )
    try:
        text = json.dumps(document, ensure_ascii=chance.random() < 0.5)
    except (ValueError, RecursionError):  # it leads back to itself now
        text = chance.choice(("[", '{"a":')) * 100_000
    return _packed(text.encode("utf-8", errors="replace"), binary)


def _document(content):
    if not content.startswith(b"glTF"):
        return json.loads(content), None
    (length,) = struct.unpack_from("<I", content, 12)
    return json.loads(content[20 : 20 + length]), content[20 + length :]


def _packed(text, binary):
    if binary is None:
        return text
    text += b" " * (-len(text) % 4)
    head = struct.pack("<4sIII4s", b"glTF", 2, 20 + len(text) + len(binary), len(text), b"JSON")
    return head + text + binary


def _places(value):
    """Every place in a document that holds a value: what it is in, and its key there."""
    keys = value.items() if isinstance(value, dict) else enumerate(value) if isinstance(value, list) else ()
    for key, inner in list(keys):
        yield value, key
        yield from _places(inner)


def _text_ends(content):
    """How much of the content is text."""
    if content.startswith(b"ply") and b"format ascii" not in content[:40]:
        return content.find(b"end_header") + 1
    if content.startswith(b"glTF"):
        return 20 + int.from_bytes(content[12:16], "little")
    return 0 if b"\0" in content[:90] else len(content)


ANY = (flipped, cut, rearranged, absurd_number, absurd_number, other_counts, other_words, blown_up)


def damaged(index, seed):
    """Name, content and damage of the file number ``index``: always the same."""
    chance = random.Random(f"{seed} {index}")
    name = NAMES[index % len(NAMES)]
    content, done = FILES[name], []
    for _ in range(chance.choice((1, 1, 2, 3))):
        is_gltf = name.endswith((".glb", ".gltf"))
        damage = other_json if is_gltf and chance.random() < 0.6 else chance.choice(ANY)
        content = damage(content, chance) or b"\n"
        done.append(damage.__name__)
    return name, content, done


# ---- what must hold of each of them


def looked_at(path, out):
    """Open the file and use what is in it; "opened", or "refused" by one of the two."""
    try:
        mesh = open_mesh(path)
    except InputError as error:
        check_sentence(error)
        return "refused"
    assert np.isfinite(mesh.V).all(), "positions that are no numbers"
    assert all(isinstance(what, str) for what in mesh.origin.extras)
    inspect(mesh)
    U = 2.0 * mesh.V  # exact: polygons are split into the same triangles
    try:
        save_mesh(mesh, U, out)
    except InputError as error:
        check_sentence(error)
        return "opened, not written"
    again = open_mesh(out)
    np.testing.assert_array_equal(again.F, mesh.F, "other faces were written")
    off = np.abs(again.V - U).max()
    assert off <= 1e-6 * np.abs(U).max() + 1e-37, f"what was written is off by {off:g}"
    return "opened"


def check_sentence(error):
    said = str(error)
    assert len(said.splitlines()) == 1, f"more than one line: {said!r}"
    assert said.endswith("."), f"no sentence: {said!r}"
    assert re.sub("[\u00a0\u202f\u200c\u200d]", "", said).isprintable(), f"not printable: {said!r}"
    own = re.sub(r"“.*?”|is not valid: .*", "", said)  # without what it shows of the file
    assert not FOREIGN.search(own), f"not for people: {said!r}"
    cause = error.__cause__
    expected = ValueError | OSError | csv.Error | struct.error | ParseError | None
    assert isinstance(cause, expected), f"a reader raised {cause!r}"
    if isinstance(cause, ValueError):
        *_, (frame, _) = traceback.walk_tb(cause.__traceback__)
        where = frame.f_code.co_filename
        assert "apd_viewer" in where, f"something in {where} raised {cause!r}, which nobody expected"


def outcome(index, seed, folder):
    """What came of a file, and how it failed; empty if it did not."""
    name, content, _ = damaged(index, seed)
    path, out = (Path(folder) / f"{kind}{Path(name).suffix}" for kind in ("damaged", "written"))
    path.write_bytes(content)
    said = []
    handler = logging.Handler(logging.WARNING)
    handler.emit = lambda record: said.append(record.getMessage())
    logging.getLogger().addHandler(handler)
    began = time.process_time()
    try:
        with warnings.catch_warnings(record=True) as caught:
            warnings.simplefilter("always")
            what = looked_at(path, out)
    except Exception:
        return "failed", traceback.format_exc()
    finally:
        logging.getLogger().removeHandler(handler)
    said += [f"{warning.filename}:{warning.lineno}: {warning.message}" for warning in caught]
    took = time.process_time() - began
    if took > SECONDS:
        said.append(f"it took {took:.1f} s")
    return ("failed", "; ".join(said)) if said else (what, "")


# ---- the process that opens them, and the one that watches it


def work(answers, first, count, seed, folder):
    """Send an outcome a file, from ``first`` on."""
    for warm in range(len(NAMES)):  # compiles what is compiled, before memory is short
        path = Path(folder) / NAMES[warm]
        path.write_bytes(FILES[NAMES[warm]])
        looked_at(path, Path(folder) / f"written{path.suffix}")
    _limit_memory()
    for index in range(first, count):
        answers.send(outcome(index, seed, folder))


def _limit_memory():
    try:
        import resource
    except ImportError:  # Windows
        return
    used = int(re.search(r"VmSize:\s+(\d+) kB", Path("/proc/self/status").read_text())[1]) * 1024
    resource.setrlimit(resource.RLIMIT_AS, (used + MEMORY, resource.getrlimit(resource.RLIMIT_AS)[1]))


def fuzz(count, seed, report=print):
    """Outcomes of so many files by kind, and the failures: (index, what went wrong)."""
    outcomes, failures, index = Counter(), [], 0
    spawn = multiprocessing.get_context("spawn")  # a fork would share the memory of the tests
    with tempfile.TemporaryDirectory() as folder:
        while index < count:
            answers, end = spawn.Pipe(duplex=False)
            child = spawn.Process(target=work, args=(end, index, count, seed, folder))
            child.start()
            end.close()
            patience = 120.0  # for the imports
            try:
                while index < count:
                    what, why = answers.recv() if answers.poll(patience) else ("failed", "it takes for ever")
                    hangs, patience = why == "it takes for ever", WATCH
                    outcomes[what] += 1
                    if what == "failed":
                        failures.append((index, why))
                        report(f"--one {index} {seed}: {damaged(index, seed)[::2]}\n{why}")
                    index += 1
                    if hangs:
                        break
            except EOFError:
                child.join()
                outcomes["failed"] += 1
                failures.append((index, f"the process ended with {child.exitcode}"))
                report(f"--one {index} {seed}: {damaged(index, seed)[::2]}\n{failures[-1][1]}")
                index += 1
            child.kill()
            child.join()
            answers.close()
    return outcomes, failures


def main(count=20_000, seed=0):
    began = time.monotonic()
    outcomes, failures = fuzz(count, seed)
    print(f"{count:,} files, seed {seed}, {time.monotonic() - began:.0f} s: {dict(outcomes)}")  # noqa: T201
    sys.exit(1 if failures else 0)


if __name__ == "__main__":
    if sys.argv[1:2] == ["--one"]:
        name, content, done = damaged(int(sys.argv[2]), int(sys.argv[3]))
        path = Path(tempfile.gettempdir()) / f"damaged{Path(name).suffix}"
        print(path, done)  # noqa: T201
        print(*outcome(int(sys.argv[2]), int(sys.argv[3]), path.parent), sep="\n")  # noqa: T201
    else:
        main(*map(int, sys.argv[1:]))
