"""The desktop: files are known by their types, opened by the program and drawn small."""

import configparser
import os
import shlex
import shutil
import subprocess
import sys
from pathlib import Path
from xml.etree import ElementTree

import meshes
import pytest
from PIL import Image

from apd_viewer.__main__ import main
from apd_viewer.commands.desktop import desktop_command
from apd_viewer.files.mesh_writing import WRITABLE_FORMATS, save_mesh
from apd_viewer.files.meshes import MESH_FORMATS
from apd_viewer.geometry.mesh.mesh import Mesh
from apd_viewer.session.model.state import initial_state
from apd_viewer.session.model.view import SESSION_SUFFIX, View
from apd_viewer.session.storage.session_file import save_session

pytestmark = pytest.mark.skipif(sys.platform != "linux", reason="desktops of freedesktop.org")

NAMESPACE = "{http://www.freedesktop.org/standards/shared-mime-info}"
MENU, TYPES = "applications/apd-viewer.desktop", "mime/packages/apd-viewer.xml"
THUMBNAILS, ICON = "thumbnailers/apd-viewer.thumbnailer", "icons/hicolor/scalable/apps/apd-viewer.svg"


def needs(program, package):
    return pytest.mark.skipif(shutil.which(program) is None, reason=f"needs {package}")


def files(folder):
    return {path.relative_to(folder).as_posix() for path in folder.rglob("*")}


def read(path, section):
    """Keys of a section, their escapes undone."""
    parser = configparser.RawConfigParser(delimiters="=")
    parser.optionxform = str
    parser.read(path, encoding="utf-8")
    return {key: value.replace("\\\\", "\\") for key, value in parser[section].items()}


def asked(*words):
    """What a program says, as on the desktop of GNOME; others do not weigh the types of a name."""
    environment = {**os.environ, "XDG_CURRENT_DESKTOP": "GNOME", "DISPLAY": ":0"}
    return subprocess.run(words, env=environment, capture_output=True, text=True, check=True).stdout.strip()


@pytest.fixture
def folder(tmp_path, monkeypatch):
    """The user's folder of data; xdg-mime looks in none with a blank in its name."""
    monkeypatch.setenv("XDG_DATA_HOME", str(tmp_path / "data"))
    monkeypatch.setenv("XDG_CONFIG_HOME", str(tmp_path / "config"))
    return tmp_path / "data"


@pytest.fixture
def installed(folder, capsys):
    assert main(["desktop", "--install"]) == 0
    assert f"to {folder}." in capsys.readouterr().out
    return folder


@pytest.fixture
def examples(tmp_path):
    """A file of each kind that can be written, by suffix."""
    mesh, found = Mesh(*meshes.box(1, 1, 2)), {}
    for suffix in WRITABLE_FORMATS:
        found[suffix] = tmp_path / f"a bar{suffix}"
        save_mesh(mesh, mesh.V, found[suffix])
    found[SESSION_SUFFIX] = tmp_path / f"a bar{SESSION_SUFFIX}"
    save_session(found[SESSION_SUFFIX], initial_state(mesh), View())
    return found


def test_desktop_command_writes_all_files_and_removes_all(installed, capsys):
    assert {MENU, TYPES, THUMBNAILS, ICON} <= files(installed)
    assert main(["desktop", "--install"]) == 0  # once more, over the old ones
    assert main(["desktop", "--remove"]) == 0
    assert f"from {installed}." in capsys.readouterr().out
    assert files(installed) == set()
    assert main(["desktop", "--remove"]) == 0
    assert "There was nothing to remove" in capsys.readouterr().out


def test_desktop_command_leaves_what_others_have_installed(folder):
    others = {
        "applications/other.desktop": "[Desktop Entry]\nType=Application\nName=Other\nExec=other\n",
        "mime/packages/other.xml": '<mime-info xmlns="http://www.freedesktop.org/standards/shared-mime-info">'
        '<mime-type type="text/x-other"><glob pattern="*.other"/></mime-type></mime-info>',
        "icons/hicolor/scalable/apps/other.svg": "<svg/>",
    }
    for name, content in others.items():
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        (folder / name).write_text(content)
    for option in ("--install", "--remove"):
        assert main(["desktop", option]) == 0
    assert {name: (folder / name).read_text() for name in others} == others
    assert not [name for name in files(folder) if "apd" in name]
    if shutil.which("update-mime-database"):
        assert "*.other" in (folder / "mime/globs2").read_text()
        assert "*.apd" not in (folder / "mime/globs2").read_text()


def test_desktop_command_names_missing_programs(folder, capsys, monkeypatch):
    monkeypatch.setattr(shutil, "which", lambda _: None)
    assert main(["desktop", "--install"]) == 0
    assert "install update-mime-database and update-desktop-database" in capsys.readouterr().out
    assert main(["desktop", "--remove"]) == 0
    assert files(folder) == set()


@pytest.mark.parametrize("content", ["#!/bin/sh\nexec sleep 60\n", "no program"])
def test_desktop_command_names_a_program_that_does_not_work_and_removes_all(
    content, folder, tmp_path, capsys, monkeypatch
):
    program = tmp_path / "collector"
    program.write_text(content)
    program.chmod(0o755)
    monkeypatch.setattr(shutil, "which", lambda _: str(program))
    run = subprocess.run
    monkeypatch.setattr(
        subprocess, "run", lambda *call, timeout, **how: run(*call, timeout=timeout / 300, **how)
    )
    assert main(["desktop", "--install"]) == 0
    assert "install update-mime-database and update-desktop-database" in capsys.readouterr().out
    assert main(["desktop", "--remove"]) == 0
    assert files(folder) == set()


def test_desktop_command_says_that_a_folder_cannot_be_written(folder, capsys):
    folder.write_text("a file")
    assert main(["desktop", "--install"]) == 2
    assert "cannot be written" in capsys.readouterr().err


@pytest.mark.parametrize(("system", "said"), [("win32", "Open with"), ("darwin", "Terminal")])
def test_desktop_command_tells_other_systems_their_own_way(system, said, monkeypatch, capsys):
    monkeypatch.setattr(sys, "platform", system)
    assert main(["desktop", "--install"]) == 2
    assert said in capsys.readouterr().err


def test_data_folder_does_not_count_a_relative_one(monkeypatch):
    for value in ("", "data"):
        monkeypatch.setenv("XDG_DATA_HOME", value)
        assert desktop_command.data_folder() == Path.home() / ".local" / "share"


def test_own_command_is_the_script_that_was_started(tmp_path, monkeypatch):
    script = tmp_path / "apd-viewer"
    script.touch()
    monkeypatch.setattr(sys, "argv", [str(script)])
    assert desktop_command.own_command() == [str(script)]
    monkeypatch.setattr(sys, "argv", ["elsewhere"])
    monkeypatch.setattr(desktop_command.sysconfig, "get_path", lambda _: str(tmp_path))
    assert desktop_command.own_command() == [str(script)]
    script.unlink()
    assert desktop_command.own_command() == [sys.executable, "-m", "apd_viewer"]


def test_desktop_command_gives_all_formats_a_type_and_opens_all_types(installed):
    types = ElementTree.parse(installed / TYPES).getroot().findall(f"{NAMESPACE}mime-type")
    patterns = {glob.get("pattern") for each in types for glob in each.findall(f"{NAMESPACE}glob")}
    assert patterns == {f"*{suffix}" for suffix in (*MESH_FORMATS, SESSION_SUFFIX)}
    named = {each.get("type") for each in types}
    for path, section in ((MENU, "Desktop Entry"), (THUMBNAILS, "Thumbnailer Entry")):
        assert set(read(installed / path, section)["MimeType"].strip(";").split(";")) == named


@needs("desktop-file-validate", "desktop-file-utils")
def test_desktop_command_installs_a_valid_menu_entry(installed):
    assert asked("desktop-file-validate", str(installed / MENU)) == ""


@needs("update-mime-database", "shared-mime-info")
@needs("update-desktop-database", "desktop-file-utils")
@needs("xdg-mime", "xdg-utils")
@needs("gio", "libglib2.0-bin")
def test_desktop_command_lets_files_be_known_and_opened_by_the_program(installed, examples):
    found = {suffix: asked("xdg-mime", "query", "filetype", str(path)) for suffix, path in examples.items()}
    assert found == {
        ".obj": "model/obj",
        ".ply": "application/vnd.ply",
        ".stl": "model/stl",
        ".off": "application/vnd.off",
        ".glb": "model/gltf-binary",
        ".apd": "application/x-apd-viewer-session",
    }
    nameless = examples[SESSION_SUFFIX].with_suffix("")
    shutil.copy(examples[SESSION_SUFFIX], nameless)
    assert asked("xdg-mime", "query", "filetype", str(nameless)) == found[".apd"]
    for kind in found.values():
        assert asked("xdg-mime", "query", "default", kind) == "apd-viewer.desktop"


@pytest.mark.parametrize("suffix", [SESSION_SUFFIX, ".stl"])
def test_desktop_command_registers_a_command_that_makes_a_thumbnail(suffix, installed, examples, tmp_path):
    entry = read(installed / THUMBNAILS, "Thumbnailer Entry")
    assert Path(entry["TryExec"]).is_absolute()
    given = {"%i": str(examples[suffix]), "%o": str(tmp_path / "thumbnail"), "%s": "96"}
    command = [given.get(word, word) for word in shlex.split(entry["Exec"])]
    subprocess.run(command, check=True, capture_output=True, timeout=60)
    with Image.open(tmp_path / "thumbnail") as image:
        assert (image.format, max(image.size)) == ("PNG", 96)


@pytest.mark.parametrize("name", ["plain", "a b", 'q"uo`te$', "back\\slash", "100%", "é'"])
def test_desktop_files_can_say_any_folder_of_the_program(name, tmp_path):
    """A word is read back as the specification says: escapes undone, then quotes, then percent signs."""
    program = str(tmp_path / name / "apd-viewer")
    desktop_command.install_files(tmp_path / "data", [program, "-m", "x"])
    for path, section in ((MENU, "Desktop Entry"), (THUMBNAILS, "Thumbnailer Entry")):
        keys = read(tmp_path / "data" / path, section)
        assert keys["TryExec"] == program
        command = ["sh", "-c", f"printf '%s\\n' {keys['Exec']}"]
        first, *rest = subprocess.run(command, capture_output=True, text=True, check=True).stdout.splitlines()
        assert first.replace("%%", "%") == program
        assert rest[:2] == ["-m", "x"]
