"""Readers under contents that are guided by coverage, for so many minutes; run by ``make fuzz``.

    python tests/support/guided_fuzz.py [minutes] [target ...]
    python tests/support/guided_fuzz.py --one TARGET FILE

libFuzzer changes valid contents, and keeps those that reach something new in build/fuzz/corpus, from which the
next run goes on. Whatever is raised must be the reader's declared error, within 5 s and little memory. Else the
content is kept in build/fuzz/found, and the run fails with the line that repeats it.

Lines are counted afterwards by coverage.py, in another process that reads the whole corpus: of the modules of
each reader, without those that run when they are imported.
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
SECONDS = 5.0  # a reading
LONGEST = 1 << 20  # bytes of a file
MEMORY = 2 << 30  # bytes more than the process has at its start
MODULES = ("apd_viewer.files", "apd_viewer.session.storage", "apd_viewer.session.posing")
MODULES += ("apd_viewer.session.quantities", "apd_viewer.cases")
sys.path[:0] = [str(ROOT / "tests" / "support"), str(ROOT)]


def limit_memory():
    """No more than MEMORY beyond what is used now; not on Windows."""
    import resource

    used = int(Path("/proc/self/statm").read_text().split()[0]) * resource.getpagesize()
    resource.setrlimit(resource.RLIMIT_AS, (used + MEMORY, resource.getrlimit(resource.RLIMIT_AS)[1]))


def reading(target, content):
    """Seconds of a reading, and what it fails with; empty if it does not."""
    began = time.monotonic()
    try:
        target.read(content)
    except target.error:
        pass
    except BaseException:
        return time.monotonic() - began, traceback.format_exc()
    took = time.monotonic() - began
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


def fuzz_target(name, seconds, seed):
    """Fuzz a target in this process, which ends here."""
    import atheris

    with atheris.instrument_imports(include=list(MODULES)):
        from fuzz_targets import TARGETS, mutated

    target, known = TARGETS[name], set()
    corpus = CORPUS / name
    corpus.mkdir(parents=True, exist_ok=True)
    for content in target.seeds:
        reading(target, content)  # compiles what is compiled, before the clock runs
        (corpus / hashlib.sha1(content).hexdigest()).write_bytes(content)
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
        return mutated(content, chance, name, lambda each: atheris.Mutate(each, max(len(each) + 64, 1)))[
            :most
        ]

    note()
    options = [f"-max_total_time={seconds:.0f}", "-timeout=30", "-rss_limit_mb=0", f"-max_len={LONGEST}"]
    options += [f"-artifact_prefix={FOUND}/{name}-", f"-seed={seed}", "-verbosity=0", "-len_control=0"]
    atheris.Setup([sys.argv[0], *options, str(corpus)], one, custom_mutator=mutate)
    atheris.Fuzz()


def count_lines(name):
    """Print the lines of each module of a target that its corpus reaches, as JSON."""
    import coverage
    from fuzz_targets import TARGETS

    target = TARGETS[name]
    files = [str(ROOT / "apd_viewer" / each) for each in target.modules]
    # What defines and imports has run before the measurement begins: it is no line of a reading.
    measured = coverage.Coverage(include=files, data_file=None)
    measured.start()
    for path in sorted((CORPUS / name).iterdir()):
        reading(target, path.read_bytes())
    measured.stop()
    told = {}
    for module, file in zip(target.modules, files, strict=True):
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


def child(*arguments, **options):
    environment = {**os.environ, "PYTHONPATH": str(ROOT), "OMP_NUM_THREADS": "1", "NUMBA_NUM_THREADS": "1"}
    return subprocess.run(
        [sys.executable, __file__, *map(str, arguments)], env=environment, cwd=ROOT, check=False, **options
    )


def run(name, seconds, seed):
    """Fuzz a target for so long, however often its process ends; figures of all its processes."""
    ends, told = time.monotonic() + seconds, {"runs": 0, "worst": 0.0, "seconds": 0.0, "found": 0}
    figures = BUILD / f"{name}.json"
    while (left := ends - time.monotonic()) > 3.0:
        figures.unlink(missing_ok=True)
        seed += 1
        done = child("--target", name, left, seed, stderr=subprocess.PIPE, text=True, errors="replace")
        if figures.exists():
            part = json.loads(figures.read_text())
            told = {key: told[key] + part[key] for key in ("runs", "seconds", "found")} | {
                "worst": max(told["worst"], part["worst"])
            }
        if done.returncode:
            told["found"] += 1
            print(f"\n{name}: the process ended with {done.returncode}\n{done.stderr[-3000:]}", flush=True)
            if not figures.exists():  # it cannot even begin
                break
    return told


def main(minutes, names):
    from fuzz_targets import TARGETS

    names = names or list(TARGETS)
    FOUND.mkdir(parents=True, exist_ok=True)
    rows, found, missed = [], 0, []
    for name in names:
        told = run(name, 60.0 * minutes / len(names), random.randrange(1 << 30))
        counted = json.loads(child("--lines", name, stdout=subprocess.PIPE).stdout.splitlines()[-1])
        reached, lines = (sum(each[k] for each in counted.values()) for k in (0, 1))
        missed += [f"{name}: {module}: {each[2]}" for module, each in counted.items() if each[2]]
        found += told["found"]
        rows.append((name, told["runs"], told["seconds"], reached, lines, told["worst"], told["found"]))
    (BUILD / "not-reached.txt").write_text("\n".join(missed) + "\n")
    print(f"\n{'target':10} {'runs':>9} {'seconds':>8} {'lines reached':>18} {'worst':>8} {'found':>6}")
    for name, runs, seconds, reached, lines, worst, failed in rows:
        share = f"{reached} of {lines} {reached / lines:4.0%}"
        print(f"{name:10} {runs:9,} {seconds:8.0f} {share:>18} {worst:6.2f} s {failed:6}")
    print("Lines inside functions of the reader's modules, counted by coverage.py over the corpus.")
    print(f"Those not reached are in {BUILD / 'not-reached.txt'}.")
    return 1 if found else 0


if __name__ == "__main__":
    match sys.argv[1:]:
        case ["--target", name, seconds, seed]:
            fuzz_target(name, float(seconds), int(seed))
        case ["--lines", name]:
            count_lines(name)
        case ["--one", name, file]:
            from fuzz_targets import TARGETS

            print(*reading(TARGETS[name], Path(file).read_bytes()), sep="\n")
        case [*rest]:
            sys.exit(main(float(rest[0]) if rest else 10.0, rest[1:]))
