"""Collect the texts of the program into the catalogues of translations, and compile these.

Run by ``make texts``; ``python .ci/texts.py fr`` starts a catalogue for another language.
"""

import io
import re
import sys
from pathlib import Path

from babel.messages.catalog import Catalog
from babel.messages.extract import extract_from_dir
from babel.messages.mofile import write_mo
from babel.messages.pofile import read_po, write_po

ROOT = Path(__file__).parents[1]
LANGUAGES = ROOT / "apd_viewer" / "languages"
KEYWORDS = {"tr": None, "trn": (1, 2), "trc": ((1, "c"), 2)}
# Babel takes the sign in "30 % of the way" for a field.
FIELD = re.compile(r"%(\(\w+\))?[rs]")


def template():
    """Catalogue of all texts, with the files that they are from."""
    found = Catalog(project="apd-viewer")
    for name, _, message, _, context in extract_from_dir(
        str(ROOT / "apd_viewer"), [("**.py", "python")], keywords=KEYWORDS
    ):
        found.add(message, locations=[(f"apd_viewer/{name}", 0)], context=context)
    return found


def updated(path, texts):
    """Catalogue in the file with these texts; what was translated stays, nothing is guessed."""
    language = path.parents[1].name
    catalogue = Catalog(locale=language)
    if path.exists():
        with path.open("rb") as stream:
            catalogue = read_po(stream, locale=language)
    catalogue.update(texts, no_fuzzy_matching=True, update_creation_date=False)
    for message in catalogue:
        if not FIELD.search(str(message.id)):
            message.flags.discard("python-format")
    return catalogue


def write(path, catalogue):
    """Write a catalogue, a text a line, and what the program reads."""
    path.parent.mkdir(parents=True, exist_ok=True)
    text, compiled = io.BytesIO(), io.BytesIO()
    write_po(text, catalogue, width=None, include_lineno=False, ignore_obsolete=True)
    write_mo(compiled, catalogue, use_fuzzy=True)
    path.write_bytes(text.getvalue())
    path.with_suffix(".mo").write_bytes(compiled.getvalue())


def main(names):
    """Update all catalogues, and begin those that are named."""
    texts = template()
    paths = {LANGUAGES / name / "LC_MESSAGES" / "apd_viewer.po" for name in names}
    for path in sorted(paths | set(LANGUAGES.glob("*/LC_MESSAGES/apd_viewer.po"))):
        catalogue = updated(path, texts)
        write(path, catalogue)
        messages = [message for message in catalogue if message.id]
        left = [
            m for m in messages if not all(m.string if isinstance(m.string, tuple | list) else [m.string])
        ]
        checked = [m for m in messages if m.fuzzy]
        print(
            f"{path.parents[1].name}: {len(messages):,} texts, {len(left):,} to translate, "
            f"{len(checked):,} to be checked by a reader of the language"
        )


if __name__ == "__main__":
    main(sys.argv[1:])
