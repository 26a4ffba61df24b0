"""Small changes to source code, each at one place, that leave all line numbers as they are.

Places are found in the syntax tree; the text is replaced at that place only.
"""

from __future__ import annotations

import ast
import random
import re
from collections import defaultdict
from collections.abc import Iterator
from dataclasses import dataclass
from functools import partial
from itertools import islice, pairwise
from pathlib import Path

from reach import Function, functions_of

COMPARISONS = {
    ast.Lt: ("<", ("<=", ">=")),
    ast.LtE: ("<=", ("<", ">")),
    ast.Gt: (">", (">=", "<=")),
    ast.GtE: (">=", (">", "<")),
    ast.Eq: ("==", ("!=",)),
    ast.NotEq: ("!=", ("==",)),
    ast.Is: ("is", ("is not",)),
    ast.IsNot: ("is not", ("is",)),
    ast.In: ("in", ("not in",)),
    ast.NotIn: ("not in", ("in",)),
}
ARITHMETIC = {
    ast.Add: ("+", "-"),
    ast.Sub: ("-", "+"),
    ast.Mult: ("*", "/"),
    ast.Div: ("/", "*"),
    ast.FloorDiv: ("//", "*"),
    ast.Mod: ("%", "*"),
    ast.Pow: ("**", "*"),
    ast.BitAnd: ("&", "|"),
    ast.BitOr: ("|", "&"),
    ast.BitXor: ("^", "|"),
    ast.LShift: ("<<", ">>"),
    ast.RShift: (">>", "<<"),
}
REMOVED = (ast.Raise, ast.AugAssign, ast.Delete, ast.Break, ast.Continue)


@dataclass(frozen=True)
class Place:
    """A change of bytes ``start`` to ``end`` of a module, in a function."""

    where: str
    function: str
    kind: str
    line: int
    start: int
    end: int
    old: str
    new: str

    @property
    def key(self) -> str:
        """Name of the function in the map of the tests that reach it."""
        return f"{self.where}::{self.function}"

    def __str__(self) -> str:
        old, new = (" ".join(text.split()) or "nothing" for text in (self.old, self.new))
        return f"{_shortened(old)} -> {_shortened(new)}"

    def applied(self, source: bytes) -> bytes:
        """Source with the change."""
        return source[: self.start] + self.new.encode() + source[self.end :]


def _shortened(text: str) -> str:
    return text if len(text) <= 50 else f"{text[:47]}..."


def chosen_places(
    package: Path, areas: dict[str, list[str]], count: int, seed: int
) -> list[tuple[str, Place]]:
    """Places by seed, each in another function, with their areas, which take turns.

    All functions of an area are equally likely, and all places in a function.
    """
    chance = random.Random(seed)
    turns = []
    for k, (area, folders) in enumerate(areas.items()):
        found = _places_by_function(package, folders)
        functions = chance.sample(list(found), len(found))
        shuffled = (chance.sample(found[key], len(found[key])) for key in functions)
        chosen = (next(filter(partial(_is_valid, package), each), None) for each in shuffled)
        wanted = (count + k) // len(areas)
        turns.append([(area, place) for place in islice(filter(None, chosen), wanted)])
    longest = max(map(len, turns))
    return [turn[k] for k in range(longest) for turn in turns if k < len(turn)]


def _places_by_function(package: Path, folders: list[str]) -> dict[str, list[Place]]:
    found = defaultdict(list)
    for folder in folders:
        for path in sorted((package / folder).rglob("*.py")):
            for place in places(path.read_bytes(), path.relative_to(package).as_posix()):
                found[place.key].append(place)
    return found


def _is_valid(package: Path, place: Place) -> bool:
    try:
        compile(place.applied((package / place.where).read_bytes()), place.where, "exec", dont_inherit=True)
    except SyntaxError:
        return False
    return True


def places(source: bytes, where: str = "") -> list[Place]:
    """All places of a module; a few changes are no valid code."""
    starts = [0]
    for line in source.splitlines(keepends=True):
        starts.append(starts[-1] + len(line))
    text = _Text(source, starts)
    found = []
    for name, function in functions_of(ast.parse(source)):
        for node in _own_nodes(function):
            for kind, start, end, new in text.changes(node):
                old, line = source[start:end].decode(), source.count(b"\n", 0, start) + 1
                lines = "\n" * old.count("\n")
                found.append(Place(where, name, kind, line, start, end, old, new + lines))
    return found


def _own_nodes(function: Function) -> Iterator[ast.AST]:
    """Nodes of a function, without its annotations and decorators, functions in it, and formatted strings."""
    defaults = [*function.args.defaults, *filter(None, function.args.kw_defaults)]
    waiting: list[ast.AST] = [*defaults, *function.body]
    while waiting:
        node = waiting.pop()
        if isinstance(node, Function | ast.JoinedStr):  # before Python 3.12 these strings tell no places
            continue
        yield node
        annotation = getattr(node, "annotation", None)
        waiting += [child for child in ast.iter_child_nodes(node) if child is not annotation]


class _Text:
    """Source of a module, and the changes that its nodes admit: kind, start, end and the new text."""

    def __init__(self, source: bytes, starts: list[int]) -> None:
        self._source = source
        self._starts = starts

    def changes(self, node: ast.AST) -> Iterator[tuple[str, int, int, str]]:
        if isinstance(node, ast.Compare):
            yield from self._comparisons(node)
        elif isinstance(node, ast.BinOp | ast.AugAssign):
            yield from self._arithmetic(node)
        elif isinstance(node, ast.BoolOp):
            old, new = ("and", "or") if isinstance(node.op, ast.And) else ("or", "and")
            for left, right in pairwise(node.values):
                yield from self._operator_change("boolean", left, right, old, new)
        elif isinstance(node, ast.UnaryOp):
            yield from self._signs(node)
        elif isinstance(node, ast.Constant):
            yield from self._constants(node)
        elif isinstance(node, ast.Return) and not _is_none(node.value):
            yield "return", self._start(node.value), self._end(node.value), "None"
        if isinstance(node, ast.If | ast.While | ast.IfExp):
            yield from self._conditions(node.test)
        if _may_be_removed(node):
            yield "statement", self._start(node), self._end(node), "pass"

    def _comparisons(self, node: ast.Compare):
        sides = [node.left, *node.comparators]
        for left, operator, right in zip(sides, node.ops, sides[1:], strict=False):
            old, news = COMPARISONS[type(operator)]
            for new in news:
                yield from self._operator_change("comparison", left, right, old, new)

    def _arithmetic(self, node: ast.BinOp | ast.AugAssign):
        sides = (node.left, node.right) if isinstance(node, ast.BinOp) else (node.target, node.value)
        if type(node.op) in ARITHMETIC:
            yield from self._operator_change("arithmetic", *sides, *ARITHMETIC[type(node.op)])

    def _signs(self, node: ast.UnaryOp):
        if isinstance(node.op, ast.Not):
            yield "not", self._start(node), self._start(node) + len("not"), ""
        elif isinstance(node.op, ast.USub):
            yield "arithmetic", self._start(node), self._start(node) + 1, "+"

    def _constants(self, node: ast.Constant):
        if isinstance(node.value, bool):
            yield "boolean", self._start(node), self._end(node), str(not node.value)
        elif isinstance(node.value, int | float):
            yield "constant", self._start(node), self._end(node), repr(node.value + 1)

    def _conditions(self, test: ast.expr):
        """Negations, unless a change to the condition itself is one."""
        if not isinstance(test, ast.Compare | ast.Constant | ast.UnaryOp):
            start, end = self._start(test), self._end(test)
            text = self._source[start:end].decode()
            if "\n" not in text:
                yield "condition", start, end, f"(not ({text}))"

    def _operator_change(self, kind: str, left: ast.AST, right: ast.AST, old: str, new: str):
        """The change of an operator; none where a comment stands beside it."""
        start, end = self._end(left), self._start(right)
        gap = self._source[start:end].decode()
        found = re.search(r"\s+".join(map(re.escape, old.split())), gap)
        if found and "#" not in gap:
            before = len(gap[: found.start()].encode())
            yield kind, start + before, start + before + len(found.group().encode()), new

    def _start(self, node: ast.AST) -> int:
        return self._starts[node.lineno - 1] + node.col_offset

    def _end(self, node: ast.AST) -> int:
        return self._starts[node.end_lineno - 1] + node.end_col_offset


def _is_none(value: ast.expr | None) -> bool:
    return value is None or (isinstance(value, ast.Constant) and value.value is None)


def _may_be_removed(node: ast.AST) -> bool:
    """Whether a statement can go: acts, and values stored in something; not what is only logged."""
    if isinstance(node, ast.Expr):
        return isinstance(node.value, ast.Call) and not ast.unparse(node.value).startswith("_LOGGER.")
    if isinstance(node, ast.Assign):
        return all(isinstance(target, ast.Attribute | ast.Subscript) for target in node.targets)
    return isinstance(node, REMOVED)
