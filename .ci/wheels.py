"""Wheels: one for any machine, and one for machines like this that brings compiled kernels of every shipped scene.

    python .ci/wheels.py -o dist                      # all scenes of data/ and all templates, every level of processor
    python .ci/wheels.py -o dist --scenes jwell hose  # some of them

Run it with the Python, numba and NumPy that the wheel is for, in an environment in which this checkout is installed
(``pip install -e '.[dev]'``). A level is one of `tautline.kernels.machine.targets`: on x86-64 kernels are compiled
for AVX2 with FMA and for any processor, and a run takes those that its processor can execute.
"""

from __future__ import annotations

import argparse
import os
import platform
import shutil
import subprocess
import sys
import sysconfig
import tempfile
import time
from collections.abc import Iterator
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path

ROOT = Path(__file__).parents[1]
PLATFORMS = {"x86_64": "manylinux_2_17_x86_64", "aarch64": "manylinux_2_17_aarch64"}
"""Tags of platforms; kernels call nothing of the C library that is younger."""
VERBS = {
    "drillstring": (("form",), ("campbell",), ("torque-drag",)),
    "gardenhose": (("static",), ("flutter", "--speed", "0,10")),
}
"""Verbs of an application alone that compute with kernels."""


def scenes() -> list[str]:
    """Names of the scenes of ``data/`` and of the templates that are not among them."""
    from tautline.application.installed import Installed

    found = {path.stem for path in (ROOT / "data").glob("*.yaml")}
    starters = {starter for one in Installed().all() for starter in getattr(one, "starters", ())}
    return sorted(found | starters)


def compile_scene(name: str, quick: bool) -> str:
    """Compile what a scene needs, with every method, into the cache; what failed, in words."""
    import contextlib
    import io

    from tautline.application.installed import Installed
    from tautline.cli.main import main
    from tautline.integrators.time_loop import compile_for
    from tautline.kernels import parallel_compile
    from tautline.kernels.separate import late_code
    from tautline.scene.methods import names
    from tautline.simulation import Run

    parallel_compile.HELPERS = 0  # there is a process for each processor as it is
    failed: list[str] = []

    def run(*words: str) -> None:
        sys.argv = ["tautline", *words]
        said = io.StringIO()
        with contextlib.redirect_stdout(io.StringIO()), contextlib.redirect_stderr(said):
            try:
                main()
            except SystemExit as ended:
                if ended.code not in (0, 3):
                    failed.append(f"{' '.join(words)}: {said.getvalue()[-300:]}")

    with tempfile.TemporaryDirectory() as folder, contextlib.chdir(folder):
        path = ROOT / "data" / f"{name}.yaml"
        if not path.exists():
            path = Path(f"{name}.yaml")
            run("new", name, "-o", str(path))
        application, scene = Installed().read(path)
        for method in names():
            try:
                model = application.build(application.with_overrides(scene, method=method))
                started = Run(model)
            except Exception as refused:  # a method that the scene does not go with
                failed.append(f"{name}, {method}: {refused}")
                continue
            compile_for(started.method, model.system, started.state)
        run("simulate", str(path), "--end", "0.05", "--quiet", "-o", "result.nc")
        for kernel, forms in late_code():  # whether this scene has come to it or not
            kernel.at(forms)
        if not quick:
            for verb in ("stability", "study"):
                run(verb, str(path), "--quick", "--json", "-o", verb)
            for verb in VERBS.get(application.name, ()):
                _run_own(application.name, [verb[0], str(path), *verb[1:]], failed)
    return "\n".join(failed)


def _run_own(application: str, words: list[str], failed: list[str]) -> None:
    """Run a verb of an application's own command."""
    done = subprocess.run(
        [str(Path(sys.executable).with_name(application)), *words], stdout=subprocess.DEVNULL, stderr=subprocess.PIPE,
        stdin=subprocess.DEVNULL, text=True,
    )  # fmt: skip
    if done.returncode not in (0, 3):
        failed.append(f"{application} {' '.join(words)}: {done.stderr[-300:]}")


def compile_all_scenes(names: list[str], level: str, cache: Path, quick: bool) -> None:
    """Compile all for a level, in processes that are told which processor to compile for."""
    environment = os.environ | {
        "NUMBA_CPU_NAME": level, "NUMBA_CPU_FEATURES": "", "TAUTLINE_CACHE": str(cache), "OPENBLAS_NUM_THREADS": "1",
    }  # fmt: skip
    command = [sys.executable, __file__, "--compile", *names, *(["--quick"] if quick else [])]
    subprocess.run(command, env=environment, check=True)


def machine_code(cache: Path, folder: Path) -> Iterator[int]:
    """Copy what is machine code; parts are LLVM's code, for those who compile. Yields bytes."""
    from tautline.kernels.machine.code import SUFFIX

    for file in cache.rglob(f"*{SUFFIX}"):
        copy = folder / file.relative_to(cache)
        copy.parent.mkdir(parents=True, exist_ok=True)
        shutil.copyfile(file, copy)
        yield copy.stat().st_size


def pure_wheel(folder: Path) -> Path:
    """Build the wheel for any machine."""
    with tempfile.TemporaryDirectory() as name:
        files = subprocess.run(
            ["git", "ls-files", "-z", "--cached", "--others", "--exclude-standard"], cwd=ROOT, check=True,
            capture_output=True, text=True,
        ).stdout.split("\0")  # fmt: skip
        for file in filter(None, files):
            if (ROOT / file).is_file():
                (Path(name) / file).parent.mkdir(parents=True, exist_ok=True)
                shutil.copyfile(ROOT / file, Path(name) / file)
        subprocess.run([sys.executable, "-m", "pip", "wheel", "-q", "--no-deps", "-w", str(folder), name], check=True)
    return next(iter(sorted(folder.glob("tautline-*-py3-none-any.whl"))))


def wheel_with(pure: Path, cache: Path, output: Path) -> tuple[Path, int, int]:
    """Put compiled kernels into a copy of a wheel, for this Python and platform; path, kernels, bytes of them."""
    python, system = tags()
    with tempfile.TemporaryDirectory() as name:
        subprocess.run([sys.executable, "-m", "wheel", "unpack", "-d", name, str(pure)], check=True, stdout=2)
        (tree,) = Path(name).iterdir()
        compiled = tree / "tautline" / "kernels" / "compiled"
        sizes = list(machine_code(cache / "tautline-kernels", compiled))
        (compiled / "MADE_FOR").write_text(made_for() + "\n", encoding="utf8")
        (about,) = tree.glob("*.dist-info")
        lines = (about / "WHEEL").read_text(encoding="utf8").splitlines()
        kept = [line for line in lines if not line.startswith(("Tag:", "Root-Is-Purelib:")) and line]
        kept += ["Root-Is-Purelib: false", f"Tag: {python}-none-{system}"]
        (about / "WHEEL").write_text("\n".join(kept) + "\n", encoding="utf8")
        before = set(output.glob("*.whl"))
        subprocess.run([sys.executable, "-m", "wheel", "pack", "-d", str(output), str(tree)], check=True, stdout=2)
        made = set(output.glob("*.whl")) - before or {max(output.glob("*.whl"), key=os.path.getmtime)}
    return made.pop(), len(sizes), sum(sizes)


def tags() -> tuple[str, str]:
    """Of this Python and of this platform."""
    return f"cp{sys.version_info.major}{sys.version_info.minor}", PLATFORMS[platform.machine()]


def made_for() -> str:
    """The versions that the kernels are for."""
    import numba
    import numpy

    numbers = ".".join(numpy.__version__.split(".")[:2])
    return f"numba {numba.__version__}, NumPy {numbers}, Python {sysconfig.get_python_version()}"


def main() -> None:
    """Build both wheels, or compile scenes for the processor that numba is told of."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("-o", "--output", type=Path, default=Path("dist"), help="folder of the wheels")
    parser.add_argument("--scenes", nargs="*", help="names of scenes; all without it")
    parser.add_argument("--levels", nargs="*", help="levels of processor; all of this machine without it")
    parser.add_argument(
        "--quick", action="store_true", help="what runs need alone: no study, stability and other verbs"
    )
    parser.add_argument("--cache", type=Path, help="folder that keeps what was compiled, to go on from")
    parser.add_argument("--compile", nargs="*", help=argparse.SUPPRESS)
    asked = parser.parse_args()
    if asked.compile is not None:
        quick = [asked.quick] * len(asked.compile)
        with ProcessPoolExecutor(len(os.sched_getaffinity(0))) as pool:
            for name, said in zip(asked.compile, pool.map(compile_scene, asked.compile, quick), strict=True):
                print(f"  {name}{': ' + said if said else ''}", flush=True)
        return
    from tautline.kernels.machine.targets import LEVELS

    levels = asked.levels or list(LEVELS.get(platform.machine(), ()))
    output = asked.output.absolute()
    output.mkdir(parents=True, exist_ok=True)
    pure = pure_wheel(output)
    print(pure)
    if not levels or platform.machine() not in PLATFORMS or sys.platform != "linux":
        print(f"no compiled kernels for {platform.machine()}, {sys.platform}")
        return
    with tempfile.TemporaryDirectory() as name:
        cache = asked.cache or Path(name)
        for level in levels:
            begun = time.monotonic()
            print(f"compiling for {level}", flush=True)
            compile_all_scenes(asked.scenes or scenes(), level, cache, asked.quick)
            print(f"  {time.monotonic() - begun:.0f} s")
        wheel, kernels, size = wheel_with(pure, cache, output)
    print(f"{wheel}: {kernels} kernels, {size / 1e6:.1f} MB, for {made_for()}")


if __name__ == "__main__":
    main()
