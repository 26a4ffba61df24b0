"""Print the figures of the program's structure: ``python tests/structure.py``.

Sizes of folders, files, functions and classes, imports and docstrings, measured on the source by ``ast``.
``tests/test_structure.py`` holds the limits.
"""

from __future__ import annotations

import ast
import io
import re
import statistics
import tokenize
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

from apd_viewer.geometry.solver.methods import METHODS

PACKAGE = Path(__file__).parents[1] / "apd_viewer"
METHOD_TABLE = "geometry/solver/methods.py"
QUESTION = re.compile(r"(what|how|where|which|whether|who|whom|whose|when|why)\b", re.IGNORECASE)
PRIVATE = re.compile(r"_[a-zA-Z]\w*")
# Of named tuples, of os, and of notebooks.
NOT_PRIVATE = {"_replace", "_asdict", "_make", "_fields", "_exit", "_repr_html_"}
REACHES = {"setattr", "delattr", "getattr", "hasattr", "patch", "object"}
RELATIVE = re.compile(r"\b(that|which|who|whom|whose|where|what)\b", re.IGNORECASE)

# What is no code of a line.
BLANK = {
    tokenize.COMMENT,
    tokenize.NL,
    tokenize.NEWLINE,
    tokenize.INDENT,
    tokenize.DEDENT,
    tokenize.ENDMARKER,
}

Function = ast.FunctionDef | ast.AsyncFunctionDef


@dataclass
class Module:
    """A source file and its syntax tree."""

    where: str
    text: str

    @cached_property
    def tree(self) -> ast.Module:
        return ast.parse(self.text)

    @cached_property
    def nodes(self) -> list[ast.AST]:
        return list(ast.walk(self.tree))

    @cached_property
    def lines(self) -> list[str]:
        return self.text.splitlines()

    @cached_property
    def functions(self) -> list[Function]:
        return [node for node in self.nodes if isinstance(node, Function)]

    @cached_property
    def classes(self) -> list[ast.ClassDef]:
        return [node for node in self.nodes if isinstance(node, ast.ClassDef)]

    @cached_property
    def docstrings(self) -> list[tuple[int, str]]:
        """Line and first line of each docstring."""
        found = []
        for node in (self.tree, *self.classes, *self.functions):
            if text := ast.get_docstring(node):
                found.append((node.body[0].value.lineno, text.splitlines()[0]))
        return found


def modules(package: Path = PACKAGE) -> list[Module]:
    """All modules of the package, by path."""
    return [
        Module(path.relative_to(package).as_posix(), path.read_text(encoding="utf-8"))
        for path in sorted(package.rglob("*.py"))
    ]


def folder_sizes(found: list[Module]) -> Counter[str]:
    """Modules in each folder, without the ``__init__``."""
    return Counter(
        str(Path(module.where).parent) for module in found if not module.where.endswith("__init__.py")
    )


def body(function: Function) -> list[ast.stmt]:
    """Statements of a function without its docstring."""
    return function.body[1:] if ast.get_docstring(function, clean=False) is not None else function.body


def body_lengths(found: list[Module]) -> list[int]:
    """Lines of each function's body, without its docstring."""
    bodies = (body(function) for module in found for function in module.functions)
    return [part[-1].end_lineno - part[0].lineno + 1 if part else 0 for part in bodies]


def method_counts(found: list[Module]) -> Counter[str]:
    """Methods of each class, with those inherited from classes of the package."""
    classes = {node.name: node for module in found for node in module.classes}
    own = {
        name: {item.name for item in node.body if isinstance(item, Function)}
        for name, node in classes.items()
    }

    def all_of(name: str) -> set[str]:
        bases = (ast.unparse(base).split(".")[-1].split("[")[0] for base in classes[name].bases)
        return own[name].union(*(all_of(base) for base in bases if base in classes and base != name))

    return Counter({name: len(all_of(name)) for name in classes})


def forwarders(found: list[Module]) -> list[str]:
    """Methods with no more to them than the same call, or the same attribute, of an attribute of self."""
    return [
        f"{module.where}:{function.lineno} {function.name}"
        for module in found
        for node in module.classes
        for function in node.body
        if isinstance(function, ast.FunctionDef) and _forwards(function)
    ]


def _forwards(function: ast.FunctionDef) -> bool:
    statements = body(function)
    if len(statements) != 1 or not isinstance(statements[0], ast.Return | ast.Expr):
        return False
    value = statements[0].value
    given = [argument.arg for argument in (*function.args.args, *function.args.kwonlyargs)][1:]
    if isinstance(value, ast.Call):
        passed = [ast.unparse(x) for x in (*value.args, *(keyword.value for keyword in value.keywords))]
        if passed != given:
            return False
        value = value.func
    elif given:
        return False
    return re.fullmatch(r"self\.\w+(\.\w+)+", ast.unparse(value) if value else "") is not None


def method_comparisons(found: list[Module]) -> list[str]:
    """Comparisons with the name of a method outside the table of methods."""
    said = []
    for module in found:
        for node in module.nodes:
            if isinstance(node, ast.Compare) and module.where != METHOD_TABLE:
                sides = [x for side in (node.left, *node.comparators) for x in ast.walk(side)]
                if any(isinstance(side, ast.Constant) and side.value in METHODS for side in sides):
                    said.append(f"{module.where}:{node.lineno} {ast.unparse(node)}")
    return said


def late_starts(found: list[Module]) -> list[str]:
    """Methods by which a part of the window would be completed after its constructor."""
    return [
        f"{module.where}:{function.lineno} {function.name}"
        for module in found
        if module.where.startswith("ui/")
        for function in module.functions
        if function.name == "start" and not {"thread", "process"} & set(Path(module.where).stem.split("_"))
    ]


def private_names(found: list[Module]) -> list[str]:
    """Uses of names with an underscore that belong to somebody else: attributes, imports, and patches."""
    said = []
    for module in found:
        for node in module.nodes:
            names = [name for name in _names_of_others(node) if PRIVATE.fullmatch(name)]
            said += [f"{module.where}:{node.lineno} {name}" for name in names if name not in NOT_PRIVATE]
    return said


def misnamed_tests(tests: list[Module], found: list[Module]) -> list[str]:
    """Tests whose name begins neither with a name of the program nor with that of their file."""
    known = {Path(module.where).stem for module in found}
    known |= {_snake(node.name) for module in found for node in (*module.functions, *module.classes)}
    said = []
    for module in tests:
        file = Path(module.where).stem.removeprefix("test_")
        names = [node.name for node in module.functions if node.name.startswith("test_")]
        said += [f"{module.where} {name}" for name in names if not _begins(name[5:], {*known, file})]
    return said


def _begins(name: str, known: set[str]) -> bool:
    words = name.split("_")
    return any("_".join(words[:count]) in known for count in range(1, len(words) + 1))


def _snake(name: str) -> str:
    return re.sub(r"(?<=[a-z0-9])(?=[A-Z])", "_", name).lower().strip("_")


def called(call: ast.Call) -> str:
    """Name of what is called, without what precedes its last dot."""
    return getattr(call.func, "attr", getattr(call.func, "id", ""))


def _names_of_others(node: ast.AST) -> list[str]:
    """Names that a node takes from elsewhere, without what precedes their last dot."""
    if isinstance(node, ast.Attribute):
        is_own = isinstance(node.value, ast.Name) and node.value.id in ("self", "cls")
        return [] if is_own else [node.attr]
    if isinstance(node, ast.ImportFrom):
        return [part for alias in node.names for part in (alias.name, *(node.module or "").split("."))]
    if isinstance(node, ast.Call) and called(node) in REACHES:
        texts = [argument.value for argument in node.args if isinstance(argument, ast.Constant)]
        return [text.split(".")[-1] for text in texts if isinstance(text, str)]
    return []


def import_share(found: list[Module]) -> float:
    """Lines of imports, of those with code."""
    imports = code = 0
    for module in found:
        words = tokenize.generate_tokens(io.StringIO(module.text).readline)
        rows = {
            row for word in words if word.type not in BLANK for row in range(word.start[0], word.end[0] + 1)
        }
        for node in module.nodes:
            if isinstance(node, ast.Import | ast.ImportFrom):
                imports += node.end_lineno - node.lineno + 1
            elif isinstance(node, ast.Module | ast.ClassDef | Function) and ast.get_docstring(node):
                rows -= set(range(node.body[0].lineno, node.body[0].end_lineno + 1))
        code += len(rows)
    return imports / code


def single_importers(found: list[Module]) -> list[str]:
    """Modules that exactly one other module imports."""
    names = {_dotted(module): module for module in found}
    importers: dict[str, set[str]] = {name: set() for name in names}
    for name, module in names.items():
        for node in module.nodes:
            if isinstance(node, ast.ImportFrom) and node.module:
                for each in (f"{node.module}.{alias.name}" for alias in node.names):
                    target = each if each in names else node.module
                    importers.get(target, set()).add(name)
            elif isinstance(node, ast.Import):
                for alias in node.names:
                    importers.get(alias.name, set()).add(name)
    return [name for name, by in importers.items() if len(by - {name}) == 1]


def _dotted(module: Module) -> str:
    path = Path(PACKAGE.name, module.where).with_suffix("")
    return ".".join(path.parent.parts if path.name == "__init__" else path.parts)


def misnamed_files(found: list[Module]) -> list[str]:
    """Modules that share no word with their largest public class."""
    said = []
    for module in found:
        public = [node for node in module.tree.body if isinstance(node, ast.ClassDef) and node.name[0] != "_"]
        if not public or module.where.endswith("__init__.py"):
            continue
        largest = max(public, key=lambda node: node.end_lineno - node.lineno)
        words = {word.rstrip("s") for word in _snake(largest.name).split("_")}
        if not words & {word.rstrip("s") for word in Path(module.where).stem.split("_")}:
            said.append(f"{module.where} {largest.name}")
    return said


def local_imports(found: list[Module]) -> Iterator[tuple[str, bool]]:
    """Imports inside functions, and whether the comment above gives a reason."""
    for module in found:
        for function in module.functions:
            for node in ast.walk(function):
                if isinstance(node, ast.Import | ast.ImportFrom):
                    yield f"{module.where}:{node.lineno}", _explained(module.lines, node.lineno)


def _explained(lines: list[str], number: int) -> bool:
    """Whether a comment stands above a line, or above the imports directly over it."""
    above = number - 2
    while above > 0 and lines[above].lstrip().startswith(("import ", "from ")):
        above -= 1
    return lines[above].lstrip().startswith("#") or "  #" in lines[number - 1]


def first_lines(found: list[Module]) -> list[tuple[str, str]]:
    """Place and first line of each docstring."""
    return [(f"{module.where}:{line}", text) for module in found for line, text in module.docstrings]


def percentile(values: list[int], share: float) -> int:
    """The value below or at which a share of them lies."""
    return sorted(values)[min(len(values) - 1, int(share * len(values)))]


def table(found: list[Module]) -> list[tuple[str, str]]:
    """Rows of name and figure."""
    bodies, lengths = body_lengths(found), [len(module.lines) for module in found]
    folder, most = folder_sizes(found).most_common(1)[0]
    name, methods = method_counts(found).most_common(1)[0]
    firsts = [text for _, text in first_lines(found)]
    imports = list(local_imports(found))
    relative = sum(len(RELATIVE.findall(text)) for text in firsts) / len(firsts)
    return [
        ("modules", f"{len(found)}"),
        ("lines", f"{sum(lengths):,}"),
        ("most modules in a folder", f"{most} ({folder})"),
        ("modules with a single importer", f"{len(single_importers(found))}"),
        ("imports of the code", f"{100 * import_share(found):.1f} %"),
        ("modules without a word of their largest class", f"{len(misnamed_files(found))}"),
        ("file length p50 / p90 / max", _spread(lengths)),
        ("function body p50 / p90 / max", _spread(bodies)),
        ("biggest class, methods with inherited", f"{methods} ({name})"),
        ("pure forwarders", f"{100 * len(forwarders(found)) / len(bodies):.1f} %"),
        ("start() methods in the window", f"{len(late_starts(found))}"),
        ("comparisons with a method's name", f"{len(method_comparisons(found))}"),
        ("imports in functions / without a reason", f"{len(imports)} / {sum(not ok for _, ok in imports)}"),
        ("class names used twice", f"{len(homonyms(found))}"),
        ("docstrings beginning with a question word", f"{sum(bool(QUESTION.match(x)) for x in firsts)}"),
        ("relative clauses per first line", f"{relative:.2f}"),
        ("first lines above 80 characters", f"{sum(len(text) > 80 for text in firsts)}"),
    ]


def homonyms(found: list[Module]) -> list[str]:
    """Class names that stand for two things or more."""
    names = Counter(node.name for module in found for node in module.classes)
    return sorted(name for name, count in names.items() if count > 1)


def _spread(values: list[int]) -> str:
    return f"{statistics.median(values):.0f} / {percentile(values, 0.9)} / {max(values)}"


if __name__ == "__main__":
    for row in table(modules()):
        print("| {} | {} |".format(*row))
