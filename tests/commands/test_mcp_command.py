"""Tools for language models: an exchange with a real process, and what it must refuse."""

import base64
import json
import random
import subprocess
import sys
import time
from pathlib import Path

import jsonschema
import numpy as np
import pytest
from meshes import ends, sphere
from process_tree import tree_of

from apd_viewer.__main__ import main
from apd_viewer.commands.mcp_command import LONGEST_MESSAGE, REVISIONS, STATELESS
from apd_viewer.commands.tool_arguments import TOOLS, command_words, tool_fields
from apd_viewer.errors import InputError
from apd_viewer.files.mesh_writing import save_mesh
from apd_viewer.files.meshes import open_mesh
from apd_viewer.geometry.mesh.mesh import Mesh
from apd_viewer.session.model.state import initial_state
from apd_viewer.session.model.view import View
from apd_viewer.session.storage.session_file import save_session

TWIST = {"mesh": "ball.off", "selection": "ball.sel", "motion": "twist 20deg", "output": "out.off"}


class Client:
    """Process of the command, and the messages to and from it."""

    def __init__(self, folder, *options):
        words = [sys.executable, "-m", "apd_viewer", "mcp", str(folder), *options]
        pipe = subprocess.PIPE
        self.process = subprocess.Popen(words, stdin=pipe, stdout=pipe, stderr=pipe)
        self.count = 0

    def __enter__(self):
        return self

    def __exit__(self, *_):
        with self.process:
            self.process.stdin.close()
            self.process.wait(60)

    def send(self, line):
        """Send a line: bytes, or what becomes JSON."""
        content = line if isinstance(line, bytes) else json.dumps({"jsonrpc": "2.0", **line}).encode()
        self.process.stdin.write(content + b"\n")
        self.process.stdin.flush()

    def received(self):
        """The next message."""
        message = json.loads(self.process.stdout.readline())
        assert message.pop("jsonrpc") == "2.0"
        return message

    def ask(self, method, **parameters):
        """The answer to a request."""
        self.count += 1
        self.send({"id": self.count, "method": method, "params": parameters})
        message = self.received()
        assert message.pop("id") == self.count
        return message.get("result", message)

    def call(self, tool, **arguments):
        """Result of a tool."""
        return self.ask("tools/call", name=tool, arguments=arguments)


@pytest.fixture
def folder(tmp_path):
    """A folder with a painted mesh, beside a mesh that is none of its business."""
    V, F = sphere(2)
    inside = tmp_path / "inside"
    inside.mkdir()
    labels = np.ones(len(V), dtype=int)
    labels[ends(V)[0]], labels[ends(V)[1]] = 0, 2
    np.savetxt(inside / "ball.sel", labels, fmt="%d")
    for path in (inside / "ball.off", tmp_path / "secret.off"):
        save_mesh(Mesh(V, F), V, path)
    (tmp_path / "secret.sel").write_bytes((inside / "ball.sel").read_bytes())
    return inside


def sentence_of(result):
    """Sentence of a failed call."""
    assert result["isError"] is True
    (said,) = result["content"]
    return said["text"]


def test_mcp_command_exchanges_what_the_protocol_asks_for(folder, capsys):
    with Client(folder) as client:
        told = client.ask("initialize", protocolVersion=REVISIONS[1], capabilities={}, clientInfo={})
        assert told["protocolVersion"] == REVISIONS[1]
        assert told["capabilities"] == {"tools": {}}
        client.send({"method": "notifications/initialized"})
        assert client.ask("ping") == {}
        assert [tool["name"] for tool in client.ask("tools/list")["tools"]] == list(TOOLS)
        told = client.call("info", mesh="ball.off")
        assert told["isError"] is False
        assert json.loads(told["content"][0]["text"]) == told["structuredContent"]
        done = client.call("deform", **TWIST, iterations=3)
        assert done["structuredContent"]["iterations"] == 3
    assert client.process.returncode == 0
    assert len(open_mesh(folder / "out.off").V) == done["structuredContent"]["vertices"]
    main(["info", str(folder / "ball.off"), "--json"])
    assert json.loads(capsys.readouterr().out)["area"] == told["structuredContent"]["area"]


def test_mcp_command_answers_the_revision_it_knows(folder):
    with Client(folder) as client:
        assert client.ask("initialize", protocolVersion="1999-01-01")["protocolVersion"] == REVISIONS[0]
        key = "io.modelcontextprotocol/protocolVersion"
        told = client.ask("server/discover", _meta={key: STATELESS})
        assert told["supportedVersions"] == [STATELESS, *REVISIONS]
        assert client.ask("tools/list", _meta={key: STATELESS})["resultType"] == "complete"
        refused = client.ask("tools/list", _meta={key: "1999-01-01"})["error"]
        assert refused["code"] == -32022
        assert refused["data"]["supported"] == told["supportedVersions"]


@pytest.mark.night  # by day the exchange without a picture
def test_mcp_command_sends_the_picture_that_was_asked_for(folder):
    with Client(folder) as client:
        told = client.call(
            "press", mesh="ball.off", axis="z", to="95%", steps=1, iterations=5, figure="curve.png"
        )
    text, picture = told["content"]
    assert picture["mimeType"] == "image/png"
    assert base64.b64decode(picture["data"]) == (folder / "curve.png").read_bytes()
    assert json.loads(text["text"])["volume"] > 0.0


@pytest.mark.parametrize("name", TOOLS)
def test_mcp_command_describes_its_tools_by_valid_schemas(name):
    schema = tool_fields(name)["inputSchema"]
    jsonschema.Draft202012Validator.check_schema(schema)
    assert "mesh" in schema["required"]
    assert all(value["description"] for value in schema["properties"].values())


def test_mcp_command_writes_each_kind_of_argument_as_the_command_reads_it(folder):
    arguments = {
        **TWIST,
        "contact": False,
        "calm": True,
        "weld": False,
        "volume": -5,
        "transform": ["a.def"],
        "region": [["rim", "rim.sel", "90"]],
        "young": None,
    }
    jsonschema.validate(
        {**arguments, "volume": "-5"} | {"young": "1GPa"}, tool_fields("deform")["inputSchema"]
    )
    options = TOOLS["deform"]().parse_args(command_words("deform", arguments, folder)[1:])
    assert (options.contact, options.calm, options.weld) == (False, True, False)
    assert (options.mesh, options.volume, options.young) == ("ball.off", "-5", None)
    assert options.transform == ["a.def"]
    assert options.region == [["rim", "rim.sel", "90"]]


@pytest.mark.parametrize(
    "arguments",
    [
        {"mesh": "../secret.off"},
        {"mesh": "{out}/secret.off"},
        {"mesh": "link.off"},
        {"mesh": "around/../secret.off"},
        {"mesh": "ball.off", "compare": "../secret.off"},
        {"mesh": "ball.off", "thickness": "../secret.glb:0.2..0.8"},
        {"mesh": "ball.off", "thickness": "link.glb:0.2mm..0.8mm"},
        {"mesh": "ball.off", "region": [["rim", "../secret.sel"]]},
        {"mesh": "ball.off", "output": "../out.off"},
        {"mesh": "ball.off", "output": "link.obj"},
        {"mesh": "a\0b"},
    ],
    ids=str,
)
def test_mcp_command_refuses_files_elsewhere(folder, arguments):
    (folder / "link.off").symlink_to("../secret.off")
    (folder / "link.obj").symlink_to("../new.obj")
    (folder / "link.glb").symlink_to("../secret.glb")
    (folder / "around").symlink_to(folder)
    tool = next(
        name for name in TOOLS if arguments.keys() <= tool_fields(name)["inputSchema"]["properties"].keys()
    )
    given = json.loads(json.dumps(arguments).replace("{out}", folder.parent.as_posix()))
    with pytest.raises(InputError, match="is not in the folder"):
        command_words(tool, given, folder)


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        ({"mesh": "-"}, "standard input"),
        ({"mesh": "./-"}, "standard input"),
        ({"mesh": ["ball.off"]}, "has to be"),
        ({"mesh": "ball.off", "weld": "yes"}, "has to be"),
        ({"mesh": "ball.off", "region": [["rim", "--output=/tmp/x"]]}, "dash|not in the folder"),
        ({"mesh": "ball.off", "json": "x.json"}, "is no argument"),
        ({"mesh": "ball.off", "twist": "20deg"}, "is no argument"),
    ],
    ids=str,
)
def test_mcp_command_refuses_what_it_does_not_understand(folder, arguments, words):
    with pytest.raises(InputError, match=words):
        command_words("deform", arguments, folder)


def test_mcp_command_opens_no_file_elsewhere_that_a_file_names(folder):
    """A session may name its mesh anywhere."""
    other = folder.parent / "other"
    other.mkdir()
    save_session(other / "away.apd", initial_state(open_mesh(folder.parent / "secret.off")), View())
    (other / "away.apd").rename(folder / "away.apd")
    with Client(folder) as client:
        told = client.call("press", mesh="away.apd", to="95%", steps=1, iterations=1)
    assert "secret.off is not in the folder" in sentence_of(told)
    assert main(["press", str(folder / "away.apd"), "--to", "95%", "--steps", "1", "--json"]) == 0


def test_mcp_command_replaces_files_only_with_the_flag(folder):
    old = b"something dear"
    (folder / "out.off").write_bytes(old)
    (folder / "load.csv").write_bytes(old)
    with Client(folder) as client:
        assert "may not be replaced" in sentence_of(client.call("deform", **TWIST, iterations=1))
        told = client.call("press", mesh="ball.off", axis="z", to="95%", steps=1, curve="load.csv")
        assert "may not be replaced" in sentence_of(told)
    assert (folder / "out.off").read_bytes() == (folder / "load.csv").read_bytes() == old
    with Client(folder, "--overwrite") as client:
        assert not client.call("deform", **TWIST, iterations=1)["isError"]
    assert (folder / "out.off").read_bytes() != old


def test_mcp_command_tells_the_sentence_of_the_command(folder, capsys):
    (folder / "broken.off").write_text("OFF\n1 2")
    with Client(folder) as client:
        said = sentence_of(client.call("info", mesh="broken.off"))
    main(["info", str(folder / "broken.off"), "--json"])
    assert capsys.readouterr().err.strip() == f"error: {said}"


@pytest.mark.skipif(
    sys.platform != "linux", reason="reads the tree of processes in /proc, which Linux alone has"
)
@pytest.mark.parametrize("way", ["cancelled", "closed", "killed"])
def test_mcp_command_ends_a_call(folder, way):
    with Client(folder) as client:
        client.send(
            {
                "id": "long",
                "method": "tools/call",
                "params": {
                    "name": "deform",
                    "arguments": TWIST | {"iterations": 10**9},
                },
            }
        )
        own = client.process.pid
        deadline = time.monotonic() + 30
        while len(running := set(tree_of(own)) - {own}) < 1 and time.monotonic() < deadline:
            time.sleep(0.02)
        assert running
        time.sleep(1.0)
        if way == "cancelled":
            client.send({"method": "notifications/cancelled", "params": {"requestId": "long"}})
            assert client.ask("ping") == {}
        elif way == "closed":
            client.process.stdin.close()
            assert client.process.wait(20) == 0
        else:
            client.process.kill()
            client.process.wait(20)
        deadline = time.monotonic() + 20
        while any(Path(f"/proc/{each}/exe").exists() for each in running) and time.monotonic() < deadline:
            time.sleep(0.05)
        assert [each for each in running if Path(f"/proc/{each}/exe").exists()] == []
        assert not (folder / "out.off").exists()
        if way == "cancelled":
            assert client.ask("ping") == {}


BAD = {
    b"{": -32700,
    b"\xff\xfe": -32700,
    b"[" * 100_000: -32700,
    b"1" * 5000: -32700,
    b"[]": -32600,
    b'"hello"': -32600,
    b"NaN": -32600,
    b'{"id": 1, "method": "ping"}': -32600,
    b'{"jsonrpc": "2.0", "id": true, "method": "ping"}': -32600,
    b'{"jsonrpc": "2.0", "id": null, "method": "ping"}': -32600,
    b'{"jsonrpc": "2.0", "id": 1.5, "method": "ping"}': -32600,
    b'{"jsonrpc": "2.0", "id": 1, "method": 7}': -32600,
    b'{"jsonrpc": "2.0", "id": 1, "method": "ping", "params": []}': -32602,
    b'{"jsonrpc": "2.0", "id": 1, "method": "resources/list"}': -32601,
    b'{"jsonrpc": "2.0", "id": 1, "method": "tools/call", "params": {"name": "rm"}}': -32602,
    b'{"jsonrpc": "2.0", "id": 1, "method": "tools/call", "params": {"name": "info", "arguments": 3}}': (
        -32602
    ),
    b"{" + b" " * LONGEST_MESSAGE + b"}": -32600,
}
IGNORED = (
    b"",
    b"  \t ",
    b'{"jsonrpc": "2.0", "id": 4, "result": {}}',
    b'{"jsonrpc": "2.0", "method": "notifications/unknown"}',
    b'{"jsonrpc": "2.0", "method": "notifications/cancelled"}',
    b'{"jsonrpc": "2.0", "method": "notifications/cancelled", "params": {"requestId": [1]}}',
    b'{"jsonrpc": "2.0", "method": "notifications/cancelled", "params": {"requestId": 99}}',
)


def test_mcp_command_answers_bad_messages_with_errors(folder):
    generator = random.Random(7)
    good = b'{"jsonrpc": "2.0", "id": 5, "method": "tools/call", "params": {"name": "info", "arguments": {}}}'
    with Client(folder) as client:
        for line, code in BAD.items():
            client.send(line)
            assert client.received()["error"]["code"] == code, line[:100]
        for line in IGNORED:
            client.send(line)
        assert client.ask("ping") == {}
        for number in range(300):
            line = bytearray(good[: generator.randrange(len(good))])
            for _ in range(generator.randrange(4) if line else 0):
                line[generator.randrange(len(line))] = generator.randrange(256)
            client.send(bytes(line).replace(b"\n", b" "))
            client.send({"id": f"after {number}", "method": "ping"})
            message = client.received()
            if message["id"] != f"after {number}":
                assert message["error"]["code"] in {-32700, -32600, -32601, -32602}
                assert client.received() == {"id": f"after {number}", "result": {}}
        client.process.stdin.close()
        assert client.process.wait(60) == 0
        assert client.process.stderr.read() == b""


@pytest.mark.parametrize(("words", "sentence"), [(["gone"], "is not a folder"), ([], "required: FOLDER")])
def test_mcp_command_asks_for_a_folder(tmp_path, words, sentence, capsys):
    try:
        code = main(["mcp", *(str(tmp_path / word) for word in words)])
    except SystemExit as ended:
        code = ended.code
    assert code == 2
    assert sentence in capsys.readouterr().err
