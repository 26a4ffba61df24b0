"""Declaration of the fields in the key of the solver's factorization.

A factorization that is kept although it depends on what has changed gives a wrong shape without a word. So
each field of a document and of a handle declares it in its metadata, and the key is made of the declarations.
"""

from __future__ import annotations

from dataclasses import fields
from types import MappingProxyType

FACTORED = MappingProxyType({"factored": True})
NOT_FACTORED = MappingProxyType({"factored": False})


def factored_fields(cls: type) -> tuple[str, ...]:
    """Names of the FACTORED fields; raises TypeError for a field without declaration."""
    undeclared = [each.name for each in fields(cls) if "factored" not in each.metadata]
    if undeclared:
        raise TypeError(f"{cls.__name__}.{undeclared[0]} is neither FACTORED nor NOT_FACTORED")
    return tuple(each.name for each in fields(cls) if each.metadata["factored"])
