"""Work for the workers of a study that is no deformation; importable in their processes."""

import os
import signal
import time
from pathlib import Path

import numpy as np

from apd_viewer.cases.case_file import CaseResult, case_to_bytes
from apd_viewer.cases.case_worker import CaseAnswer
from apd_viewer.cases.run_case import CaseDocuments, run_case


def answer(task, **readings):
    """The answer to a case with such readings, and a small shape."""
    U = np.full((4, 3), float(task.case.steps))
    return CaseAnswer(
        case_to_bytes(CaseResult(task.case.key, task.case.to_json, "done", "", readings, {}, {}, U))
    )


def quick(task):
    """Answer at once with the process that does it."""
    return answer(task, process=os.getpid(), seconds=0.5)


def computed(task):
    """Answer with what a worker would compute."""
    meshes = CaseDocuments(lambda source: source.path.read_bytes())
    return CaseAnswer(case_to_bytes(run_case(task.case, meshes, task.time_limit)))


def deadly(task):
    """Die of cases of 13 steps; of those of 7 steps only the first time."""
    once = Path(os.environ["DEADLY_ONCE"])
    if task.case.steps == 13:
        os.abort()
    if task.case.steps == 7 and not once.exists():
        once.touch()
        os.kill(os.getpid(), signal.SIGKILL)
    return answer(task, process=os.getpid())


def stuck(task):
    """Never end a case of 13 steps; say by a file that it is held."""
    while task.case.steps == 13:
        Path(os.environ["STUCK"]).touch()
        time.sleep(0.05)
    return answer(task)
