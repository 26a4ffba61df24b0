"""What a user lacks who has installed no extra of the package."""

import sys
from importlib.util import find_spec


def lack(monkeypatch, library):
    """Have a library missing; it is no double where nobody has installed it, as after ``make test``."""
    if find_spec(library) is not None:
        monkeypatch.setitem(sys.modules, library, None)
