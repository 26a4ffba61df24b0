"""Study designs: samples of ranges and choices as the rows of a plan."""

import itertools
import math
import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from apd_viewer.cases.plan import parse_cell
from apd_viewer.cases.plan_columns import COLUMNS, COUNT_COLUMNS, NOTE_PREFIX
from apd_viewer.errors import InputError
from apd_viewer.language import tr
from apd_viewer.session.posing.motion import MOTION_KINDS

LATIN, SOBOL, GRID = "lhs", "sobol", "grid"
DESIGNS = (LATIN, SOBOL, GRID)
MOST_SAMPLES = 1_000_000
_NUMBER = r"[+-]?(?:\d+(?:\.\d*)?|\.\d+)(?:[eE][+-]?\d+)?"
_RANGE = re.compile(
    rf"\s*(?P<low>{_NUMBER})\s*\.\.\s*(?P<high>{_NUMBER})\s*(?P<unit>[a-zA-Z%]*)\s*(?::\s*(?P<scale>log))?\s*"
)
_AMOUNT = re.compile(rf"{_NUMBER}\s*(?P<unit>[a-zA-Z%]*)")
_DIGITS = 6  # significant digits of a sampled number
_ONE_NUMBER = tuple(word for word, kind in MOTION_KINDS.items() if kind.takes_single_amount)


@dataclass(frozen=True)
class DesignVariable:
    """Quantity varied by a study.

    Attributes
    ----------
    name : str
        A column, a name in braces in the motion, or a motion that needs one number.
    choices : tuple of str
        Texts to choose from; empty for a range.
    low, high : float
        Ends of a range.
    unit : str
        Written behind each number of it.
    is_logarithmic : bool
        Whether the range is divided into equal factors instead of equal differences.
    """

    name: str
    choices: tuple[str, ...] = ()
    low: float = 0.0
    high: float = 0.0
    unit: str = ""
    is_logarithmic: bool = False

    @property
    def has_integers(self) -> bool:
        """True for a range of integers, such as numbers of steps."""
        return self.name in COUNT_COLUMNS and self.low.is_integer() and self.high.is_integer()

    @property
    def ends(self) -> tuple[str, ...]:
        """All choices, or both ends of the range as texts."""
        return self.choices or (self.text_at(0.0), self.text_at(1.0))

    def text_at(self, fraction: float) -> str:
        """Text at a fraction, 0 to 1, of the range or of the list of choices."""
        if self.choices:
            return self.choices[min(int(fraction * len(self.choices)), len(self.choices) - 1)]
        if self.is_logarithmic:
            value = self.low * (self.high / self.low) ** fraction
        else:
            value = self.low + (self.high - self.low) * fraction
        if self.has_integers:
            value = round(value)
        return f"{float(f'{value:.{_DIGITS}g}'):.{_DIGITS}g}{self.unit}"

    def without_unit(self, text: str) -> str:
        """Text of a value without its unit."""
        return text.removesuffix(self.unit).rstrip()

    def levels(self, count: int) -> list[str]:
        """All choices, or ``count`` evenly spaced values; fewer if rounding merges some."""
        if self.choices:
            return list(self.choices)
        fractions = np.linspace(0.0, 1.0, count) if count > 1 else [0.5]
        return list(dict.fromkeys(self.text_at(fraction) for fraction in fractions))


def parse_variable(text: str) -> DesignVariable:
    """Parse ``NAME=LOW..HIGH``, ``NAME=LOW..HIGH:log`` or ``NAME=A,B,C``.

    Raises
    ------
    InputError
        If it is none of these.
    """
    name, equals, said = (part.strip() for part in text.partition("="))
    if not equals or not name or not said:
        raise InputError(
            tr(
                "“{text}” varies nothing; give a range such as twist=0..180deg, or choices such as "
                "method=arap,exact."
            ).format(text=text)
        )
    found = _RANGE.fullmatch(said)
    if found is None:
        choices = tuple(each.strip() for each in said.split(",") if each.strip())
        return DesignVariable(name, choices, unit=_unit(choices))
    low, high = float(found["low"]), float(found["high"])
    if not low < high:
        raise InputError(tr("The range of {name} ends before it begins; swap its ends.").format(name=name))
    if found["scale"] and not low > 0.0:
        raise InputError(
            tr("A logarithmic range needs ends above 0; change that of {name}.").format(name=name)
        )
    return DesignVariable(name, (), low, high, found["unit"], bool(found["scale"]))


def _unit(choices: Sequence[str]) -> str:
    """Unit common to all choices; empty if there is none."""
    found = [_AMOUNT.fullmatch(each) for each in choices]
    units = {each["unit"] if each else "" for each in found}
    return units.pop() if len(units) == 1 else ""


def design_table(
    constants: dict[str, str], variables: Sequence[DesignVariable], design: str, samples: int, seed: int
) -> tuple[list[str], list[list[str]]]:
    """Columns and rows of a plan.

    Note columns repeat the numbers in motions and before units, for plotting the results.

    Parameters
    ----------
    constants : dict
        Cells that are the same in all rows, by column.
    design : str
        LATIN, SOBOL (of as many as the next power of 2 is best), or GRID: all combinations.
    samples : int
        Rows; of a grid, levels of each range.

    Raises
    ------
    InputError
        If a name stands for nothing, a column cannot say such a thing, or there are too many rows.
    """
    _check(constants, variables)
    own = [each for each in variables if each.name in COLUMNS]
    names = [*constants, *(each.name for each in own)]
    names += [] if "motion" in names or len(own) == len(variables) else ["motion"]
    noted = [each for each in variables if each.name not in COLUMNS or each.unit]
    rows = []
    for texts in _combinations(variables, design, samples, seed):
        said = dict(zip((each.name for each in variables), texts, strict=True))
        cells = {**constants, **{each.name: said[each.name] for each in own}}
        if len(own) < len(variables):
            cells["motion"] = _motion(
                cells.get("motion", ""), {k: v for k, v in said.items() if k not in COLUMNS}
            )
        notes = [each.without_unit(said[each.name]) for each in noted]
        rows.append([*(cells[name] for name in names), *notes])
    return [*names, *(NOTE_PREFIX + each.name for each in noted)], rows


def _motion(template: str, said: dict[str, str]) -> str:
    """Motion with its placeholders filled in and the sampled motions appended."""
    words = [name for name in said if name in _ONE_NUMBER and f"{{{name}}}" not in template]
    behind = [f"{name} {said[name]}" for name in words]
    for name, text in said.items():
        template = template.replace(f"{{{name}}}", text)
    return "; ".join(filter(None, [template, *behind]))


def _check(constants: dict[str, str], variables: Sequence[DesignVariable]) -> None:
    """Raise InputError for unknown or repeated names and invalid cells."""
    names, motion = [each.name for each in variables], constants.get("motion", "")
    if not names:
        raise InputError(tr("Nothing varies; give --vary, such as --vary twist=0..180deg."))
    for name in names:
        if (
            names.count(name) > 1
            or NOTE_PREFIX + name in constants
            or (name in COLUMNS and name in constants)
        ):
            raise InputError(tr("“{name}” is given twice; omit one.").format(name=name))
        if name not in COLUMNS and f"{{{name}}}" not in motion and name not in _ONE_NUMBER:
            raise InputError(
                tr("“{name}” is not a column, {{{name}}} in the motion or one of {words}.").format(
                    name=name, words=", ".join(_ONE_NUMBER)
                )
            )
    for name, text in [*constants.items(), *((each.name, end) for each in variables for end in each.ends)]:
        if name in COLUMNS and text:
            parse_cell(name, text)


def _combinations(
    variables: Sequence[DesignVariable], design: str, samples: int, seed: int
) -> Iterator[tuple[str, ...]]:
    if samples < 1 or samples > MOST_SAMPLES:
        raise InputError(tr("A plan has 1 to {most:,} rows; enter another number.").format(most=MOST_SAMPLES))
    if design == GRID:
        levels = [each.levels(samples) for each in variables]
        if math.prod(map(len, levels)) > MOST_SAMPLES:
            raise InputError(
                tr("That makes {count:,} rows, but the limit is {most:,}; vary less.").format(
                    count=math.prod(map(len, levels)), most=MOST_SAMPLES
                )
            )
        yield from itertools.product(*levels)
        return
    for fractions in _unit_samples(len(variables), design, samples, seed):
        yield tuple(
            each.text_at(float(fraction)) for each, fraction in zip(variables, fractions, strict=True)
        )


def _unit_samples(count: int, design: str, samples: int, seed: int) -> np.ndarray:
    """Sample points in the unit cube, (samples, count)."""
    # Imported here: scipy.stats is slow to import, and few plans are designed.
    from scipy.stats import qmc

    if design == SOBOL:
        # Sobol sequences are balanced only at powers of 2: draw the next one, and keep the first points.
        points = qmc.Sobol(count, rng=seed).random_base2(math.ceil(math.log2(samples)))[:samples]
    else:
        points = qmc.LatinHypercube(count, rng=seed).random(samples)
    return np.asarray(points)
