"""BLAS threads: one inside our own linear algebra, what it was before after it; and how often flutter solves."""

import subprocess
import sys
import threading
from pathlib import Path

import pytest
from threadpoolctl import threadpool_info, threadpool_limits

import gardenhose.flutter
from gardenhose.scene import read
from tautline.integrators.vibration import vibrations as small_motions
from tautline.threads import one_thread

HOSE = Path(__file__).parents[2] / "data" / "hose.yaml"
SEARCH = 14
"""Eigenvalue problems beyond those that are drawn: two planes, measured 10."""


def blas():
    return [one["num_threads"] for one in threadpool_info() if one["user_api"] == "blas"]


def test_blas_has_one_thread_inside_nested_or_not_and_its_own_number_after():
    before = blas()
    with one_thread():
        assert set(blas()) == {1}
        with one_thread():
            assert set(blas()) == {1}
        assert set(blas()) == {1}
    assert blas() == before


def test_a_users_number_of_threads_is_restored_after_an_error_too():
    with threadpool_limits(2, user_api="blas"):
        before = blas()
        with pytest.raises(KeyboardInterrupt), one_thread():
            raise KeyboardInterrupt
        assert blas() == before


def test_the_last_of_several_python_threads_restores_the_number():
    before = blas()
    inside, leave = threading.Event(), threading.Event()

    def other():
        with one_thread():
            inside.set()
            leave.wait(20)

    with one_thread():
        thread = threading.Thread(target=other)
        thread.start()
        assert inside.wait(20)
    assert set(blas()) == {1}
    leave.set()
    thread.join()
    assert blas() == before


def test_flutter_solves_few_eigenvalue_problems_each_on_one_thread(monkeypatch):
    # 83 problems, 22 of them for the search alone, when the speeds that were tried were not among those drawn. Each has
    # two parts, of motions in the plane of the hose and out of it.
    threads, parts, problems = [], [], []

    def eig(*args, **options):
        threads.extend(blas())
        parts.append(args[0].shape)
        return solve(*args, **options)

    def whole(*args):
        problems.append(args[0].shape)
        return solve_whole(*args)

    solve, solve_whole, before = small_motions.eig, small_motions._all, blas()
    monkeypatch.setattr(small_motions, "eig", eig)
    monkeypatch.setattr(small_motions, "_all", whole)
    found = gardenhose.flutter.stability(read(HOSE))
    assert set(threads) == {1}
    assert blas() == before
    assert len(problems) <= found.speed.size + SEARCH
    assert len(problems) <= 65 and len(parts) == 2 * len(problems)
    # The speeds by 61 values and a search of its own, before.
    speeds = {one.plane: one.speed for one in found.critical}
    assert speeds == pytest.approx({"out": 13.841223931952742, "in": 13.91554323973101}, rel=1e-6)


def test_a_command_that_solves_nothing_loads_no_thread_library():
    names = "tautline.cli.main, gardenhose.application, tautline.threads"
    code = f"import sys, {names}; print('threadpoolctl' in sys.modules)"
    ended = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert ended.stdout.strip() == "False"
