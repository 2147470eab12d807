"""Kernels compiled side by side: what a first run has to compile is shared among processes.

Numba compiles under one lock, so threads would wait for one another. Each helper is a process of its own that compiles
what it is sent into the same cache; this process works on the same list from its other end and then loads what the
helpers made. A helper that fails leaves its work to be compiled here when it is needed.
"""

from __future__ import annotations

import contextlib
import importlib
import json
import os
import pickle
import subprocess
import sys
import threading
from collections import deque
from collections.abc import Callable
from typing import IO, Any

from tautline.kernels.jit import Kernel
from tautline.kernels.machine import storage
from tautline.kernels.machine.gc_tuning import COMPILING, collected_for_compiling, collected_rarely, left_at_exit
from tautline.kernels.machine.settings import UNCOMPILED
from tautline.kernels.memory import Form
from tautline.kernels.separate import compile_for_others

Job = tuple[Kernel, tuple[Form, ...]]
"""A kernel and the forms of its arguments."""

HELPERS = 3
"""Processes beside this one, at most."""
WORTH = 4
"""A helper needs a second to start: with fewer kernels to compile none is called."""


Announce = Callable[[int], Callable[[], None] | None]
"""Called with the number of kernels to be compiled, before they are; what it gives back is called when they are."""


def compile_all(jobs: list[Job], announce: Announce | None = None) -> None:
    """Compile what is not compiled yet, or load it from the cache.

    Parameters
    ----------
    jobs : list of (kernel, forms)
        Taken from both ends: heavy ones belong there, light ones in the middle.
    announce : callable or None
        Called with the number of kernels to be compiled, if there are any, before they are; it may give back what is
        called when they are.
    """
    if UNCOMPILED:
        return
    waiting = deque((kernel, forms) for kernel, forms in jobs if not kernel.is_ready(forms))
    done = announce(len(waiting)) if waiting and announce is not None else None
    processors = len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1
    helpers = min(HELPERS, processors - 1, len(waiting) // WORTH)
    if helpers > 0 and storage.base_to_write() is None:
        helpers = 0  # what they compile could not be handed over
    threads = [threading.Thread(target=_employ, args=(waiting,), daemon=True) for _ in range(helpers)]
    for thread in threads:
        thread.start()
    with collected_for_compiling() if waiting else contextlib.nullcontext():
        while waiting:
            with contextlib.suppress(IndexError):
                kernel, forms = waiting.popleft()
                kernel.at(forms)
    for thread in threads:
        thread.join()
    for kernel, forms in jobs:
        kernel.at(forms)
    if done is not None:
        done()


def _employ(waiting: deque[Job]) -> None:
    """Start a helper and send it the jobs at the end of the list, one after another, until there are none."""
    # Without the current folder on its path (-P) from the first import on; not even PYTHONPATH may put it there (-E).
    folders = [json.dumps(each) for each in ([*map(str, sys.path)], _unsafe_folders())]
    command = [sys.executable, "-E", "-P", "-c", BEGIN, *folders]
    pipes = {"stdin": subprocess.PIPE, "stdout": subprocess.PIPE, "stderr": subprocess.DEVNULL}
    environment = os.environ | {"TAUTLINE_CACHE": str(storage.base_to_write())}
    with contextlib.suppress(OSError, IndexError), subprocess.Popen(command, env=environment, **pipes) as helper:
        assert helper.stdin and helper.stdout
        while helper.stdout.read(1):
            kernel, forms = waiting.pop()
            _send(helper.stdin, (kernel.__module__, kernel.__name__, forms))


BEGIN = """
import json, os, sys
path, unsafe = (json.loads(given) for given in sys.argv[1:3])
unsafe = set(unsafe) - {os.path.realpath(p) for p in sys.path}
sys.path[:] = [p for p in path if os.path.isabs(p) and os.path.realpath(p) not in unsafe]
from tautline.kernels import parallel_compile
parallel_compile.run_compile_worker()
"""
"""What a helper runs: it looks for modules where this process does, but not in the folders that are unsafe."""


def _unsafe_folders() -> list[str]:
    """The current folder and that of the script that runs: no file there may stand in for a module of Python's.

    A kernel that is defined there is compiled by this process, which has loaded it.
    """
    script = getattr(sys.modules.get("__main__"), "__file__", None)
    folders = [os.getcwd(), *([os.path.dirname(os.path.abspath(script))] if script else [])]
    return [os.path.realpath(folder) for folder in folders]


def _send(stream: IO[bytes], job: Any) -> None:
    data = pickle.dumps(job)
    stream.write(len(data).to_bytes(8, "little") + data)
    stream.flush()


def run_compile_worker() -> None:
    """Be a helper: say that there is nothing to do, read a job, compile it, until the other side is gone."""
    answers = os.fdopen(os.dup(1), "wb")
    os.dup2(2, 1)
    left_at_exit()
    compile_for_others()
    with collected_rarely(COMPILING):
        while True:
            answers.write(b".")
            answers.flush()
            size = int.from_bytes(sys.stdin.buffer.read(8), "little")
            if size == 0:
                return
            with contextlib.suppress(Exception):
                module, name, forms = pickle.loads(sys.stdin.buffer.read(size))
                getattr(importlib.import_module(module), name).at(forms)
