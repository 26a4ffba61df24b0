"""Kind of installation: by pip, or a program of its own."""

import sys


def is_packaged() -> bool:
    """True in the self-contained program of an installer, with neither Python nor pip."""
    return getattr(sys, "frozen", False)
