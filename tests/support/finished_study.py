"""The folder of a finished study of any number of cases that nothing was computed for."""

import hashlib
import json

import numpy as np

from apd_viewer.cases.case_file import CaseResult, case_path, case_to_bytes
from apd_viewer.cases.database import opened_database
from apd_viewer.cases.results import READINGS

COLUMNS = ["session", "steps", "motion", "stiffness"]
_STEPS = 10


def write_study(folder, count, failed=0.01):
    """Write the database and the files of cases that twist and push; a share of them has failed."""
    chance = np.random.default_rng(0)
    (folder / "cases").mkdir(parents=True)
    base = opened_database(folder)
    base.execute("insert into facts values ('columns', ?)", (json.dumps(COLUMNS),))
    for k, (twist, push, stiffness, luck) in enumerate(chance.random((count, 4)).tolist()):
        said = {
            "motion": f"twist {180 * twist:.6g}deg; push {40 * push:.6g}%",
            "stiffness": 10 ** -(1 + 3 * stiffness),
        }
        key = hashlib.sha256(json.dumps(said).encode()).hexdigest()[:32]
        cells = ["session.apd", str(_STEPS), said["motion"], f"{said['stiffness']:.6g}"]
        base.execute("insert into plan values (?, ?, ?, '', null, ?)", (k, k + 2, key, json.dumps(cells)))
        result = _result(key, said, luck < failed, (1.0 + k) * twist, push)
        content = case_to_bytes(result)
        path = case_path(folder, key)
        path.parent.mkdir(exist_ok=True)
        path.write_bytes(content)
        row = key, len(content), result.status, result.sentence, 1.5, json.dumps(result.readings)
        base.execute("insert into cases values (?, ?, ?, ?, ?, ?)", row)
    base.commit()
    base.close()


def _result(key, said, fails, energy, push):
    if fails:
        return CaseResult(key, said, "failed", "It diverged in step 2.")
    readings = {name: push * (k + 1.0 / 3.0) for k, name in enumerate(READINGS)} | {"energy": energy}
    part = np.linspace(0.0, 1.0, _STEPS + 1)
    curves = {name: (push * part).tolist() for name in ("part", "volume_error", "area_error", "energy")}
    return CaseResult(
        key, said, "done", "", readings, {**curves, "part": part.tolist()}, {}, np.zeros((4, 3))
    )
