"""Readers under contents guided by coverage, and then hostile meshes to libraries; run by ``make fuzz``.

    python tests/support/guided_fuzz.py [minutes] [target ...]
    python tests/support/guided_fuzz.py --one TARGET FILE

libFuzzer changes valid contents, and keeps those that reach something new in build/fuzz/corpus, from which
the next run goes on. Whatever is raised must be the reader's declared error, within 5 s and little memory.
Else the content is kept in build/fuzz/found, and the run fails with the line that repeats it.

Lines are counted afterwards by coverage.py, in another process that reads the whole corpus: those inside
functions, of the modules of each reader.
"""

import hashlib
import json
import os
import random
import subprocess
import sys
import time
import traceback
from pathlib import Path

ROOT = Path(__file__).parents[2]
BUILD = ROOT / "build" / "fuzz"
CORPUS, FOUND = BUILD / "corpus", BUILD / "found"
SECONDS = 5.0  # of the processor for a reading
LONGEST = 1 << 20  # bytes of a file
MEMORY = 2 << 30  # bytes more than the process has at its start
MODULES = ("apd_viewer.files", "apd_viewer.session.storage", "apd_viewer.session.posing")
MODULES += ("apd_viewer.session.quantities", "apd_viewer.cases")
sys.path[:0] = [str(ROOT / "tests" / "support"), str(ROOT)]


def others():
    """Modules that are not instrumented: what is no reader, and above all what numba compiles."""
    paths = (path.relative_to(ROOT).with_suffix("") for path in (ROOT / "apd_viewer").rglob("*.py"))
    names = (".".join(path.parts).removesuffix(".__init__") for path in paths)
    return [name for name in names if not name.startswith(MODULES)]


def limit_memory():
    """No more than MEMORY beyond what is used now; not on Windows."""
    import resource

    used = int(Path("/proc/self/statm").read_text().split()[0]) * resource.getpagesize()
    resource.setrlimit(resource.RLIMIT_AS, (used + MEMORY, resource.getrlimit(resource.RLIMIT_AS)[1]))


def reading(target, content):
    """Seconds of the processor that a reading takes, and what it fails with; empty if it does not."""
    # Not at the top: what is to be instrumented must not be imported before.
    from fuzz import check_sentence

    from apd_viewer.errors import InputError

    began = time.process_time()
    try:
        target.read(content)
    except InputError as error:
        try:
            check_sentence(error)
        except AssertionError as wrong:
            return time.process_time() - began, "".join(traceback.format_exception(error)) + str(wrong)
    except target.error:
        pass
    except BaseException:
        return time.process_time() - began, traceback.format_exc()
    took = time.process_time() - began
    return took, f"it took {took:.1f} s" if took > SECONDS else ""


def keep(name, content, why, known):
    """Keep a content that fails, one of each kind, and print how to repeat it."""
    lines = [line.strip() for line in why.splitlines() if line.strip().startswith("File ")]
    kind = (lines[-1] if lines else "", why.strip().splitlines()[-1].partition(":")[0])
    if kind in known:
        return
    known.add(kind)
    FOUND.mkdir(parents=True, exist_ok=True)
    path = FOUND / f"{name}-{hashlib.sha256(content).hexdigest()[:12]}"
    path.write_bytes(content)
    print(f"\n{name}: python tests/support/guided_fuzz.py --one {name} {path}\n{why}", flush=True)


def fuzz_in_turn(seconds, names):
    """Fuzz each target in processes split off from this one, which has imported all and computes nothing.

    Threads of what computes would not live in a process split off.
    """
    import atheris

    with atheris.instrument_imports(include=["apd_viewer"], exclude=others()):
        pass

    for name in names:
        ends, told = time.monotonic() + seconds, {"runs": 0, "worst": 0.0, "seconds": 0.0, "found": 0}
        figures = BUILD / f"{name}.json"
        known = set()
        while (left := ends - time.monotonic()) > 1.0:
            figures.unlink(missing_ok=True)
            if (process := os.fork()) == 0:
                fuzz_target(name, left, known)
            status = os.waitstatus_to_exitcode(os.waitpid(process, 0)[1])
            if figures.exists():
                part = json.loads(figures.read_text())
                told |= {key: told[key] + part[key] for key in ("runs", "seconds", "found")}
                told["worst"] = max(told["worst"], part["worst"])
            if status:
                told["found"] += 1
                print(f"\n{name}: the process ended with {status}; see {BUILD / name}.log", flush=True)
            if status and not figures.exists():  # it cannot even begin
                break
        figures.write_text(json.dumps(told))


def fuzz_target(name, seconds, known):
    """Fuzz a target in this process, which ends here."""
    import atheris
    from fuzz_targets import TARGETS, mutated

    target, corpus = TARGETS[name], CORPUS / name
    with (BUILD / f"{name}.log").open("w") as log:
        os.dup2(log.fileno(), 2)
    corpus.mkdir(parents=True, exist_ok=True)
    for content in target.seeds():
        reading(target, content)  # compiles what is compiled, before memory is short and time is measured
        (corpus / hashlib.sha256(content).hexdigest()).write_bytes(content)
    limit_memory()
    figures = {"runs": 0, "worst": 0.0, "began": time.monotonic()}

    def one(content):
        took, why = reading(target, content)
        figures["runs"] += 1
        figures["worst"] = max(figures["worst"], took)
        if why:
            keep(name, content, why, known)
        if figures["runs"] % 64 == 0 or why or took > 1.0:
            note()

    def note():
        told = {**figures, "seconds": time.monotonic() - figures["began"], "found": len(known)}
        (BUILD / f"{name}.json").write_text(json.dumps(told))

    def mutate(content, most, number):
        chance = random.Random(number)
        return mutated(content, chance, lambda each: atheris.Mutate(each, max(len(each) + 64, 1)))[:most]

    note()
    options = [f"-max_total_time={seconds:.0f}", "-timeout=60", "-rss_limit_mb=0", f"-max_len={LONGEST}"]
    options += [f"-artifact_prefix={FOUND}/{name}-", "-verbosity=0", "-len_control=0"]
    atheris.Setup([sys.argv[0], *options, str(CORPUS / name)], one, custom_mutator=mutate)
    atheris.Fuzz()
    os._exit(0)


def count_lines(names):
    """Print the lines of each module that the corpora of the targets reach, as JSON."""
    import coverage

    measured = coverage.Coverage(include=[f"{ROOT}/apd_viewer/*"], data_file=None)
    measured.start()
    from fuzz_targets import TARGETS

    measured.stop()
    modules = sorted({module for name in names for module in TARGETS[name].modules})
    files = {module: str(ROOT / "apd_viewer" / module) for module in modules}
    for name in names:
        TARGETS[name].seeds()  # some write what others refer to
        measured.start()
        for path in sorted((CORPUS / name).iterdir()):
            reading(TARGETS[name], path.read_bytes())
        measured.stop()
    told = {}
    for module, file in files.items():
        lines = inside_functions(Path(file))
        found = set(measured.get_data().lines(file) or ()) & lines
        told[module] = (len(found), len(lines), sorted(lines - found))
    print(json.dumps(told))


def inside_functions(path):
    """Numbers of the lines that run when functions of a module are called."""
    found = set()

    def walk(code, is_function):
        if is_function:
            found.update(line for _, _, line in code.co_lines() if line and line != code.co_firstlineno)
        for each in code.co_consts:
            if hasattr(each, "co_code"):
                walk(each, is_function or bool(each.co_flags & 1))  # CO_OPTIMIZED: no body of a class

    walk(compile(path.read_text(encoding="utf-8"), str(path), "exec"), False)
    return found


def child(*arguments, script=__file__, **options):
    path = os.pathsep.join([str(ROOT), str(Path(__file__).parent)])
    environment = {**os.environ, "PYTHONPATH": path, "OMP_NUM_THREADS": "1", "NUMBA_NUM_THREADS": "1"}
    command = [sys.executable, script, *map(str, arguments)]
    return subprocess.run(command, env=environment, cwd=ROOT, check=False, **options)


def main(minutes, names):
    from fuzz_targets import TARGETS

    meshes = not names
    names = names or list(TARGETS)
    readers = minutes * (0.8 if meshes else 1.0)
    FOUND.mkdir(parents=True, exist_ok=True)
    child("--targets", 60.0 * readers / len(names), *names)
    counted = json.loads(child("--lines", *names, stdout=subprocess.PIPE).stdout.splitlines()[-1])
    print(f"\n{'module':44} lines reached")
    for module, (reached, lines, _) in counted.items():
        print(f"{module:44} {reached:4} of {lines:4} {reached / lines:5.0%}")
    missed = [f"{module}: {each}" for module, (*_, each) in counted.items()]
    (BUILD / "not-reached.txt").write_text("\n".join(missed) + "\n")
    print("Lines inside functions, those that write included, by coverage.py over all that was kept;")
    print(f"those not reached are in {BUILD / 'not-reached.txt'}.")
    print(f"\n{'target':14} {'runs':>9} {'seconds':>8} {'worst':>8} {'found':>6}")
    found = 0
    for name in names:
        told = json.loads((BUILD / f"{name}.json").read_text())
        found += told["found"]
        print(f"{name:14} {told['runs']:9,} {told['seconds']:8.0f} {told['worst']:6.2f} s {told['found']:6}")
    failed = (
        meshes and child(minutes - readers, script=Path(__file__).with_name("hostile_meshes.py")).returncode
    )
    return 1 if found or failed else 0


if __name__ == "__main__":
    match sys.argv[1:]:
        case ["--targets", seconds, *names]:
            fuzz_in_turn(float(seconds), names)
        case ["--lines", *names]:
            count_lines(names)
        case ["--one", name, file]:
            from fuzz_targets import TARGETS

            TARGETS[name].seeds()
            print(*reading(TARGETS[name], Path(file).read_bytes()), sep="\n")
        case [*rest]:
            sys.exit(main(float(rest[0]) if rest else 10.0, rest[1:]))
