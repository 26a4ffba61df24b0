"""The thread rule: one decorator compiles every parallel kernel, and lets one caller in at a time."""

import ast
import os
import subprocess
import sys
import textwrap
import threading
from pathlib import Path

import numba
import numpy as np

import apd_viewer
from apd_viewer.geometry.linalg.parallel_ops import largest_difference
from apd_viewer.geometry.linalg.threads import cores_for

PACKAGE = Path(apd_viewer.__file__).parent
DOOR = "geometry/linalg/threads.py"


def violations(source):
    """Lines that compile a parallel kernel, or loop over ``prange``, without the decorator."""
    tree = ast.parse(source)
    found = [
        node.value.lineno
        for node in ast.walk(tree)
        if isinstance(node, ast.keyword) and node.arg in ("parallel", "target")
    ]
    inside = {
        id(node)
        for function in ast.walk(tree)
        if isinstance(function, ast.FunctionDef)
        and any(
            isinstance(d, ast.Call) and ast.unparse(d.func) == "parallel" for d in function.decorator_list
        )
        for node in ast.walk(function)
    }
    found += [
        node.lineno
        for node in ast.walk(tree)
        if isinstance(node, ast.Call) and ast.unparse(node.func).endswith("prange") and id(node) not in inside
    ]
    return found


def test_parallel_is_the_rule_that_every_parallel_kernel_obeys():
    found = [
        f"{path.relative_to(PACKAGE).as_posix()}: line {line}"
        for path in sorted(PACKAGE.rglob("*.py"))
        if path.relative_to(PACKAGE).as_posix() != DOOR and "numba" in path.read_text(encoding="utf-8")
        for line in violations(path.read_text(encoding="utf-8"))
    ]
    assert found == []


def test_parallel_rule_finds_kernels_outside_it():
    assert violations("@njit(parallel=True)\ndef f(x):\n    pass") == [1]
    assert violations("f = njit(cache=True, parallel=True)(g)") == [1]
    assert violations("@njit\ndef f(x):\n    for i in numba.prange(3):\n        pass") == [3]
    assert violations("@parallel()\ndef f(x):\n    for i in prange(3):\n        pass") == []


def split_sums(source):
    """Lines of parallel kernels where numba splits a sum by the number of threads."""
    found = []
    for kernel in ast.walk(ast.parse(source)):
        if not isinstance(kernel, ast.FunctionDef) or not any(
            ast.unparse(d).startswith("parallel(") for d in kernel.decorator_list
        ):
            continue
        loops = [n for n in kernel.body if isinstance(n, ast.For) and "prange(" in ast.unparse(n.iter)]
        inside = {id(node) for loop in loops for node in ast.walk(loop)}
        for node in ast.walk(kernel):
            if isinstance(node, ast.Call) and ast.unparse(node).endswith((".sum()", ".mean()", ".prod()")):
                found += [node.lineno] if id(node) not in inside else []
        for loop in loops:
            own = {
                name.id
                for node in ast.walk(loop)
                if isinstance(node, ast.Assign)
                for target in node.targets
                for name in ast.walk(target)
                if isinstance(name, ast.Name)
            }
            found += [
                node.lineno
                for node in ast.walk(loop)
                if isinstance(node, ast.AugAssign)
                and isinstance(node.target, ast.Name)
                and node.target.id not in own
            ]
    return found


def test_parallel_kernels_never_sum_by_the_number_of_threads():
    found = [
        f"{path.relative_to(PACKAGE).as_posix()}: line {line}"
        for path in sorted(PACKAGE.rglob("*.py"))
        if "prange" in (source := path.read_text(encoding="utf-8"))
        for line in split_sums(source)
    ]
    assert found == []


def test_parallel_rule_finds_sums_split_by_the_number_of_threads():
    kernel = "@parallel()\ndef f(x):\n    s = 0.0\n    for i in prange(3):\n        {}\n    return {}"
    assert split_sums(kernel.format("s += x[i]", "s")) == [5]
    assert split_sums(kernel.format("x[i] = 1.0", "x.sum()")) == [6]
    assert split_sums(kernel.format("x[i] += 1.0", "total(x)")) == []
    assert split_sums(kernel.format("t = 0.0; t += x[i]", "s")) == []


# Where numba has nothing but its workqueue, two threads in kernels at once end the process.
CALLS = """
    import inspect, sys, threading
    import numba
    import numpy as np
    from apd_viewer.geometry.linalg.parallel_ops import plus_linear_combination

    kernel = plus_linear_combination
    if "bare" in sys.argv:
        kernel = inspect.getclosurevars(plus_linear_combination).nonlocals["kernel"]
    numba.set_num_threads(min(2, numba.config.NUMBA_NUM_THREADS))
    X, c, A = np.ones((20_000, 3)), np.ones(1), np.ones((1, 20_000, 3))
    kernel(X, c, A)
    assert numba.threading_layer() == "workqueue"
    work = lambda: [kernel(X, c, A) for _ in range(100)]
    threads = [threading.Thread(target=work) for _ in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    print("survived")
"""


def run(*words):
    return subprocess.run(
        [sys.executable, "-c", textwrap.dedent(CALLS), *words],
        env={**os.environ, "NUMBA_THREADING_LAYER": "workqueue", "NUMBA_NUM_THREADS": "2"},
        cwd=PACKAGE.parent,
        capture_output=True,
        text=True,
        check=False,
        timeout=120,
    )


def test_parallel_lets_a_kernel_called_from_many_threads_end_no_process():
    done = run()
    assert done.returncode == 0, done.stderr
    assert done.stdout.strip() == "survived"


def test_parallel_without_the_lock_would_let_the_same_kernel_end_the_process():
    done = run("bare")
    assert done.returncode != 0
    assert "concurrent" in done.stderr.lower(), done.stderr


def test_cores_for_lets_a_kernel_wait_for_another_thread_that_has_the_cores():
    done, X = threading.Event(), np.zeros((10, 3))
    thread = threading.Thread(target=lambda: (largest_difference(X, X), done.set()))
    with cores_for(10):
        thread.start()
        assert not done.wait(0.2)
        assert largest_difference(X, X + 1.0) == 1.0, "the thread that has them does not wait"
    assert done.wait(30.0)
    thread.join()


def test_cores_for_restores_the_number_of_cores():
    before = numba.get_num_threads()
    with cores_for(10):
        assert numba.get_num_threads() == 1
    assert numba.get_num_threads() == before
