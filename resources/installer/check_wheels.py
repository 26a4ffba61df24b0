"""Look for wheels of all dependencies, extras included, for every system and version of Python.

``python resources/installer/check_wheels.py`` asks pip to resolve each combination, without
installing anything, and prints a table. With names, such as ``linux-aarch64``, it asks for these systems.
"""

from __future__ import annotations

import json
import re
import subprocess
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
# Tags of wheels, up to those of the systems that most have today.
PLATFORMS = {
    "linux-x86_64": [f"manylinux_2_{minor}_x86_64" for minor in range(5, 36)] + ["manylinux2014_x86_64"],
    "linux-aarch64": [f"manylinux_2_{minor}_aarch64" for minor in range(17, 40)] + ["manylinux2014_aarch64"],
    "windows-x86_64": ["win_amd64"],
    "macos-arm64": [
        f"macosx_{version}_{kind}" for version in range(11, 16) for kind in ("0_arm64", "0_universal2")
    ],
    "macos-x86_64": [
        f"macosx_{version}_{kind}"
        for version in ("10_9", "10_12", "10_13", "10_14", "10_15", "11_0", "12_0", "13_0", "14_0", "15_0")
        for kind in ("x86_64", "universal2", "intel")
    ],
}
VERSIONS = ("3.10", "3.11", "3.12", "3.13")


def requirements() -> list[str]:
    """Requirements of the program, those of its extras included."""
    text = (ROOT / "pyproject.toml").read_text(encoding="utf-8")
    lists = re.findall(r"(?ms)^(?:dependencies|video|cluster|usd|cad) = \[(.*?)\]$", text)
    return [line for part in lists for line in re.findall(r'(?m)"(.*?)"', re.sub(r"(?m)^\s*#.*$", "", part))]


def resolved(platform: str, version: str) -> tuple[dict[str, str], str]:
    """Versions of all wheels by name, or none and pip's sentence about what is missing."""
    command = [sys.executable, "-m", "pip", "install", "--dry-run", "--ignore-installed", "--quiet"]
    command += ["--only-binary=:all:", "--python-version", version, "--implementation", "cp"]
    for tag in PLATFORMS[platform]:
        command += ["--platform", tag]
    with tempfile.TemporaryDirectory() as folder:
        report = Path(folder) / "report.json"
        command += ["--target", str(Path(folder) / "target"), "--report", str(report)]
        done = subprocess.run([*command, *requirements()], capture_output=True, text=True, check=False)
        if done.returncode != 0:
            errors = [line for line in done.stderr.splitlines() if line.startswith("ERROR")]
            return {}, errors[-1] if errors else done.stderr[-300:]
        items = json.loads(report.read_text(encoding="utf-8"))["install"]
    return {item["metadata"]["name"].lower(): item["metadata"]["version"] for item in items}, ""


def main() -> int:
    """Print a table and return the number of combinations without wheels."""
    missing = 0
    for platform in sys.argv[1:] or PLATFORMS:
        for version in VERSIONS:
            wheels, error = resolved(platform, version)
            missing += not wheels
            names = "pyside6_essentials", "vtk", "numba", "scipy", "cholespy", "ipctk"
            shown = ", ".join(f"{name} {wheels[name]}" for name in names if name in wheels)
            print(f"{platform:15} {version:5} {len(wheels):3} wheels  {shown}{error}", flush=True)
    return missing


if __name__ == "__main__":
    sys.exit(main())
