"""Completions for shells: every option of every command, and bash itself."""

import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from apd_viewer.commands.desktop.desktop_command import DESKTOP_PARSERS
from apd_viewer.commands.parsers import PARSERS

# Options in a help: at the beginnings of lines, before two blanks.
LINE, OPTION = re.compile(r"(?m)^  (-.*?)(?:  |$)"), re.compile(r"(?<![\w-])--?[a-z][\w-]*")
SCRIPT = Path(__file__).parents[1] / "resources" / "installer" / "completions.py"
OPTIONS = {
    name: [word for line in LINE.findall(make().format_help()) for word in OPTION.findall(line)]
    for name, make in (PARSERS | DESKTOP_PARSERS).items()
}
# Marks of a command in the three files: a list of bash, a list of arguments of zsh, a condition of fish.
BASH = re.compile(r"^_shtab_apd_viewer_(\w+)_option_strings=\((.*)\)$", re.MULTILINE)
ZSH = re.compile(r"^_shtab_apd_viewer_(\w+)_options=\(\n(.*?)^\)$", re.MULTILINE | re.DOTALL)


@pytest.fixture(scope="module")
def completions(tmp_path_factory):
    """The completions of each shell, written as for a package."""
    folder = tmp_path_factory.mktemp("completions")
    subprocess.run([sys.executable, SCRIPT, folder], check=True, capture_output=True)
    return {path.name: path for path in folder.iterdir()}


@pytest.mark.parametrize(("shell", "pattern"), [("bash", BASH), ("zsh", ZSH)])
def test_completions_of_bash_and_zsh_offer_every_option_of_every_command(completions, shell, pattern):
    found = dict(pattern.findall(completions[shell].read_text(encoding="utf-8")))
    offered = {name: OPTION.findall(text) for name, text in found.items()}
    for name, options in OPTIONS.items():
        assert set(options) <= set(offered[name.replace(" ", "_")]), name


def test_completions_of_fish_offer_every_option_of_every_command(completions):
    lines = completions["fish"].read_text(encoding="utf-8").splitlines()
    for name, options in OPTIONS.items():
        own = [line for line in lines if re.search(rf"_shtab_apd_viewer_using [\\']*{name}[\\']*'", line)]
        offered = {f"--{word}" for line in own for word in re.findall(r" -l (\S+)", line)}
        offered |= {f"-{word}" for line in own for word in re.findall(r" -s (\S+)", line)}
        assert set(options) <= offered, name


@pytest.mark.skipif(shutil.which("bash") is None, reason="needs bash")
@pytest.mark.parametrize(
    ("words", "offered"),
    [
        ("pr", "press"),
        ("press --mat", "--material"),
        ("study design --va", "--vary"),
        ("press x.obj --unit i", "in"),
        ("deform --method sr", "sr-arap"),
    ],
)
def test_completions_work_in_bash(completions, words, offered):
    asked = ["apd-viewer", *words.split()]
    code = f"""
        source {completions["bash"]}
        COMP_WORDS=({" ".join(asked)}); COMP_CWORD={len(asked) - 1}
        $(complete -p apd-viewer | sed 's/.*-F \\([^ ]*\\).*/\\1/') apd-viewer
        echo "${{COMPREPLY[@]}}"
    """
    done = subprocess.run(["bash", "-c", code], check=True, capture_output=True, text=True)
    assert done.stdout.split() == [offered]
