"""What has been let go, and what has not."""

import gc


def living(kind: type) -> int:
    """Number of objects of a class that something still refers to."""
    gc.collect()
    return sum(issubclass(type(each), kind) for each in gc.get_objects())
