"""Every motion of the table, as its texts say it: a new row is tested wherever these are."""

from apd_viewer.session.posing.motion import LINE, MOTIONS

EVERY = tuple(MOTIONS)
IN_WORDS = tuple(name for name, motion in MOTIONS.items() if motion.axis != LINE)


def in_words(name, amount=None):
    """The motion in words, by its example if no amount is given."""
    motion = MOTIONS[name]
    kind, axis, amount = motion.kind, motion.axis, amount or motion.kind.example
    if kind.has_all_axes:
        return f"{kind.word} {' '.join(amount if letter == axis else '0' for letter in 'XYZ')}"
    return " ".join(filter(None, [kind.word, amount, kind.preposition, axis.lower()]))
