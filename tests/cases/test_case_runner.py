"""The runner, by an engine that does what a test says: who is tried again, who is blamed, what ends it."""

from concurrent.futures import BrokenExecutor, CancelledError, Future

import pytest
from study_work import quick

from apd_viewer.cases.case_file import case_from_bytes
from apd_viewer.cases.case_runner import MOST_DEATHS, CaseRunner
from apd_viewer.cases.case_worker import CaseAnswer
from apd_viewer.errors import InputError


class KilledWorker(Exception):  # noqa: N818
    """As Dask calls it."""


class Pseudo:
    """An engine of two places; ``fate(task, alone)`` is an answer or what is raised."""

    def __init__(self, fate, exact=True, eager=True):
        self.can_blame_case, self.overdue = exact, set()
        self.fate, self.places, self.eager = fate, 2, eager
        self.open, self.tried = [], []

    def free_slot_count(self):
        return self.places - len(self.open)

    def running_count(self):
        return len(self.open)

    def start(self, task):
        future = Future()
        self.open.append((future, task))
        self.tried.append(task.case.steps)
        if self.eager and not self.free_slot_count():
            self.settle()
        return future

    def settle(self):
        """Decide on all that run, together."""
        together, self.open = self.open, []
        for future, task in together:
            found = self.fate(task, len(together) == 1)
            if isinstance(found, BaseException):
                future.set_exception(found)
            else:
                future.set_result(found)

    def supervise_workers(self):
        pass


@pytest.fixture
def cases(planned):
    """Cases of 1 to 5 steps, by their keys."""
    return planned(*({"steps": str(steps)} for steps in range(1, 6))).cases


def run(cases, engine, **options):
    found = []

    def tick(_):
        engine.settle()

    CaseRunner(
        cases, engine, lambda content: found.append(case_from_bytes(content)), on_tick=tick, **options
    ).run()
    assert sorted(result.key for result in found) == sorted(cases), "each case once"
    return {result.case["steps"]: result for result in found}


def test_case_runner_blames_a_case_after_several_deaths_of_its_own(cases):
    engine = Pseudo(lambda task, _: BrokenExecutor() if task.case.steps == 3 else quick(task))
    found = run(cases, engine)
    assert [found[k].status for k in range(1, 6)] == ["done", "done", "failed", "done", "done"]
    assert engine.tried.count(3) == MOST_DEATHS
    assert sorted(engine.tried) == [1, 2, *[3] * MOST_DEATHS, 4, 5]


def test_case_runner_forgives_a_death_by_others(cases):
    deaths = dict.fromkeys((1, 2, 3, 4, 5), MOST_DEATHS - 1)

    def fate(task, _):
        deaths[task.case.steps] -= 1
        return BrokenExecutor() if deaths[task.case.steps] >= 0 else quick(task)

    assert {result.status for result in run(cases, Pseudo(fate)).values()} == {"done"}


def test_case_runner_tries_suspects_alone_where_blame_is_shared(cases):
    """Case 2 kills its process; whoever is beside it is told of a death too."""
    beside = []

    def fate(task, alone):
        beside.append((task.case.steps, alone))
        bad = task.case.steps == 2 or (not alone and task.case.steps in (1, 3))
        return KilledWorker() if bad else quick(task)

    found = run(cases, Pseudo(fate, exact=False))
    assert [found[k].status for k in range(1, 6)] == ["done", "failed", "done", "done", "done"]
    assert beside.count((2, True)) == 1


def test_case_runner_lets_cases_whose_scheduler_is_lost_wait_for_the_next(cases):
    lost = {1, 2, 3}

    def fate(task, _):
        if task.case.steps in lost:
            lost.discard(task.case.steps)
            return CancelledError()
        return quick(task)

    assert {result.status for result in run(cases, Pseudo(fate)).values()} == {"done"}


def test_case_runner_sends_files_to_who_has_not_got_them(cases):
    def fate(task, _):
        digests = {source.digest for source in task.case.input_files}
        if task.case.steps != 4 or task.sent_inputs:
            assert not task.sent_inputs or set(task.sent_inputs) == digests
            return quick(task)
        return CaseAnswer(b"", tuple(digests))

    engine = Pseudo(fate)
    assert {result.status for result in run(cases, engine).values()} == {"done"}
    assert engine.tried.count(4) == 2


def test_case_runner_says_that_workers_are_without_the_program(cases):
    engine = Pseudo(lambda *_: ModuleNotFoundError("No", name="apd_viewer"))
    with pytest.raises(InputError, match="cannot load apd_viewer; install"):
        run(cases, engine)


def test_case_runner_says_in_a_sentence_that_time_ran_out_in_native_code(cases):
    engine = Pseudo(None)

    def fate(task, _):
        if task.case.steps == 5:
            engine.overdue.update(future for future, each in together if each is task)
            return BrokenExecutor()
        return quick(task)

    together = []
    settle = engine.settle

    def settled():
        together[:] = engine.open
        settle()

    engine.fate, engine.settle = fate, settled
    assert "longer than 7 s" in run(cases, engine, limit=7.0)[5].sentence
    assert engine.tried.count(5) == 1


def test_case_runner_finishes_what_runs_at_a_stop(cases):
    found = []
    engine = Pseudo(lambda task, _: quick(task), eager=False)

    def tick(_):
        runner.stop()
        engine.settle()

    runner = CaseRunner(cases, engine, lambda content: found.append(case_from_bytes(content)), on_tick=tick)
    runner.run()
    assert [result.case["steps"] for result in found] == [1, 2]
