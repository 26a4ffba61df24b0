"""Record the answers of ``apd-viewer verify`` as the state of the release.

    python tests/benchmarks/verification_state.py [LETTER ...]

Run it before a release on a quiet machine, and look at the difference before it is committed: errors may
fall, and rise only with a reason.
"""

import json
import sys

from apd_viewer.verification.case_table import CASES
from apd_viewer.verification.verification_run import RECORD, recorded_rows, run_cases

_KEPT = ("exact", "ours", "error", "plain", "order", "seconds")


def main(letters):
    """Run the cases, and write their numbers."""
    state = dict(recorded_rows())
    for run in run_cases([CASES[letter] for letter in letters or CASES]):
        if run.measured:
            rows = [row._asdict() for row in run.rows]
            state[run.case.letter] = [{name: _rounded(row[name]) for name in _KEPT} for row in rows]
            for row in run.rows:
                print(
                    row.case, row.quantity, f"{row.error:.3e}", row.order, f"{row.seconds:.1f} s", row.passes
                )
    RECORD.write_text(json.dumps(dict(sorted(state.items())), indent=1) + "\n", encoding="utf-8")


def _rounded(value):
    return None if value is None else float(f"{value:.6g}")


if __name__ == "__main__":
    main(sys.argv[1:])
