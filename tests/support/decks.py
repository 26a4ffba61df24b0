"""FE decks and results of CalculiX, read without the program."""

import re
import shutil
import subprocess
from collections import defaultdict

import numpy as np
import pytest

needs_ccx = pytest.mark.skipif(
    shutil.which("ccx") is None, reason="CalculiX is missing: install calculix-ccx to compute decks"
)


def cards(text):
    """Keyword, parameters, and rows of words of each card of a deck, in order."""
    found = []
    for line in text.splitlines():
        if line.startswith("**") or not line.strip():
            continue
        words = [word.strip() for word in line.split(",")]
        if line.startswith("*"):
            given = dict(word.partition("=")[::2] for word in words[1:])
            found.append((words[0][1:].upper(), given, []))
        else:
            found[-1][2].append([word for word in words if word])
    return found


class ReadDeck:
    """Nodes, elements, sets, wall and displacements of a deck."""

    def __init__(self, text):
        self.text, self.nodes, self.elements, self.sets, self.steps = text, {}, {}, {}, []
        self.values, self.keywords = {}, []
        for keyword, given, rows in cards(text):
            self.keywords.append(keyword)
            if keyword == "NODE":
                self.nodes = {int(row[0]): tuple(map(float, row[1:])) for row in rows}
            elif keyword == "ELEMENT":
                assert given == {"TYPE": f"S{len(rows[0]) - 1}", "ELSET": "SURFACE"}
                self.elements = {int(row[0]): tuple(map(int, row[1:])) for row in rows}
            elif keyword in ("NSET", "ELSET"):
                self.sets[given[keyword]] = [int(word) for row in rows for word in row]
            elif keyword == "STEP":
                self.steps.append(defaultdict(dict))
            elif keyword == "BOUNDARY":
                for row in rows:
                    self._hold(*row)
            elif keyword in ("ELASTIC", "DENSITY", "SHELL SECTION"):
                self.values[keyword] = [float(word) for word in rows[0]]

    def _hold(self, who, first, last, value="0"):
        for node in self.sets.get(who) or [int(who)]:
            for axis in range(int(first), int(last) + 1):
                self.steps[-1][node][axis] = float(value)

    def ends(self, step=-1):
        """Positions of the held nodes at the end of a step."""
        assert all(sorted(along) == [1, 2, 3] for along in self.steps[step].values())
        return {
            node: np.array(self.nodes[node]) + [along[1], along[2], along[3]]
            for node, along in self.steps[step].items()
        }


def computed(path):
    """Run CalculiX on a deck; return rest and displaced positions of the nodes of its last result."""
    done = subprocess.run(
        ["ccx", path.stem], cwd=path.parent, capture_output=True, text=True, timeout=500, check=False
    )
    assert done.returncode == 0, done.stdout[-2000:]
    assert "*ERROR" not in done.stdout
    assert "Job finished" in done.stdout
    text = path.with_suffix(".frd").read_text()
    nodes = _rows(text[text.index("    2C") :])
    moved = _rows(text[text.rindex(" -4  DISP") :])
    return nodes, {node: nodes[node] + shift for node, shift in moved.items() if node in nodes}


def reactions(path, nodes):
    """Sums (s, 3) of the forces on some nodes of a computed deck, of each step."""
    blocks = path.with_suffix(".frd").read_text().split(" -4  FORC")[1:]
    return np.array([sum(forces[node] for node in nodes) for forces in map(_rows, blocks)])


def _rows(text):
    """Three numbers a node, of the first block of rows in a text."""
    found = {}
    for line in text.splitlines()[1:]:
        if line.startswith(" -1"):
            numbers = re.findall(r".{12}", line[13:49])
            found[int(line[3:13])] = np.array([float(number) for number in numbers])
        elif line.startswith(" -3"):
            break
    return found
