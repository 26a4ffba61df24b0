"""Compare the start of programs, to the first picture: ``compare_start.py COMMAND COMMAND ...`` on Linux.

They are started in turns on an X display of its own (Xvfb), watched until it shows a shaded surface.
"""

from __future__ import annotations

import os
import shlex
import statistics
import subprocess
import sys
import time

import numpy as np

TURNS = 5
_COLOURS = 1000  # a window without a mesh has some hundred
_LONGEST = 120.0  # s


def seconds(command: str, display: str) -> float:
    """Time from the start of a command to its picture."""
    environment = {**os.environ, "DISPLAY": display, "XDG_SESSION_TYPE": "x11"}
    environment.pop("WAYLAND_DISPLAY", None)
    begin = time.perf_counter()
    process = subprocess.Popen(shlex.split(command), env=environment, stderr=subprocess.DEVNULL)
    try:
        while time.perf_counter() - begin < _LONGEST:
            if colours(display) > _COLOURS:
                return time.perf_counter() - begin
        raise TimeoutError(command)
    finally:
        process.terminate()
        process.wait()
        time.sleep(1.0)  # its children end, and the display is empty


def colours(display: str) -> int:
    """Number of colours in every fourth row of the display."""
    picture = subprocess.check_output(["xwd", "-root", "-silent", "-display", display])
    width, height = map(int, np.frombuffer(picture, ">u4", 6)[4:])
    pixels = np.frombuffer(picture[-4 * width * height :], "<u4").reshape(height, width)
    return len(np.unique(pixels[::4]))


def main() -> None:
    """Print the times of each command, and the ratio of medians to that of the last."""
    commands = sys.argv[1:]
    server = subprocess.Popen(
        ["Xvfb", "-noreset", "-displayfd", "1", "-screen", "0", "1600x1000x24"],
        stdout=subprocess.PIPE,
        stderr=subprocess.DEVNULL,
        text=True,
    )
    assert server.stdout is not None
    display = f":{server.stdout.readline().strip()}"  # it is ready then
    try:
        for command in commands:
            seconds(command, display)
            time.sleep(15.0)  # what is compiled beside the window goes to the cache
        times = [[seconds(command, display) for command in commands] for _ in range(TURNS)]
    finally:
        server.terminate()
        server.wait()
    medians = [statistics.median(column) for column in zip(*times, strict=True)]
    for command, median, column in zip(commands, medians, zip(*times, strict=True), strict=True):
        each = " ".join(f"{time:.2f}" for time in sorted(column))
        print(f"{median:6.2f} s  {median / medians[-1]:.2f}  {command}  ({each})")


if __name__ == "__main__":
    main()
