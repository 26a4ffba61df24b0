"""Elements of a VTK XML file with their byte spans, for replacing parts of it."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass, field
from xml.parsers import expat

from apd_viewer.language import in_quotes, tr

_TAG = re.compile(rb"""<(?:[^<>"']|"[^"]*"|'[^']*')*>""")
_APPENDED = re.compile(rb"<AppendedData\b[^<>]{0,200}>\s{0,200}_")  # bounded, to keep the search fast
_NAMES_UTF16 = re.compile(rb"<\?xml\b[^>]{0,200}\bencoding\s*=\s*.UTF-(?:16|32)", re.IGNORECASE)
_MOST_DEEP = 100  # largest nesting depth; VTK writes 7 levels


@dataclass
class XmlElement:
    """XML element with its byte offsets in the file.

    Attributes
    ----------
    begin : int
        Of its first tag.
    inside : int
        End of its first tag.
    end : int
        Of its content.
    after : int
        End of its last tag.
    """

    name: str
    attributes: dict[str, str]
    begin: int
    inside: int
    end: int = 0
    after: int = 0
    children: list[XmlElement] = field(default_factory=list)

    def children_named(self, *names: str) -> list[XmlElement]:
        """Children with one of the given names."""
        return [child for child in self.children if child.name in names]

    def first_child(self, name: str) -> XmlElement | None:
        """First child named ``name``, or None."""
        return next((child for child in self.children if child.name == name), None)

    def walk(self) -> Iterator[XmlElement]:
        """Iterate over the element and all its descendants."""
        yield self
        for child in self.children:
            yield from child.walk()

    def text_span(self, content: bytes) -> tuple[int, int]:
        """Start and end of the element's text, before, between or after its children."""
        ends = [child.begin for child in self.children]
        starts = [self.inside, *(child.after for child in self.children)]
        for start, end in zip(starts, [*ends, self.end], strict=True):
            if content[start:end].strip():
                return start, end
        return self.inside, self.inside

    def int_attribute(self, name: str) -> int:
        """Integer value of an attribute; 0 if missing or negative."""
        try:
            return max(0, int(self.attributes.get(name, "0")))
        except ValueError:
            said = in_quotes(self.attributes[name][:40])
            raise ValueError(tr("{text} is not a whole number").format(text=said)) from None

    def attribute_span(self, content: bytes, name: str) -> tuple[int, int] | None:
        """Start and end of an attribute's value in the start tag; None if missing."""
        found = re.search(
            rb"\s%s\s*=\s*(?:\"([^\"]*)\"|'([^']*)')" % name.encode(), content[self.begin : self.inside]
        )
        if found is None:
            return None
        start, end = found.span(1 if found[1] is not None else 2)
        return self.begin + start, self.begin + end


def parse_elements(content: bytes) -> tuple[XmlElement, int | None]:
    """Root element of an XML file, and the start of its appended data.

    Raises
    ------
    ValueError
        If it is no XML, or declares entities.
    """
    appended = _APPENDED.search(content)
    text = content if appended is None else content[: appended.end() - 1]
    reader = _Reader(text)
    reader.read(appended is None)
    if reader.outermost is None:
        raise ValueError(tr("it is not XML"))
    return reader.outermost, None if appended is None else appended.end()


class _Reader:
    """Builder of elements from parser events."""

    def __init__(self, content: bytes) -> None:
        self._content = content
        self._open: list[XmlElement] = []
        self.outermost: XmlElement | None = None
        # The declared UTF-16 or UTF-32 is outdated: the content was decoded to UTF-8 before.
        self._parser = expat.ParserCreate("utf-8" if _NAMES_UTF16.match(content) else None)
        self._parser.StartElementHandler = self._start
        self._parser.EndElementHandler = self._end
        self._parser.StartDoctypeDeclHandler = self._refuse

    def read(self, whole: bool) -> None:
        """Parse the content; it may be incomplete if appended data follow."""
        try:
            self._parser.Parse(self._content, whole)
        except expat.ExpatError as error:
            raise ValueError(
                tr("line {line:,} of its XML is damaged").format(line=max(error.lineno, 1))
            ) from None
        except (UnicodeError, LookupError):
            raise ValueError(tr("the encoding of its XML is not supported")) from None
        for element in self._open:
            element.end = element.after = len(self._content)

    def _start(self, name: str, attributes: dict[str, str]) -> None:
        begin = self._parser.CurrentByteIndex
        tag = _TAG.match(self._content, begin)
        if tag is None or len(self._open) > _MOST_DEEP:
            raise ValueError(tr("its XML cannot be understood"))
        element = XmlElement(name, attributes, begin, tag.end())
        if self._open:
            self._open[-1].children.append(element)
        elif self.outermost is None:
            self.outermost = element
        self._open.append(element)

    def _end(self, _: str) -> None:
        element = self._open.pop()
        element.end = element.after = max(element.inside, self._parser.CurrentByteIndex)
        if self._content.startswith(b"</", element.end):  # <a/> has no end tag
            element.after = self._content.find(b">", element.end) + 1

    def _refuse(self, *_: object) -> None:
        raise ValueError(tr("it declares a document type, which VTK files do not have"))
