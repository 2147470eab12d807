"""What hosts of FMUs do that Python programs do not: threads of their own, Pythons without Tautline, other versions."""

import os
import subprocess
import sys
from pathlib import Path

import tautline

DATA = Path(__file__).parents[2] / "data"

OTHER_THREAD = """
import _thread, sys
assert "threading" not in sys.modules
sys.path[:] = {path!r}
told = []

def act():
    try:
        import threading
        # From Python 3.13 on it is the thread that started Python.
        assert sys.version_info >= (3, 13) or threading.current_thread() is threading.main_thread()
        import tautline
        from tautline.interruption import ended_by_signal
        with ended_by_signal():
            sim = tautline.Simulation({scene!r}, keep=False)
            for _ in range(2):
                sim.advance(0.05)
        told.append(repr(float(sim["winch.tension"])))
    except BaseException as error:
        told.append(repr(error))
    done.release()

done = _thread.allocate_lock()
done.acquire()
_thread.start_new_thread(act, ())
done.acquire()
print(told[0])
"""
"""A host that starts Python in one thread and steps in another, which `threading` takes for the main one."""


def test_a_simulation_steps_in_a_thread_that_may_handle_no_signals():
    """No signals can be heard there; the reference is the same simulation in the thread that started Python."""
    scene = str(DATA / "hoist.yaml")
    script = OTHER_THREAD.format(path=sys.path, scene=scene)
    # Without `site`: it would import `threading`.
    ran = subprocess.run(
        [sys.executable, "-S", "-c", script], capture_output=True, text=True, timeout=300, env={**os.environ}
    )
    sim = tautline.Simulation(scene, keep=False)
    for _ in range(2):
        sim.advance(0.05)
    assert ran.stdout.strip() == repr(float(sim["winch.tension"])), ran.stdout + ran.stderr
