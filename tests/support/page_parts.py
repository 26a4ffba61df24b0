"""Takes a page of HTML apart, and says what is wrong with it."""

from html.parser import HTMLParser

VOID = {"meta", "img", "br", "link", "hr", "input"}
REFERS = {"src", "srcset", "href", "xlink:href", "action", "data", "poster"}


class PageParts(HTMLParser):
    """The tables by the heading over them, the links and pictures, and what is not well-formed.

    Attributes
    ----------
    rows : dict of str to dict of str to str
        Values and remarks of each row, parted by line breaks, by heading and name.
    notes : dict of str to list of str
    headings : list of str
    tags : list of str
    held : list of (str, str)
        Attribute and what it refers to, of whatever refers to something.
    wrong : list of str
    """

    def __init__(self, text):
        super().__init__()
        self.rows, self.notes, self.headings, self.tags, self.held, self.wrong = {}, {}, [], [], [], []
        self.title = ""
        self._open, self._row, self._text = [], None, ""
        self.feed(text)
        self.close()
        self.wrong += [f"<{tag}> is not closed" for tag in self._open]

    def handle_starttag(self, tag, attrs):
        self.tags.append(tag)
        names = [name for name, _ in attrs]
        if len(names) != len(set(names)):
            self.wrong.append(f"<{tag}> says something twice")
        self.held += [
            (name, value) for name, value in attrs if name in ("src", "href", "xlink:href", "action")
        ]
        self.wrong += [f"<{tag}> would run {name}" for name in names if name.startswith("on")]
        if tag not in VOID:
            self._open.append(tag)
        if tag == "tr":
            self._row = []
        if tag == "small" and self._row is not None:
            self._text += "\n"
        elif tag in ("th", "td", "h1", "h2", "p", "code"):
            self._text = ""

    def handle_startendtag(self, tag, attrs):
        self.handle_starttag(tag, attrs)
        if tag not in VOID:
            self.handle_endtag(tag)

    def handle_endtag(self, tag):
        if not self._open or self._open.pop() != tag:
            self.wrong.append(f"</{tag}> closes something else")
        if tag == "h1":
            self.title = self._text
        elif tag == "h2":
            self.headings.append(self._text)
        elif tag in ("th", "td") and self._row is not None:
            self._row.append(self._text)
        elif tag == "tr":
            name, *values = (text.replace(" \n", "\n") for text in self._row)
            self.rows.setdefault(self.headings[-1], {})[name] = "\n".join(values)
            self._row = None
        elif tag in ("p", "code") and self.headings:
            self.notes.setdefault(self.headings[-1], []).append(self._text)

    def handle_data(self, data):
        self._text += data
