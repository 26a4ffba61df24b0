"""Translations of the visible text, and the number notation.

The language is fixed when the program starts, so that texts can be translated where they are defined. Numbers
follow the notation of the language in the window and in the commands that it runs. On the command line and in
scripts, with output for other programs, they keep the decimal point.
"""

import gettext
import os
import sys
from collections.abc import Iterable, Mapping
from functools import cache
from pathlib import Path

import platformdirs

from apd_viewer.notation import Notation, TranslatedText, use_notation

GETTEXT_DOMAIN = "apd_viewer"

_NAMES = "APD_VIEWER_LANGUAGE", "LANGUAGE", "LC_ALL", "LC_MESSAGES", "LANG"  # the first that is set counts
_MAC = Path("~/Library/Preferences/.GlobalPreferences.plist")
_NO_LANGUAGE = "C", "POSIX"


def language_file() -> Path:
    """File with the language chosen in the window.

    Separate from the other settings, since reading those needs Qt: the command line is translated, too.
    """
    return Path(platformdirs.user_config_dir("apd-viewer", appauthor=False)) / "language"


def choose_language(name: str) -> None:
    """Store the language for the next start; empty for the system language.

    Raises
    ------
    OSError
        If the file cannot be written.
    """
    path = language_file()
    if name:
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(name, encoding="ascii")
    else:
        path.unlink(missing_ok=True)


def chosen_language() -> str:
    """Language chosen by the user; empty for the system language."""
    try:
        path = language_file()
        return path.read_text(encoding="ascii").strip() if path.is_file() else ""  # a pipe would block
    except (OSError, ValueError):  # the file is unreadable or contains non-ASCII text
        return ""


def preferred_languages(environment: Mapping[str, str], chosen: str = "") -> list[str]:
    """Preferred languages such as ``de_DE``, best first, up to but excluding English.

    Parameters
    ----------
    environment : mapping of str to str
        The variables of the process. Where they say nothing the system is asked.
    chosen : str
        Chosen in the window; APD_VIEWER_LANGUAGE alone goes before it.
    """
    own, *others = _NAMES
    setting = environment.get(own) or chosen
    setting = setting or next((environment[name] for name in others if environment.get(name)), "")
    names: list[str] = []
    for name in setting.split(":") if setting else _system_languages():
        plain = name.partition(".")[0].replace("-", "_")
        language, *rest = plain.split("_")
        if language in _NO_LANGUAGE or language.lower() == "en":
            break  # the untranslated texts are English
        names += _spellings(plain, language, rest)
    return names


def _spellings(plain: str, language: str, rest: list[str]) -> list[str]:
    """Candidate names for the catalogue of a language."""
    names = [plain]
    if len(rest) > 1:  # macOS adds a script, as in zh_Hans_CN; catalogue names seldom do
        names.append(f"{language}_{rest[-1]}")
    # The zh_CN catalogue also serves Singapore and languages tagged with the simplified script.
    if language == "zh" and (rest in ([], ["SG"]) or "Hans" in rest) and "zh_CN" not in names:
        names.append("zh_CN")
    return names


def _system_languages() -> list[str]:
    """Languages set in Windows or macOS; empty on other systems."""
    try:
        if sys.platform == "win32":
            # Imported here: only Windows needs them, and they would delay every start.
            import ctypes
            import locale

            number = ctypes.windll.kernel32.GetUserDefaultUILanguage()
            return [locale.windows_locale[number]] if number in locale.windows_locale else []
        if sys.platform == "darwin":
            # Imported here: only macOS needs it.
            import plistlib

            with _MAC.expanduser().open("rb") as stream:
                return [str(name) for name in plistlib.load(stream).get("AppleLanguages", ())]
    except Exception:  # an unreadable system setting must not prevent a start: fall back to English
        return []
    return []


def catalogue(folder: Path, names: list[str]) -> tuple[str, gettext.NullTranslations]:
    """First available language and its catalogue; "en" and an empty one if none."""
    for name in names:
        # Looked up one at a time: given an empty list, gettext would read the environment instead.
        path = gettext.find(GETTEXT_DOMAIN, str(folder), [name])
        if path is not None:
            try:
                with Path(path).open("rb") as stream:
                    return Path(path).parents[1].name, gettext.GNUTranslations(stream)
            except Exception:  # gettext raises many kinds of exceptions for a truncated file
                print(f"{path} cannot be read; compile it again.", file=sys.stderr)  # noqa: T201
    return "en", gettext.NullTranslations()


CATALOGUE_FOLDER = Path(os.environ.get("APD_VIEWER_LANGUAGES") or Path(__file__).parent / "languages")
LANGUAGE, CATALOGUE = catalogue(CATALOGUE_FOLDER, preferred_languages(os.environ, chosen_language()))


def languages() -> list[str]:
    """Names of the available languages, English first."""
    found = sorted(
        path.parents[1].name for path in CATALOGUE_FOLDER.glob(f"*/LC_MESSAGES/{GETTEXT_DOMAIN}.mo")
    )
    return ["en", *found]


def translations(text: str) -> set[str]:
    """Translations of an English text into all available languages."""
    return {each.gettext(text) for each in _catalogues()}


@cache
def _catalogues() -> list[gettext.NullTranslations]:
    return [catalogue(CATALOGUE_FOLDER, [name])[1] for name in languages()]


_SHOWS_NUMBERS = "APD_VIEWER_NUMBERS"  # inherited by the window's child processes


def tr(text: str) -> str:
    """Translate an English ``text``; unchanged without a translation.

    Values are inserted afterwards: ``tr("{name} has no area.").format(name=...)``.
    """
    return TranslatedText(CATALOGUE.gettext(text))


def trn(one: str, many: str, n: int) -> str:
    """Translate the plural form for a number.

    The number is inserted like other values: ``trn("{n:,} face", "{n:,} faces", n).format(n=n)``.
    """
    # gettext returns an empty text for a plural form that is not translated yet.
    return TranslatedText(CATALOGUE.ngettext(one, many, n) or (one if n == 1 else many))


def trc(context: str, text: str) -> str:
    """Translate ``text`` in a context, such as "Back" as a view or as a button."""
    return TranslatedText(CATALOGUE.pgettext(context, text))


def in_quotes(text: str) -> str:
    """Text in the quotation marks of the language."""
    return trc("quotation marks", "“{text}”").format(text=text)


def comma_separated(texts: Iterable[str]) -> str:
    """Texts joined by the list separator of the language."""
    return trc("between two of several", ", ").join(texts)


def alternatives(texts: Iterable[str]) -> str:
    """Texts joined by "or" in the language."""
    *several, last = texts
    return tr("{several} or {last}").format(several=comma_separated(several), last=last)


def localize_numbers(localized: bool = True) -> None:
    """Use the number notation of the language, or the one for machine reading.

    Processes started from now on inherit the choice.
    """
    os.environ[_SHOWS_NUMBERS] = "1" if localized else ""
    use_notation(_notation(localized))


def _notation(localized: bool) -> Notation:
    own = Notation.from_example(trc("the number 1234.5", "1,234.5"))
    # Readers used to a decimal comma would take commas between groups of digits for decimal signs.
    return own if localized or own.point == "." else Notation(".", "")


use_notation(_notation(bool(os.environ.get(_SHOWS_NUMBERS))))
