"""The ``study`` and ``study design`` commands: run or write a plan of cases."""

import argparse
import os
import signal
import sys
from collections import Counter
from collections.abc import Iterator
from contextlib import contextmanager
from functools import partial
from pathlib import Path
from typing import Any

from apd_viewer.cases.case_file import FAILED
from apd_viewer.cases.case_runner import Engine
from apd_viewer.cases.cluster import connect_cluster
from apd_viewer.cases.design import DESIGNS, LATIN, DesignVariable, design_table, parse_variable
from apd_viewer.cases.local_pool import LocalPool, core_count
from apd_viewer.cases.plan import Plan, read_plan
from apd_viewer.cases.plan_columns import AUTO, CASE_COLUMNS, COLUMNS, NOTE_PREFIX, SETTING_COLUMNS
from apd_viewer.cases.results import ResultTable, status_text
from apd_viewer.cases.run_case import INPUTS_FOLDER
from apd_viewer.cases.study import Study
from apd_viewer.cases.study_case import InputFiles
from apd_viewer.cases.study_progress import CaseCounts, StudyForecast, study_forecast
from apd_viewer.commands.terminal.command_output import STANDARD_OUTPUT, CommandOutput
from apd_viewer.commands.terminal.parser import Parser, add_option
from apd_viewer.commands.terminal.progress import Progress
from apd_viewer.errors import InputError
from apd_viewer.files.mesh_writing import check_writable
from apd_viewer.files.tables import write_table
from apd_viewer.language import comma_separated, localize_numbers, tr, trn
from apd_viewer.presentation.number_format import format_grouped
from apd_viewer.presentation.time_left import duration_text
from apd_viewer.session.model.view import SESSION_SUFFIX

_INTERRUPTED = 130
_LOG = 30.0  # seconds between two lines of a log
_MOST_SAID = 20  # largest number of sentences printed; the results table has all of them
_FILES = ("mesh", "session", "selection")
_CONTACT = "contact"  # a column of every new plan; plans without it predate this setting


def study_parser() -> Parser:
    """Argument parser for the ``study`` command."""
    parser = Parser(
        prog="apd-viewer study",
        description=tr(
            "Run the cases of a plan, each along its motion in steps, as in “sweep”. The same command "
            "continues an interrupted study. “apd-viewer study design” writes plans."
        ),
        epilog=_columns(),
    )
    add_option(parser, "PLAN.csv", tr("table with one case per row; - is the standard input"), type=Path)
    add_option(parser, "-o, --output FOLDER", tr("folder of the results"), type=Path, required=True)
    engine = parser.add_mutually_exclusive_group()
    add_option(
        engine, "--processes, --workers N", tr("processes on this machine; default: one per core"), type=int
    )
    add_option(engine, "--scheduler ADDRESS", tr("address of a Dask scheduler, such as tcp://host:8786"))
    add_option(
        engine, "--scheduler-file F.json", tr("Dask scheduler, given by its scheduler file"), type=Path
    )
    add_option(parser, "--limit SECONDS", tr("time limit of a case"), type=float)
    add_option(parser, "--retry-failed", tr("run failed cases again"))
    add_option(parser, "--dry-run", tr("report the remaining work and time, and run nothing"))
    add_option(parser, "--progress-lines", tr("report progress as lines of JSON"))
    parser.set_defaults(run=_study)
    return parser


def _columns() -> str:
    words = [*CASE_COLUMNS.items(), *((name, column.description) for name, column in SETTING_COLUMNS.items())]
    text = "; ".join(f"{name} ({about})" for name, about in words)
    return tr("Columns of a plan, besides notes that begin with #: {columns}.").format(columns=text)


def _study(options: argparse.Namespace) -> CommandOutput:
    localize_numbers(False)  # sentences are stored in result files and must not depend on the number format
    if options.limit is not None and not options.limit > 0.0:
        raise InputError(tr("--limit must be greater than 0 seconds."))
    if options.processes is not None and not 1 <= options.processes <= 1000:
        raise InputError(tr("--processes must be 1 to 1000."))
    if options.dry_run:
        plan = read_plan(options.plan, InputFiles(options.output / INPUTS_FOLDER, keeps_copies=False))
        left = study_forecast(plan, options.output, options.retry_failed)
        print(mistake_lines(plan), end="", file=sys.stderr)
        return CommandOutput([work_left_lines(left, _processes(options))], left._asdict)
    study = Study(options.plan, options.output, options.retry_failed)
    try:
        print(mistake_lines(study.plan), end="", file=sys.stderr)
        return _run(study, options)
    finally:
        study.close()


def _run(study: Study, options: argparse.Namespace) -> CommandOutput:
    progress = Progress(options.progress_lines, _LOG)
    at_once = True
    engine: Engine | None = None

    def tell(counts: CaseCounts) -> None:
        progress.show(counts.fraction, counts_text(counts), **counts._asdict())

    try:
        if not study.unfinished_cases:
            table = study.finish()
        if study.unfinished_cases:
            engine = _engine(options)
            with _finish_on_interrupt(study):
                table = study.run(engine, options.limit, tell)
        at_once = False
    except KeyboardInterrupt:
        table = study.write_table()
    finally:
        progress.end()
        if engine is not None:
            engine.close(at_once)
    print(damaged_results_line(study.damaged_count), end="", file=sys.stderr)
    if study.unfinished_cases:
        print(tr("interrupted; repeat the command to continue"), file=sys.stderr)
    return CommandOutput(
        [study_summary(table, options.output)],
        partial(study_report, table, options.output),
        _INTERRUPTED if study.unfinished_cases else 0,
    )


def _engine(options: argparse.Namespace) -> Engine:
    if options.scheduler or options.scheduler_file:
        return connect_cluster(options.scheduler, options.scheduler_file)
    return LocalPool(_processes(options))


def _processes(options: argparse.Namespace) -> int:
    """Number of parallel processes; 1 with a Dask scheduler."""
    if options.scheduler or options.scheduler_file:
        return 1
    return int(options.processes or core_count())


@contextmanager
def _finish_on_interrupt(study: Study) -> Iterator[None]:
    """Finish running cases at the first Ctrl+C in this context, quit at the second."""

    def first(*_: Any) -> None:
        signal.signal(signal.SIGINT, signal.default_int_handler)
        study.stop()
        print(tr("\nfinishing the running cases; Ctrl+C again ends at once"), file=sys.stderr)

    before = signal.signal(signal.SIGINT, first)
    try:
        yield
    finally:
        signal.signal(signal.SIGINT, before)


def counts_text(counts: CaseCounts) -> str:
    """Short text on the progress of a study."""
    words = [tr("{done:,} of {cases:,}").format(done=counts.finished, cases=counts.cases)]
    words.append(tr("{running} running").format(running=counts.running))
    if counts.failed:
        words.append(tr("{failed} failed").format(failed=counts.failed))
    if counts.rate is not None and counts.seconds_left is not None:
        words.append(tr("{rate:.3g}/min").format(rate=60.0 * counts.rate))
        words.append(tr("{time} left").format(time=duration_text(counts.seconds_left)))
    return comma_separated(words)


def mistake_lines(plan: Plan) -> str:
    """One line for each invalid or repeated row of a plan."""
    lines = [_line_sentence(row.line, row.mistake) for row in plan.rows if row.mistake]
    return "".join(f"{line}\n" for line in _first_lines(lines))


def work_left_lines(work_left: StudyForecast, processes: int) -> str:
    """Terminal lines about the remaining work of a study."""
    lines = [
        trn(
            "{cases:,} case, {done:,} done, {left:,} to do",
            "{cases:,} cases, {done:,} of them done, {left:,} to do",
            work_left.cases,
        ).format(cases=work_left.cases, done=work_left.done, left=work_left.cases - work_left.done)
    ]
    if work_left.failed:
        lines.append(
            tr("failed so far: {failed:,}; --retry-failed tries again").format(failed=work_left.failed)
        )
    if work_left.wrong:
        text = trn(
            "{wrong:,} row is wrong and is left out",
            "{wrong:,} rows are wrong and are left out",
            work_left.wrong,
        )
        lines.append(text.format(wrong=work_left.wrong))
    if work_left.seconds is None:
        lines.append(tr("No case was timed yet, so the remaining time is unknown."))
    elif work_left.cases > work_left.done:
        lines.append(
            tr("about {time} by {processes} processes, as measured so far").format(
                time=duration_text(work_left.seconds / processes), processes=processes
            )
        )
    return "\n".join(lines)


def study_summary(table: ResultTable, folder: Path) -> str:
    """Terminal lines about the results of a study."""
    count = Counter(row.status for row in table.rows)
    words = comma_separated(
        f"{format_grouped(number, 0)} {status_text(status)}" for status, number in count.items()
    )
    lines = [tr("{folder}: {words}").format(folder=folder / "results.csv", words=words)]
    failed = [_line_sentence(row.line, row.sentence) for row in table.rows if row.status == FAILED]
    text = tr("lines {lines}: folds compete, with energies up to {percent:.3g} % apart by seed")
    folds = [
        text.format(lines=comma_separated(map(str, numbers)), percent=100.0 * spread)
        for numbers, spread in table.competing_folds.items()
    ]
    return "\n".join([*lines, *_first_lines(failed), *_first_lines(folds)])


def study_report(table: ResultTable, folder: Path) -> dict[str, Any]:
    """Fields of the JSON output on the results of a study."""
    failed = [row for row in table.rows if row.status == FAILED]
    folds = [{"lines": lines, "spread": spread} for lines, spread in table.competing_folds.items()]
    return {
        "results": str(folder / "results.csv"),
        "cases": Counter(row.status for row in table.rows),
        "failed": [{"line": row.line, "sentence": row.sentence} for row in failed],
        "competing_folds": folds,
    }


def damaged_results_line(count: int) -> str:
    """Line on the number of damaged results; empty if there are none."""
    text = trn(
        "{count:,} damaged result is computed again", "{count:,} damaged results are computed again", count
    )
    return text.format(count=count) + "\n" if count else ""


def _line_sentence(line: int, sentence: str) -> str:
    return tr("line {line}: {sentence}").format(line=line, sentence=sentence)


def _first_lines(lines: list[str]) -> list[str]:
    """First lines, and the number of omitted lines."""
    more = len(lines) - _MOST_SAID
    return lines if more <= 0 else [*lines[:_MOST_SAID], tr("... and {more:,} more").format(more=more)]


def design_parser() -> Parser:
    """Argument parser for the ``study design`` command."""
    parser = Parser(
        prog="apd-viewer study design",
        description=tr(
            "Write the plan of a study: a table with one case per row, for a spreadsheet or for “study”."
        ),
    )
    add_option(parser, "--mesh MESH", tr("meshes or sessions to try"), nargs="+", default=[])
    add_option(parser, "--selection SEL", tr("selection of base and handle"))
    add_option(
        parser, "--motion WORDS", tr("motion such as “twist {twist}; move 0 {way} 0”; names in braces vary")
    )
    about = tr(
        "a column, a name in the motion, or twist, push, bend or scale: “twist=0..180deg”, "
        "“push=0..40%%”, “stiffness=1e-4..0.1:log” (by factors), “method=arap,exact”"
    )
    add_option(parser, "--vary NAME=RANGE", about, action="append", default=[])
    about = tr("cell of all cases, such as steps=6")
    add_option(parser, "--set COLUMN=TEXT", about, action="append", default=[], dest="given")
    about = tr("number of cases, or of levels per range in a grid; default: %(default)s")
    add_option(parser, "--samples N", about, type=int, default=100)
    about = tr("Latin hypercube, Sobol sequence or all combinations; default: %(default)s")
    add_option(parser, "--method", about, choices=DESIGNS, default=LATIN)
    add_option(parser, "--seed N", tr("random seed; default: %(default)s"), type=int, default=0)
    about = tr("table to write; - is the standard output")
    add_option(parser, "-o, --output PLAN.csv", about, type=Path, required=True)
    parser.set_defaults(run=_design)
    return parser


def _design(options: argparse.Namespace) -> CommandOutput:
    check_writable(options.output)
    given = _constant_cells(options)
    vary = [parse_variable(text) for text in options.vary]
    if len(options.mesh) > 1:
        vary.insert(0, DesignVariable("mesh", tuple(options.mesh)))
    columns, rows = design_table(given, vary, options.method, options.samples, options.seed)
    folder = options.output.absolute().parent
    rows = [
        [
            _relative_path(cell, folder) if name in _FILES else cell
            for name, cell in zip(columns, row, strict=True)
        ]
        for row in rows
    ]
    write_table(options.output, columns, rows)
    said = tr("{path}: {count:,} cases").format(path=options.output, count=len(rows))
    lines = [] if options.output == Path(STANDARD_OUTPUT) else [said]  # nothing but the table is printed
    return CommandOutput(lines, lambda: {"plan": str(options.output), "cases": len(rows)})


def _constant_cells(options: argparse.Namespace) -> dict[str, str]:
    """Constant cells of all rows from the options; raises InputError."""
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
    named = {text.partition("=")[0].strip() for text in [*options.vary, *options.given]}
    if _CONTACT not in named:
        given[_CONTACT] = AUTO
    if not options.mesh and not named & {"mesh", "session"}:
        raise InputError(
            tr("There is no mesh; give --mesh with a mesh or a session ({suffix}).").format(
                suffix=SESSION_SUFFIX
            )
        )
    return given


def _relative_path(name: str, folder: Path) -> str:
    """Path of a file relative to the folder of the plan."""
    try:
        return Path(os.path.relpath(name, folder)).as_posix()
    except ValueError:  # the file is on another drive
        return str(Path(name).absolute())
