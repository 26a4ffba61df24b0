"""Every step of make says what it does and how long that took."""

import os
import re
import shutil
import subprocess
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[1]
STEP = ROOT / ".ci" / "step"


@pytest.mark.skipif(shutil.which("sh") is None, reason="there is no make either")
@pytest.mark.parametrize(("status", "told"), [(0, "   127 s"), (3, "   failed after 127 s: Some work")])
def test_make_steps_tell_their_time_and_pass_their_status_on(status, told, tmp_path):
    clock, date = tmp_path / "clock", tmp_path / "date"
    clock.write_text("1000\n")
    date.write_text(f'#!/bin/sh\ncat "{clock}"\n')
    date.chmod(0o755)
    work = f'echo "$1"; echo 1127 > "{clock}"; exit {status}'
    done = subprocess.run(
        ["sh", str(STEP), "Some work", "sh", "-c", work, "sh", "a  b"],
        env={**os.environ, "PATH": f"{tmp_path}{os.pathsep}{os.environ['PATH']}"},
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        check=False,
    )
    assert done.stdout.splitlines() == ["== Some work", "a  b", told]
    assert done.returncode == status


def test_make_steps_are_all_programs_that_take_time():
    recipes = re.findall(r"(?m)^\t@(.*)$", (ROOT / "Makefile").read_text(encoding="utf-8"))
    working = [line for line in recipes if re.search(r"/bin/|\$\((?:python|manual|environment)\)", line)]
    assert len(working) > 10
    # The program itself says what it does, and how old the last night is takes no time.
    quiet = r"\.ci/|bin/apd-viewer|--last$"
    assert [line for line in working if not re.search(quiet, line)] == []
