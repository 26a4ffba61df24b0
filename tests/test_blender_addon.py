"""The add-on for Blender, as far as it can be tried without it; by night Blender's own module runs it."""

import ast
import re
import sys
from pathlib import Path

import pytest

from apd_viewer.commands.solver_service import PROTOCOL

ROOT = Path(__file__).resolve().parents[1]
SOURCES = ROOT / "resources" / "blender" / "apd_live"
sys.path.insert(0, str(SOURCES.parent))
build = __import__("build")
sys.path.remove(str(SOURCES.parent))
if sys.version_info >= (3, 11):
    import tomllib
else:
    tomllib = pytest.importorskip("tomllib")


def test_blender_addon_has_the_licence_of_blender_in_each_of_its_files():
    files = sorted(SOURCES.glob("*.py"))
    assert len(files) > 6
    for file in files:
        assert file.read_text(encoding="utf-8").startswith("# SPDX-License-Identifier: GPL-3.0-or-later\n"), (
            file
        )
    manifest = tomllib.loads((SOURCES / "blender_manifest.toml").read_text(encoding="utf-8"))
    assert manifest["license"] == ["SPDX:GPL-3.0-or-later"]
    # A condition of Blender's platform for extensions.
    assert "blender" not in (manifest["name"] + manifest["id"]).lower()


def test_blender_addon_speaks_the_protocol_of_the_program():
    source = (SOURCES / "solver_process.py").read_text(encoding="utf-8")
    assert int(re.search(r"^PROTOCOL = (\d+)$", source, re.MULTILINE)[1]) == PROTOCOL


def test_blender_addon_is_assembled_with_all_that_it_imports(tmp_path):
    place = build.assembled_addon(tmp_path)
    of_blender = {"bpy", "numpy"}
    for file in place.glob("*.py"):
        for node in ast.walk(ast.parse(file.read_text(encoding="utf-8"))):
            if isinstance(node, ast.Import):
                names = {alias.name.partition(".")[0] for alias in node.names}
                assert names <= of_blender | sys.stdlib_module_names, file
            elif isinstance(node, ast.ImportFrom) and node.level == 0:
                assert node.module.partition(".")[0] in of_blender | sys.stdlib_module_names, file
            elif isinstance(node, ast.ImportFrom) and node.module:
                assert (place / f"{node.module}.py").is_file(), file
            elif isinstance(node, ast.ImportFrom):
                assert all((place / f"{alias.name}.py").is_file() for alias in node.names), file
    assert (place / "blender_manifest.toml").is_file()
