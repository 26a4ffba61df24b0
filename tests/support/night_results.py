"""What the tests of a night found, read from the XML that pytest writes where asked (``--junit-xml``)."""

import re
from collections import Counter
from dataclasses import dataclass
from xml.etree import ElementTree

SLOWEST = 20


@dataclass(frozen=True)
class Case:
    """Test with its outcome, the reason if it was skipped, its seconds, and pairs of what it measured."""

    name: str
    outcome: str
    reason: str
    seconds: float
    figures: list


@dataclass(frozen=True)
class Results:
    """Tests of a night, each once."""

    cases: list

    def counts(self):
        """Numbers of tests by outcome; zero is told, too."""
        return {"passed": 0, "failed": 0, "skipped": 0} | Counter(case.outcome for case in self.cases)

    def failed(self):
        return [case.name for case in self.cases if case.outcome == "failed"]

    def skips(self):
        """Reasons, with the file and the number of tests."""
        skipped = [case for case in self.cases if case.outcome == "skipped"]
        return Counter((case.reason, case.name.partition("::")[0]) for case in skipped)

    def figures(self):
        """Names and values of what was measured, and by which test."""
        return [(*figure, case.name) for case in self.cases for figure in case.figures]

    def slowest(self):
        return sorted(self.cases, key=lambda case: -case.seconds)[:SLOWEST]


def results_in(folder):
    """Results in all files of a folder; a test that cannot be cleared up is told of twice."""
    told = {}
    for file in sorted(folder.glob("*.xml")):
        for element in ElementTree.parse(file).iter("testcase"):
            case = _case(element)
            if case.name not in told or case.outcome == "failed":
                told[case.name] = case
    return Results(sorted(told.values(), key=lambda case: case.name))


def _case(element):
    outcome, reason = _outcome(element)
    return Case(
        f"{element.get('file', '')}::{element.get('name', '')}",
        outcome,
        reason,
        float(element.get("time")),
        [(each.get("name"), each.get("value")) for each in element.iter("property")],
    )


def _outcome(element):
    """Outcome of a test, and the reason why it was skipped."""
    skipped = element.find("skipped")
    if element.find("failure") is not None or element.find("error") is not None:
        return "failed", ""
    if skipped is None:
        return "passed", ""
    if skipped.get("type") == "pytest.xfail":
        return "failed as expected", ""
    whole_file = re.search(r"Skipped: (.*)['\"]\)$", skipped.text or "")
    return "skipped", whole_file[1] if whole_file else skipped.get("message")
