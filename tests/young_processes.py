"""Processes of their own that need not load NumPy and numba nor have numba set itself up: one that waits did.

It has imported them, has compiled one addition by plain numba, and forks for every script that it is given. A script
finds nothing of Tautline imported, and no code of ours compiled or looked for in a cache, as in a process that was just
started, which would take most of a second longer. Where numba itself is told something by its variables, a process is
started; what asks whether numba is loaded, or is loaded after us, has to ask for one.

More that others wrote and that takes long to import may be named, such as what draws or writes files.
"""

import json
import os
import subprocess
import sys
import tempfile
from contextlib import contextmanager
from pathlib import Path

READ_AT_IMPORT = "NUMBA_"
SERVER = '''
import atexit, importlib, json, os, runpy, sys, traceback, types
import numba, numpy

for name in sys.argv[1:]:
    importlib.import_module(name)
numba.njit(lambda x: x + 1.0)(1.0)


def run(words, folder, environment, out, err):
    for number, name, way in ((0, os.devnull, os.O_RDONLY), (1, out, os.O_WRONLY), (2, err, os.O_WRONLY)):
        os.dup2(os.open(name, way), number)
    before = os.environ.get("PYTHONPATH", "").split(os.pathsep)
    os.environ.clear()
    os.environ.update(environment)
    os.chdir(folder)
    sys.dont_write_bytecode = bool(environment.get("PYTHONDONTWRITEBYTECODE"))
    named = environment.get("PYTHONPATH", "").split(os.pathsep)
    sys.path[:0] = [path for path in named if path not in before]
    first, *rest = words
    if first == "-m":
        sys.path.insert(0, folder)
        sys.argv = rest
        runpy.run_module(rest[0], run_name="__main__", alter_sys=True)
        return
    main = sys.modules["__main__"] = types.ModuleType("__main__")
    if first == "-c":
        text, sys.argv, name = rest[0], ["-c", *rest[1:]], "<string>"
        sys.path.insert(0, "")
    else:
        name, sys.argv = first, words
        main.__file__ = os.path.abspath(name)
        sys.path.insert(0, os.path.dirname(main.__file__))
        with open(name, encoding="utf8") as file:
            text = file.read()
    exec(compile(text, name, "exec"), vars(main))


def ended(asked):
    """Exit status of a script, as Python gives it."""
    try:
        run(*asked)
        return 0
    except SystemExit as exit:
        if exit.code is None or isinstance(exit.code, int):
            return exit.code or 0
        print(exit.code, file=sys.stderr)
        return 1
    except BaseException:
        traceback.print_exc()
        return 1


for line in sys.stdin:
    child = os.fork()
    if child == 0:
        code = ended(json.loads(line))
        atexit._run_exitfuncs()
        sys.stdout.flush()
        sys.stderr.flush()
        os._exit(code)
    print(os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]), flush=True)
'''


def started(words, cwd, env):
    """``python words`` in a process that was just started."""
    return subprocess.run([sys.executable, *map(str, words)], capture_output=True, text=True, cwd=cwd, env=env)


OF_COMMANDS = ("pydantic", "pint", "xarray", "scipy.interpolate", "scipy.linalg", "typer")
"""What a command that simulates imports of others."""


@contextmanager
def young_processes(*loaded):
    """A function (words, cwd, env) that runs ``python words`` as :func:`subprocess.run` does; for a ``with``.

    ``loaded`` are more packages of others that have been imported.
    """
    if not hasattr(os, "fork"):
        yield started
        return
    waiting = None

    def run(words, cwd, env):
        nonlocal waiting
        words = [str(word) for word in words]
        different = {name for name in {*os.environ, *env} if os.environ.get(name) != env.get(name)}
        if any(name.startswith(READ_AT_IMPORT) for name in different):
            return started(words, cwd, env)
        if waiting is None:
            waiting = subprocess.Popen(
                [sys.executable, "-c", SERVER, *loaded], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True
            )
        with tempfile.TemporaryDirectory() as folder:
            out, err = Path(folder) / "out", Path(folder) / "err"
            for file in (out, err):
                file.touch()
            waiting.stdin.write(json.dumps([words, str(cwd or Path.cwd()), env, str(out), str(err)]) + "\n")
            waiting.stdin.flush()
            code = int(waiting.stdout.readline())
            return subprocess.CompletedProcess(words, code, out.read_text("utf8"), err.read_text("utf8"))

    try:
        yield run
    finally:
        if waiting is not None:
            waiting.stdin.close()
            waiting.wait()
            waiting.stdout.close()
