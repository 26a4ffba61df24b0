"""Notes of the functions that each test enters, in every process that it starts.

Modules are compiled with a call at the beginning of each function, without a change to their files. What
numba compiles takes no such call: a kernel is noted, with those that it calls, where Python calls it.
Imported by ``sitecustomize``, long before pytest: nothing but the standard library.
"""

from __future__ import annotations

import ast
import builtins
import contextlib
import json
import os
import sys
import time
from collections import defaultdict
from importlib.machinery import ModuleSpec, PathFinder, SourceFileLoader
from pathlib import Path

COMPILED = {"njit", "parallel", "intrinsic"}
KERNELS = "apd_viewer.geometry.linalg.kernels"
_ENTRY = "__entered__"
_open, _write, _close = os.open, os.write, os.close  # a test may replace those of os

Function = ast.FunctionDef | ast.AsyncFunctionDef


def functions_of(tree: ast.AST, inside: str = "") -> list[tuple[str, Function]]:
    """Qualified names and nodes of all functions."""
    found = []
    for node in ast.iter_child_nodes(tree):
        if isinstance(node, Function):
            found.append((inside + node.name, node))
            found += functions_of(node, f"{inside}{node.name}.<locals>.")
        else:
            found += functions_of(node, f"{inside}{node.name}." if isinstance(node, ast.ClassDef) else inside)
    return found


def is_compiled(function: Function) -> bool:
    """Whether numba compiles the function."""
    called = (each.func if isinstance(each, ast.Call) else each for each in function.decorator_list)
    return any(ast.unparse(each).split(".")[-1] in COMPILED for each in called)


def is_compiled_in(source: bytes) -> bool:
    """Whether numba compiles a function of a module."""
    return any(is_compiled(function) for _, function in functions_of(ast.parse(source)))


def with_notes(source: bytes | str, where: str) -> ast.Module:
    """Syntax tree of a module whose functions note that they are entered."""
    tree = ast.parse(source)
    found = functions_of(tree)
    compiled = tuple(name for name, node in found if is_compiled(node))
    for name, node in found:
        if not is_compiled(node) and not name.startswith(tuple(f"{each}.<" for each in compiled)):
            after = int(ast.get_docstring(node) is not None)
            first = node.body[min(after, len(node.body) - 1)]
            note = ast.parse(f"{_ENTRY}({f'{where}::{name}'!r})").body[0]
            for each in ast.walk(note):
                ast.copy_location(each, first)
            node.body.insert(after, note)
    return tree


class Notes:
    """Functions that the current test has entered, written as soon as each is met.

    One file a process. A process started by a test finds its name in the variable of pytest.
    """

    def __init__(self, folder: Path) -> None:
        self._folder = folder
        os.register_at_fork(after_in_child=self._begin)
        self._begin()

    def _begin(self) -> None:
        self._seen: set[str] = set()
        self._file = str(self._folder / f"{os.getpid()}-{time.time_ns()}.notes")
        self._heading = "=" + os.environ.get("PYTEST_CURRENT_TEST", "").rpartition(" (")[0]

    def enter(self, key: str) -> None:
        """Note that a function is entered."""
        if key not in self._seen:
            self._seen.add(key)
            self.write(key)

    def turn_to(self, test: str) -> None:
        """Begin the notes of a test."""
        self._seen.clear()
        self._heading = "=" + test

    def write(self, line: str) -> None:
        """Write a line; not where a test forbids all writing."""
        text, self._heading = f"{self._heading}\n{line}\n" if self._heading else f"{line}\n", ""
        with contextlib.suppress(OSError):
            # Opened for each line: a child may close all descriptors that it inherits.
            file = _open(self._file, os.O_WRONLY | os.O_CREAT | os.O_APPEND | os.O_CLOEXEC)
            _write(file, text.encode())
            _close(file)


class _Loader(SourceFileLoader):
    """Loader of a module with notes; their compiled code lies beside that without."""

    def __init__(self, name: str, path: str, finder: _Finder) -> None:
        super().__init__(name, path)
        self._finder = finder

    def source_to_code(self, data, path, *, _optimization=-1):
        tree = with_notes(data, self._finder.where(path))
        return compile(tree, path, "exec", dont_inherit=True, optimize=_optimization)

    def get_data(self, path):
        return super().get_data(_noted_path(path))

    def set_data(self, path, data, **options):
        super().set_data(_noted_path(path), data, **options)

    def exec_module(self, module):
        super().exec_module(module)
        if module.__name__ == KERNELS:
            _note_kernels(self._finder)


def _noted_path(path: str) -> str:
    return f"{path}.noted" if path.endswith(".pyc") else path


class _Finder:
    """Finder of the modules in some folders of the package, that of ``KERNELS`` among them."""

    def __init__(self, package: Path, folders: list[str]) -> None:
        self._package = package
        self._folders = tuple(f"{folder}/" for folder in folders)

    def find_spec(self, name: str, path=None, target=None) -> ModuleSpec | None:
        if not name.startswith(f"{self._package.name}."):
            return None
        spec = PathFinder.find_spec(name, path, target)
        if spec is not None and isinstance(spec.loader, SourceFileLoader) and self.where(spec.origin):
            spec.loader = _Loader(name, spec.origin, self)
        return spec

    def where(self, file: str) -> str:
        """Path within the package, if the file is in one of the folders; else empty."""
        with contextlib.suppress(ValueError):
            where = Path(file).relative_to(self._package).as_posix()
            return where if where.startswith(self._folders) else ""
        return ""


def _note_kernels(finder: _Finder) -> None:
    """Note kernels where Python calls them."""
    from numba.core.registry import CPUDispatcher  # not before the program imports it

    plain, known = CPUDispatcher.__call__, {}

    def noting(kernel, *args, **options):
        function = kernel.py_func
        if function not in known:
            known[function] = [
                f"{finder.where(each.__code__.co_filename)}::{each.__qualname__}"
                for each in _with_inner(function)
                if finder.where(each.__code__.co_filename)
            ]
        for key in known[function]:
            getattr(builtins, _ENTRY)(key)
        return plain(kernel, *args, **options)

    CPUDispatcher.__call__ = noting


def _with_inner(function) -> list:
    """A kernel's function, and those of the kernels that it calls."""
    found = [function]
    for each in found:
        called = (getattr(each.__globals__.get(name), "py_func", None) for name in each.__code__.co_names)
        found += {inner for inner in called if inner is not None and inner not in found}
    return found


def install(package: Path, folders: list[str], notes: Path) -> None:
    """Note what is entered in the package's folders, from now on."""
    setattr(builtins, _ENTRY, Notes(notes).enter)
    sys.meta_path.insert(0, _Finder(package, folders))


def read_map(folder: Path) -> dict:
    """Seconds and outcomes of tests, and the tests of each function, from a folder of notes.

    What was entered outside any test, at imports, counts for none.
    """
    tests: dict[str, list] = {}
    reached = defaultdict(set)
    for file in sorted(folder.glob("*.notes")):
        test = ""
        for line in file.read_text(encoding="utf-8").splitlines():
            if line.startswith("="):
                test = line[1:]
            elif line.startswith("#"):
                tests[test] = json.loads(line[1:])
            elif test:
                reached[line].add(test)
    return {"tests": tests, "reached": {key: sorted(names) for key, names in sorted(reached.items())}}
