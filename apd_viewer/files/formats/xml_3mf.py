"""XML of a 3MF part, element by element."""

from __future__ import annotations

from typing import TYPE_CHECKING
from xml.parsers import expat

from apd_viewer.language import tr

if TYPE_CHECKING:
    from collections.abc import Callable


def read_xml(
    content: bytes,
    on_element: Callable[[str, dict[str, str]], None],
    on_namespace: Callable[[str | None, str | None], None] | None = None,
) -> None:
    """Call ``on_element(name, attributes)`` for each; names are "namespace name".

    Raises
    ------
    ValueError
        If it is damaged, or declares entities.
    """
    parser = expat.ParserCreate(namespace_separator=" ")
    parser.StartElementHandler = on_element
    parser.StartNamespaceDeclHandler = on_namespace
    parser.StartDoctypeDeclHandler = _refuse_entities
    try:
        parser.Parse(content, True)
    except expat.ExpatError as error:
        raise ValueError(
            tr("its XML is damaged at line {line:,}, column {column:,}").format(
                line=error.lineno, column=error.offset + 1
            )
        ) from None


def _refuse_entities(*_: object) -> None:
    raise ValueError(tr("a part of it declares XML entities, which 3MF does not allow"))
