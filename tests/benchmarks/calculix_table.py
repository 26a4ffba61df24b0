"""Print the loads of pushed walls by CalculiX and by the method Wall as the manual has them.

    python tests/benchmarks/calculix_table.py [plate] [tube] [dome] [bottle]

Some 3 minutes of a core.
"""

import os
import sys
import tempfile
from pathlib import Path

os.environ.setdefault("OMP_NUM_THREADS", "1")

sys.path.insert(0, str(Path(__file__).parents[1] / "support"))
from calculix_cases import CASES


def main(titles):
    """Print a row a deflection of the named cases, or of all."""
    for title in titles or CASES:
        with tempfile.TemporaryDirectory() as folder:
            case = CASES[title]
            for row in case.rows(case.loads(Path(folder))):
                print(row, flush=True)


if __name__ == "__main__":
    main(sys.argv[1:])
