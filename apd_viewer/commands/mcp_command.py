"""The ``mcp`` command: tools for language models, by the Model Context Protocol.

One JSON-RPC 2.0 message a line, from the standard input to the standard output. Both kinds of revisions are
served: those with a handshake, and the stateless one that each request names.
"""

import argparse
import base64
import json
import os
import signal
import subprocess
import sys
import tempfile
import threading
from collections.abc import Iterator
from contextlib import suppress
from pathlib import Path
from typing import Any, BinaryIO

from apd_viewer.commands.terminal.command_output import CommandOutput
from apd_viewer.commands.terminal.parser import Parser, add_option
from apd_viewer.commands.terminal.streams import message_streams
from apd_viewer.commands.tool_arguments import TOOLS, command_words, tool_fields
from apd_viewer.errors import InputError
from apd_viewer.files.samples import resource_path
from apd_viewer.files.storage.confinement import confine_process
from apd_viewer.installation import program_version
from apd_viewer.language import tr
from apd_viewer.session.processes.child_boot import set_up_process

STATELESS = "2026-07-28"
REVISIONS = "2025-11-25", "2025-06-18", "2024-11-05"  # with a handshake, newest first
LONGEST_MESSAGE = 1 << 20  # bytes
_LARGEST_PICTURE = 8 << 20  # bytes; larger ones stay in their file
_VERSION_KEY, _SERVER_KEY = "io.modelcontextprotocol/protocolVersion", "io.modelcontextprotocol/serverInfo"
_PARSE_ERROR, _INVALID_REQUEST, _UNKNOWN_METHOD, _INVALID_PARAMETERS = -32700, -32600, -32601, -32602
_UNSUPPORTED_VERSION = -32022
_PICTURES = "picture", "figure"
_GRACE = 3.0  # seconds for a cancelled command to remove its scratch files
_ENDED = tr("The call ended without a result (exit code {code}).")
_FLAGS = getattr(subprocess, "CREATE_NO_WINDOW", 0)  # exists only on Windows
_START = """
import sys
count = int(sys.argv[1])
sys.path[:], words = sys.argv[2 : 2 + count], sys.argv[2 + count :]
from apd_viewer.commands.mcp_command import confine_call
confine_call(*words[:4])
from apd_viewer.__main__ import main
sys.exit(main(words[4:]))
"""


def mcp_parser() -> Parser:
    """Argument parser for the ``mcp`` command."""
    parser = Parser(
        has_output=False,
        prog="apd-viewer mcp",
        description=tr(
            "Offer {tools} as tools to a language model, by the Model Context Protocol over the standard "
            "input and output. Files are read and written in one folder only."
        ).format(tools=", ".join(TOOLS)),
    )
    add_option(parser, "FOLDER", tr("folder of the files, with all below it"), type=Path)
    add_option(parser, "--overwrite", tr("let the tools replace existing files in it"))
    parser.set_defaults(run=_mcp, json=None)
    return parser


def _mcp(options: argparse.Namespace) -> CommandOutput:
    folder = Path(os.path.realpath(options.folder))
    if not folder.is_dir():
        raise InputError(tr("{path} is not a folder; name an existing one.").format(path=options.folder))
    with message_streams() as (source, sink):
        McpServer(folder, options.overwrite, source, sink).run()
    return CommandOutput((), dict)


def confine_call(parent: str, folder: str, scratch: str, overwriting: str) -> None:
    """Set this process up for a command, confined to a folder."""
    set_up_process(int(parent))
    sys.stdout = sys.__stdout__
    threading.Thread(target=_end_with_input, daemon=True).start()
    confine_process(Path(folder), [Path(scratch), resource_path("")], overwriting == "True")


def _end_with_input() -> None:
    """End this process once its parent has closed the input, however it ended."""
    if not os.read(0, 1):
        os._exit(1)


class Call:
    """Command in a child process.

    Parameters
    ----------
    folder : Path
        Its working folder, to which it is confined.
    overwriting : bool
        Whether it may replace files there.
    words : list of str
        See :func:`~apd_viewer.commands.tool_arguments.command_words`.
    """

    def __init__(self, folder: Path, overwriting: bool, words: list[str]) -> None:
        self._folder, self._overwriting, self._words = folder, overwriting, words
        self._process: subprocess.Popen[bytes] | None = None
        self._lock, self._is_cancelled = threading.Lock(), False

    def run(self) -> tuple[int, bytes, str]:
        """Exit code, output, and the last line of the errors; the thread must outlive it."""
        paths = [os.path.abspath(path) for path in sys.path if path]  # noqa: PTH100
        with tempfile.TemporaryDirectory(prefix="apd-viewer-", ignore_cleanup_errors=True) as scratch:
            said = str(os.getpid()), str(self._folder), scratch, str(self._overwriting), *self._words
            own_end, end = os.pipe()  # closed by the system with this process
            try:
                with self._lock:
                    if self._is_cancelled:
                        return 1, b"", ""
                    self._process = process = subprocess.Popen(
                        [sys.executable, "-c", _START, str(len(paths)), *paths, *said],
                        stdin=own_end,
                        stdout=subprocess.PIPE,
                        stderr=subprocess.PIPE,
                        cwd=self._folder,
                        env=os.environ | dict.fromkeys(("TMPDIR", "TEMP", "TMP"), scratch),
                        creationflags=_FLAGS,
                        start_new_session=True,
                    )
                output, errors = process.communicate()
            finally:
                os.close(own_end)
                os.close(end)
        lines = errors.decode(errors="replace").strip().splitlines()
        return process.returncode, output, lines[-1] if lines else ""

    def cancel(self) -> None:
        """End the process, and all that it has started."""
        with self._lock:
            self._is_cancelled, process = True, self._process
        if process is None:
            return
        process.terminate()
        with suppress(subprocess.TimeoutExpired):
            process.wait(_GRACE)
        process.kill()
        if sys.platform != "win32":
            with suppress(ProcessLookupError):
                os.killpg(process.pid, signal.SIGKILL)


class _RpcError(Exception):
    """Error of a request: a code of JSON-RPC, a sentence and perhaps data."""


class McpServer:
    """Server of one client, over a pair of streams.

    Parameters
    ----------
    folder : Path
        Folder of all files.
    overwriting : bool
        Whether existing files may be replaced.
    source, sink : binary streams
    """

    def __init__(self, folder: Path, overwriting: bool, source: BinaryIO, sink: BinaryIO) -> None:
        self._folder, self._overwriting = folder, overwriting
        self._source, self._sink = source, sink
        self._lock = threading.Lock()  # for the sink and the calls
        self._calls: dict[str | int, Call] = {}
        self._threads: list[threading.Thread] = []

    def run(self) -> None:
        """Answer messages until the client closes the source; then end all calls."""
        try:
            while line := self._source.readline(LONGEST_MESSAGE + 1):
                if len(line) > LONGEST_MESSAGE:
                    while line and not line.endswith(b"\n"):
                        line = self._source.readline(LONGEST_MESSAGE)
                    self._send_error(None, _INVALID_REQUEST, "The message is too long.")
                elif line.strip():
                    self._receive(line)
        finally:
            for key in list(self._calls):
                self._cancel(key)
            for thread in self._threads:
                thread.join()

    def _receive(self, line: bytes) -> None:
        try:
            message = json.loads(line)
        except (ValueError, RecursionError):
            return self._send_error(None, _PARSE_ERROR, "The message is not JSON.")
        if not isinstance(message, dict) or message.get("jsonrpc") != "2.0":
            return self._send_error(None, _INVALID_REQUEST, "The message is not a JSON-RPC 2.0 object.")
        if message.keys() & {"result", "error"} and "method" not in message:
            return None  # an answer, though nothing was asked
        key, method, parameters = message.get("id"), message.get("method"), message.get("params", {})
        if "id" in message and (isinstance(key, bool) or not isinstance(key, (str, int))):
            return self._send_error(None, _INVALID_REQUEST, "The id is not a string or an integer.")
        if not isinstance(method, str):
            return self._send_error(key, _INVALID_REQUEST, "The method is not a string.")
        if key is None:
            if method == "notifications/cancelled" and isinstance(parameters, dict):
                self._cancel(parameters.get("requestId"))
            return None
        if not isinstance(parameters, dict):
            return self._send_error(key, _INVALID_PARAMETERS, "The parameters are not an object.")
        try:
            result = self._answer(key, method, parameters)
        except _RpcError as error:
            return self._send_error(key, *error.args)
        if result is not None:
            self._send({"id": key, "result": result})
        return None

    def _answer(self, key: str | int, method: str, parameters: dict[str, Any]) -> dict[str, Any] | None:
        """Result of a request, None if it comes later; raises _RpcError."""
        meta = parameters.get("_meta")
        asked = meta.get(_VERSION_KEY) if isinstance(meta, dict) else None
        if asked not in (None, STATELESS):
            told = {"supported": [STATELESS, *REVISIONS], "requested": asked}
            raise _RpcError(_UNSUPPORTED_VERSION, "Unsupported protocol version", told)
        server = {"name": "apd-viewer", "version": program_version()}
        common = {"resultType": "complete", "_meta": {_SERVER_KEY: server}} if asked else {}
        cached = {"ttlMs": 0, "cacheScope": "private"} if asked or method == "server/discover" else {}
        match method:
            case "initialize":
                wanted = parameters.get("protocolVersion")
                revision = wanted if wanted in REVISIONS else REVISIONS[0]
                return {"protocolVersion": revision, "serverInfo": server, **self._offer()}
            case "server/discover":
                return {"supportedVersions": [STATELESS, *REVISIONS], **self._offer(), **common, **cached}
            case "ping":
                return common
            case "tools/list":
                tools = [tool_fields(name, self._overwriting) for name in TOOLS]
                return {"tools": tools, **common, **cached}
            case "tools/call":
                return self._begin_call(key, parameters, common)
            case _:
                raise _RpcError(_UNKNOWN_METHOD, "There is no such method.")

    def _offer(self) -> dict[str, Any]:
        said = tr("All files are in {folder}; name them relative to it.").format(folder=self._folder)
        if not self._overwriting:
            said += " " + tr("Existing files are not replaced.")
        return {"capabilities": {"tools": {}}, "instructions": said}

    def _begin_call(
        self, key: str | int, parameters: dict[str, Any], common: dict[str, Any]
    ) -> dict[str, Any] | None:
        """Start a call, which answers by itself; its result if it cannot start."""
        name, arguments = parameters.get("name"), parameters.get("arguments")
        arguments = {} if arguments is None else arguments
        if not isinstance(name, str) or name not in TOOLS:
            raise _RpcError(_INVALID_PARAMETERS, "There is no such tool.")
        if not isinstance(arguments, dict):
            raise _RpcError(_INVALID_PARAMETERS, "The arguments are not an object.")
        if key in self._calls:
            raise _RpcError(_INVALID_REQUEST, "A request with this id is still being answered.")
        try:
            call = Call(self._folder, self._overwriting, command_words(name, arguments, self._folder))
        except InputError as error:
            return _failure(str(error)) | common
        self._calls[key] = call
        self._threads = [thread for thread in self._threads if thread.is_alive()]
        self._threads.append(threading.Thread(target=self._finish_call, args=(key, call, arguments, common)))
        self._threads[-1].start()
        return None

    def _finish_call(
        self, key: str | int, call: Call, arguments: dict[str, Any], common: dict[str, Any]
    ) -> None:
        try:
            result = self._result(*call.run(), arguments)
        except OSError as error:
            result = _failure(str(error))
        with self._lock:
            is_wanted = self._calls.get(key) is call
            if is_wanted:
                del self._calls[key]
        if is_wanted:
            self._send({"id": key, "result": result | common})

    def _result(self, code: int, output: bytes, sentence: str, arguments: dict[str, Any]) -> dict[str, Any]:
        head = tr("error: {sentence}").partition("{")[0]
        if code != 0:
            is_told = sentence.startswith(head)
            return _failure(sentence.removeprefix(head) if is_told else _ENDED.format(code=code))
        # JSON has no infinite numbers, although Python writes and reads them.
        report = json.loads(output, parse_constant=lambda _: None)
        content: list[dict[str, Any]] = [{"type": "text", "text": json.dumps(report)}]
        for name in _PICTURES:
            if isinstance(path := arguments.get(name), str):
                content.extend(_picture(self._folder / Path(path).with_suffix(".png")))
        return {"content": content, "structuredContent": report, "isError": False}

    def _cancel(self, key: Any) -> None:
        """End a call without an answer, if it still runs."""
        if isinstance(key, bool) or not isinstance(key, (str, int)):
            return
        with self._lock:
            call = self._calls.pop(key, None)
        if call is not None:
            self._threads.append(threading.Thread(target=call.cancel))
            self._threads[-1].start()

    def _send_error(self, key: str | int | None, code: int, sentence: str, data: Any = None) -> None:
        more = {} if data is None else {"data": data}
        self._send({"id": key, "error": {"code": code, "message": sentence, **more}})

    def _send(self, message: dict[str, Any]) -> None:
        line = json.dumps({"jsonrpc": "2.0", **message}).encode() + b"\n"
        with self._lock, suppress(BrokenPipeError):  # the client has gone, and closes the source too
            self._sink.write(line)
            self._sink.flush()


def _failure(sentence: str) -> dict[str, Any]:
    return {"content": [{"type": "text", "text": sentence}], "isError": True}


def _picture(path: Path) -> Iterator[dict[str, Any]]:
    """Picture of a call for its client, if it was drawn and is small enough."""
    with suppress(OSError):
        if path.stat().st_size <= _LARGEST_PICTURE:
            data = base64.b64encode(path.read_bytes()).decode()
            yield {"type": "image", "data": data, "mimeType": "image/png"}
