"""What a release uploads: its bill of materials, and that workflows and version agree."""

import json
import re
import subprocess
import sys
from importlib import metadata
from pathlib import Path

import pytest
from cyclonedx.schema import SchemaVersion
from cyclonedx.validation.json import JsonStrictValidator

import apd_viewer

ROOT = Path(__file__).parents[1]
SCRIPT = ROOT / "resources" / "installer" / "sbom.py"


def _normalized(name):
    return name.lower().replace("_", "-")


def test_package_has_a_valid_bill_of_materials_and_names_each_library_with_its_licence(tmp_path):
    path = tmp_path / "bill.json"
    subprocess.run([sys.executable, SCRIPT, path], check=True)
    text = path.read_text(encoding="utf-8")
    assert JsonStrictValidator(SchemaVersion.V1_6).validate_str(text) is None
    bill = json.loads(text)
    assert bill["metadata"]["component"]["version"] == apd_viewer.__version__
    components = {_normalized(each["name"]): each for each in bill["components"]}
    lines = [line for line in metadata.requires("apd-viewer") if "extra ==" not in line]
    assert {_normalized(re.match(r"[\w.-]+", line)[0]) for line in lines} <= set(components)
    assert not {"pytest", "ruff", "sphinx"} & set(components)
    licences = {name: each["licenses"][0] for name, each in components.items()}
    assert [name for name, said in licences.items() if "see its text" in json.dumps(said)] == []
    assert licences["ipctk"] == {"license": {"name": "MIT License"}}
    assert "LGPL-3.0-only" in json.dumps(licences["pyside6-essentials"])


def test_package_without_the_window_needs_what_the_manual_says():
    page = (ROOT / "docs" / "howto" / "install.md").read_text(encoding="utf-8")
    (named,) = re.findall(r"(?m)^pip install (numpy .*)$", page)
    lines = [line for line in metadata.requires("apd-viewer") if "extra ==" not in line]
    needed = {_normalized(re.match(r"[\w.-]+", line)[0]) for line in lines}
    assert set(named.split()) == needed - {"pyside6-essentials", "pyvista", "pyvistaqt"}


def test_package_versions_agree_with_the_citation():
    citation = (ROOT / "CITATION.cff").read_text(encoding="utf-8")
    project = (ROOT / "pyproject.toml").read_text(encoding="utf-8")
    assert re.findall(r"(?m)^version: (.*)$", citation) == [apd_viewer.__version__]
    assert re.findall(r'(?m)^version = "(.*)"$', project) == [apd_viewer.__version__]


def test_project_workflows_pin_every_action_by_its_hash():
    for path in (ROOT / ".github" / "workflows").glob("*.yml"):
        used = re.findall(r"uses: (.*)", path.read_text(encoding="utf-8"))
        assert used
        assert [each for each in used if not re.fullmatch(r"[\w./-]+@[0-9a-f]{40} # v[\d.]+", each)] == []


def _container_steps():
    """Instructions of the Containerfile with their words, comments left out and lines joined."""
    text = (ROOT / "resources" / "installer" / "Containerfile").read_text(encoding="utf-8")
    lines = re.sub(r"(?m)^#.*\n", "", text).replace("\\\n", " ").splitlines()
    return [tuple(line.split(None, 1)) for line in lines if line]


def test_package_container_copies_and_runs_what_there_is():
    steps = _container_steps()
    copied = [words.split()[:-1] for step, words in steps if step == "COPY" and "--from" not in words]
    assert sum(map(len, copied)) >= 5
    assert [name for names in copied for name in names if not (ROOT / name).exists()] == []
    run = " ".join(words for step, words in steps if step == "RUN")
    scripts = re.findall(r"resources/[\w/.-]+", run)
    assert scripts
    assert [name for name in scripts if not (ROOT / name).is_file()] == []
    # The environment that is made is the one that goes on into the image, and is on its path.
    (made,) = re.findall(r"-m venv (\S+)", run)
    assert ("COPY", f"--from=build {made} {made}") in steps
    (variables,) = (words for step, words in steps if step == "ENV")
    assert f"PATH={made}/bin:" in variables
    (started,) = (words for step, words in steps if step == "ENTRYPOINT")
    assert json.loads(started)[0] in {each.name for each in metadata.entry_points(group="console_scripts")}
    (user,) = (words for step, words in steps if step == "USER")
    assert not user.startswith(("0", "root"))
    makefile = (ROOT / "Makefile").read_text(encoding="utf-8")
    assert re.search(r"(?ms)^container:.*--file resources/installer/Containerfile \.$", makefile)


def test_package_container_has_the_libraries_of_the_manual_and_of_its_extra(monkeypatch, capsys):
    pytest.importorskip("tomllib", reason="a Python of before 3.11 has no tomllib, that of the image has")
    monkeypatch.chdir(ROOT)
    run = " ".join(words for step, words in _container_steps() if step == "RUN")
    (program,) = re.findall(r'python3 -c "(.*?)" > libraries\.txt', run)
    exec(program)
    found = {re.match(r"[\w.-]+", line)[0] for line in capsys.readouterr().out.split("\n") if line}
    page = (ROOT / "docs" / "howto" / "install.md").read_text(encoding="utf-8")
    (named,) = re.findall(r"(?m)^pip install (numpy .*)$", page)
    assert found == {*named.split(), "distributed"}
