"""The command ``apd-viewer study design``: plans by samples of ranges."""

from __future__ import annotations

import argparse
import os
from pathlib import Path

from apd_viewer.cases.design import DESIGNS, LATIN, DesignVariable, design_table, parse_variable
from apd_viewer.cases.plan_columns import AUTO, COLUMNS, NOTE_PREFIX
from apd_viewer.commands.terminal.parser import Parser
from apd_viewer.errors import InputError
from apd_viewer.files.mesh_writing import check_writable
from apd_viewer.files.tables import write_table
from apd_viewer.language import tr
from apd_viewer.session.model.view import SESSION_SUFFIX

_FILES = ("mesh", "session", "selection")
_CONTACT = "contact"  # written in every new plan, since plans without it are from a time when there was none


def design_parser() -> Parser:
    """Parser of the command."""
    parser = Parser(
        prog="apd-viewer study design",
        description=tr(
            "Write the plan of a study: a table with a case a row, for a spreadsheet or for “study”."
        ),
    )
    parser.add_argument("--mesh", metavar="MESH", nargs="+", default=[], help=tr("meshes or sessions to try"))
    parser.add_argument("--selection", metavar="SEL", help=tr("what of a mesh is base and handle"))
    parser.add_argument(
        "--motion",
        metavar="WORDS",
        help=tr("such as “twist {twist}; move 0 {way} 0”: what is in braces varies"),
    )
    parser.add_argument(
        "--vary",
        metavar="NAME=RANGE",
        action="append",
        default=[],
        help=tr(
            "a column, a name in the motion, or twist, push, bend or scale: “twist=0..180deg”, "
            "“push=0..40%%”, “stiffness=1e-4..0.1:log” (by factors), “method=arap,exact”"
        ),
    )
    parser.add_argument(
        "--set",
        metavar="COLUMN=TEXT",
        action="append",
        default=[],
        dest="given",
        help=tr("the same in all cases, such as steps=6"),
    )
    parser.add_argument(
        "--samples",
        metavar="N",
        type=int,
        default=100,
        help=tr("cases, or of a grid levels of a range; default: %(default)s"),
    )
    parser.add_argument(
        "--method",
        choices=DESIGNS,
        default=LATIN,
        help=tr("Latin hypercube, Sobol sequence or all combinations; default: %(default)s"),
    )
    parser.add_argument(
        "--seed", metavar="N", type=int, default=0, help=tr("of the samples; default: %(default)s")
    )
    parser.add_argument(
        "-o", "--output", metavar="PLAN.csv", type=Path, required=True, help=tr("table to write")
    )
    parser.set_defaults(run=_design)
    return parser


def _design(options: argparse.Namespace) -> None:
    check_writable(options.output)
    given = _given(options)
    vary = [parse_variable(text) for text in options.vary]
    if len(options.mesh) > 1:
        vary.insert(0, DesignVariable("mesh", tuple(options.mesh)))
    columns, rows = design_table(given, vary, options.method, options.samples, options.seed)
    folder = options.output.absolute().parent
    rows = [
        [_found(cell, folder) if name in _FILES else cell for name, cell in zip(columns, row, strict=True)]
        for row in rows
    ]
    write_table(options.output, columns, rows)
    print(tr("{path}: {count:,} cases").format(path=options.output, count=len(rows)))


def _given(options: argparse.Namespace) -> dict[str, str]:
    """Cells common to all rows; raises InputError."""
    given = {"mesh": options.mesh[0]} if len(options.mesh) == 1 else {}
    given |= {name: getattr(options, name) for name in ("selection", "motion") if getattr(options, name)}
    for text in options.given:
        name, equals, said = (part.strip() for part in text.partition("="))
        if not equals or (name not in COLUMNS and not name.startswith(NOTE_PREFIX)):
            raise InputError(
                tr(
                    "--set {text}: give a column and its text, such as steps=6; columns are {columns}."
                ).format(text=text, columns=", ".join(COLUMNS))
            )
        if name in given:
            raise InputError(tr("“{name}” is given twice; omit one.").format(name=name))
        given[name] = said
    if not any(text.partition("=")[0].strip() == _CONTACT for text in [*options.vary, *options.given]):
        given[_CONTACT] = AUTO
    if (
        "mesh" not in given
        and len(options.mesh) < 2
        and not any(
            text.partition("=")[0].strip() in ("mesh", "session") for text in [*options.vary, *options.given]
        )
    ):
        raise InputError(
            tr("There is no mesh; give --mesh with a mesh or a session ({suffix}).").format(
                suffix=SESSION_SUFFIX
            )
        )
    return given


def _found(name: str, folder: Path) -> str:
    """Path of a file relative to the folder of the plan."""
    try:
        return Path(os.path.relpath(name, folder)).as_posix()
    except ValueError:  # on another drive
        return str(Path(name).absolute())
