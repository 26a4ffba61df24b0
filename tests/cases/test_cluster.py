"""A real scheduler of Dask and two workers over TCP: the same bits, deaths, files that travel."""

from dataclasses import replace
from pathlib import Path

import pytest
import study_work
from dask_cluster import dask_cluster

from apd_viewer.cases.case_file import read_case
from apd_viewer.cases.case_worker import run_task
from apd_viewer.cases.cluster import Cluster, connect_cluster
from apd_viewer.cases.run_case import CaseDocuments, run_case
from apd_viewer.cases.study import Study
from apd_viewer.errors import InputError

# A file descriptor that Dask closes late is no fault of ours.
pytestmark = [
    pytest.mark.extra,
    pytest.mark.filterwarnings("ignore::ResourceWarning:distributed"),
    pytest.mark.filterwarnings("ignore::pytest.PytestUnraisableExceptionWarning"),
]


@pytest.fixture(scope="module")
def scheduler(tmp_path_factory):
    """The file of a scheduler that was started by hand, with two workers, without any setting."""
    with dask_cluster(tmp_path_factory.mktemp("dask"), 2) as file:
        yield file


@pytest.fixture
def run(scheduler, written, bar):
    """Run a study of rows by its workers; return its table."""

    def study(rows, work=run_task, told=lambda _: None):
        engine = connect_cluster(None, scheduler, work)
        study = Study(written(*rows), bar / "out")
        try:
            return study.run(engine, on_progress=told)
        finally:
            study.close()
            engine.close(at_once=False)

    return study


def test_cluster_gives_the_bits_of_this_process_though_workers_see_no_files(run, planned, bar, monkeypatch):
    rows = [{"motion": f"twist {angle}deg; push 10%", "iterations": "20"} for angle in (50, 100, 200)]
    cases = planned(*rows).cases
    meshes = CaseDocuments(lambda source: source.path.read_bytes())
    here = [run_case(case, meshes) for case in cases.values()]
    sent = []

    def elsewhere(source):
        return replace(source, path=Path("/nowhere") / source.path.name)

    def start(self, task, start=Cluster.start):
        """Start it on workers of other machines, in effect."""
        sent.append(sum(map(len, task.sent_inputs.values())))
        case = task.case
        hidden = replace(case, mesh=elsewhere(case.mesh), selection=elsewhere(case.selection))
        return start(self, task._replace(case=hidden))

    monkeypatch.setattr(Cluster, "start", start)
    for row, mine in zip(run(rows).rows, here, strict=True):
        there = read_case(bar / "out", row.key, with_shape=True)
        assert there.status == "done"
        assert mine.curves == there.curves
        assert mine.U.tobytes() == there.U.tobytes()
    assert any(sent)
    before = len(sent)
    run([{"motion": f"twist {angle}deg", "iterations": "2"} for angle in range(1, 9)])
    assert sum(map(bool, sent[before:])) <= 1, "a mesh travels once a worker"


def test_cluster_has_dask_keep_no_profile_of_a_worker_that_has_a_case(run, scheduler):
    import distributed

    assert run([{"steps": str(steps)} for steps in (1, 2, 3, 4)]).rows

    def profiled(dask_worker):
        names = "profile", "profile-cycle"
        return [name for name in names if dask_worker.periodic_callbacks[name].is_running()]

    with distributed.Client(scheduler_file=str(scheduler), timeout=20) as client:
        assert list(client.run(profiled).values()) == [[], []]


def test_cluster_loses_no_case_by_a_worker_that_dies(run):
    rows = [{"steps": str(steps)} for steps in (3, 7, 5, 9)]
    assert [row.status for row in run(rows, study_work.deadly).rows] == ["done"] * 4


def test_cluster_names_a_case_that_kills_every_worker(run):
    table = run([{"steps": "13"}, {"steps": "3"}, {"steps": "5"}], study_work.deadly)
    assert [row.status for row in table.rows] == ["failed", "done", "done"]
    assert "died at every attempt" in table.rows[0].sentence


def test_connect_cluster_says_that_there_is_no_scheduler(monkeypatch):
    monkeypatch.setattr("apd_viewer.cases.cluster.ANSWER_SECONDS", 1)
    with pytest.raises(InputError, match=r"No scheduler answers at tcp://127\.0\.0\.1:9"):
        connect_cluster("tcp://127.0.0.1:9", None)
