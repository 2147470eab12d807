"""Mutation of kernels: each is changed on purpose, alone, and some test of its room has to fail.

    python -m benchmarks.pages.mutation            all of them, and the table of docs/claims.md is written
    python -m benchmarks.pages.mutation --quick    the first two: a look, which writes nothing
    python -m benchmarks.pages.mutation NAME...    those whose kernel has NAME in it, printed only

Each change is made in a copy of the sources in a temporary folder. The tests come from the copy too, and stop at the
first that fails. That test must pass on a copy without the change. The copies share a cache of compiled kernels, whose
key holds the contents of the sources; it begins as a copy of the user's.
"""

from __future__ import annotations

import argparse
import ast
import os
import re
import shutil
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import NamedTuple

from benchmarks import ROOT
from benchmarks.page import between, load, machine, table
from tautline.kernels.machine import storage

PAGE = ROOT / "docs" / "claims.md"
MARKS = "<!-- mutation: written by benchmarks/pages/mutation.py -->", "<!-- end of mutation -->"
COPIED = ("core", "apps", "tests")
LEFT_OUT = shutil.ignore_patterns("__pycache__", "*.egg-info", ".hypothesis")
LONGEST = 900.0
"""Time after which tests count as hung, s: that kills nothing."""
FAILED = re.compile(r"^(?:FAILED|ERROR) (\S+\.py::.*?)(?: - .*)?$", re.M)


class Mutant(NamedTuple):
    """A kernel by file and function; its text and what takes the place of it; what that means; tests, from ``tests``.

    ``plain`` tests run kernels as Python does: that is the quicker where a compiler would take longer than the test.
    """

    file: str
    function: str
    was: str
    now: str
    what: str
    tests: tuple[str, ...]
    plain: bool = True


MUTANTS = (
    Mutant(
        "core/tautline/elements/inertia.py", "_momentum", "22.0 * r1 + 4.0 * s1 + 13.0 * r2 - 3.0 * s2",
        "22.0 * r1 + 4.0 * s1 + 13.0 * r2 + 3.0 * s2", "sign in the consistent mass",
        ("kernels/elements/test_cable_groups.py",),
    ),
    Mutant(
        "core/tautline/kernels/time_function.py", "_written", "2.0 * de * dg", "de * dg",
        "factor in the second rate of a wave that grows", ("kernels/test_time_function.py",),
    ),
    Mutant(
        "core/tautline/elements/tension.py", "tension_of_four", "force = carried * strain * d_strain",
        "force = carried * strain", "factor of engineering strain dropped", ("kernels/elements/test_cable_groups.py",),
    ),
    Mutant(
        "core/tautline/elements/beam/bending.py", "bending_of_four", "p[SECOND + 3] * h", "p[SECOND + 3] * h * h",
        "power of the length in the curvature", ("kernels/elements/test_cable_groups.py",),
    ),
    Mutant(
        "core/tautline/elements/cubic.py", "_add_in_a_row_with_mass", "_plus(s, m32, axis), _plus(d, m33, axis)",
        "_plus(s, m31, axis), _plus(d, m33, axis)", "entry of the mass where terms go together",
        ("kernels/elements/test_elements_of_four.py",),
    ),
    Mutant(
        "core/tautline/elements/flow.py", "_residual", "2.0 * (l_d * v_l - u * v_x)", "2.0 * l_d * v_l - u * v_x",
        "factor 2 of the Coriolis acceleration", ("kernels/elements/test_cable_groups.py",),
    ),
    Mutant(
        "core/tautline/elements/shared_flow.py", "_residual", "0.5 * u * u * (s2 * s2 - s1 * s1)",
        "0.5 * u * u * (s2 * s2 + s1 * s1)", "momentum of the water at a hose's ends, on its flow",
        ("kernels/elements/test_shared_flow.py", "kernels/elements/test_pipes.py"),
    ),
    Mutant(
        "core/tautline/kernels/compiling/types/lanes.py", "_turned", "_words(2)", "_words(1)",
        "quadrant in which a sine in lanes changes its sign", ("kernels/test_lanes.py",), False,
    ),
    Mutant(
        "core/tautline/kernels/factors/band.py", "eliminate", "last = max(reach, right[j])", "last = right[j]",
        "fill by an exchanged row forgotten", ("kernels/matrices/test_band.py", "kernels/matrices/test_matrix.py"),
    ),
    Mutant(
        "core/tautline/kernels/factors/band_blocks.py", "solve_by_blocks", "min(reach, last - 1 - b) + 1",
        "min(reach, last - 1 - b)", "farthest block of the back substitution left out",
        ("kernels/matrices/test_band_blocks.py",),
    ),
    Mutant(
        "core/tautline/kernels/matrix.py", "_clear_up_to", "first, last = matrix.cleared[0],",
        "first, last = matrix.cleared[0] + 1,", "column of a tangent that is not cleared",
        ("kernels/matrices/test_clearing.py", "kernels/matrices/test_matrix.py"),
    ),
    Mutant(
        "core/tautline/constraints/penalty.py", "_residual", "(value_of(e, i, q) + e.offset[i])", "value_of(e, i, q)",
        "offset of a spring's equation dropped", ("kernels/elements/test_cable_groups.py",),
    ),
    Mutant(
        "core/tautline/constraints/multiplier.py", "_tangent", "_add(g, cm, ck * beta, matrix, dofs)",
        "_add(g, cm, ck, matrix, dofs)", "scale of the constraints' rows",
        ("kernels/elements/test_cable_groups.py",),
    ),
    Mutant(
        "core/tautline/integrators/generalized_alpha.py", "_auxiliary",
        "* (a - alpha_m * last)", "* (a - m.alpha_f * last)",
        "one alpha for the other in the auxiliary acceleration", ("order/test_order.py",),
    ),
    Mutant(
        "core/tautline/integrators/generalized_alpha.py", "_local_error", "m.beta - 1.0 / 6.0", "m.beta - 1.0 / 4.0",
        "constant of the error of a step", ("order/test_error_of_a_step.py",),
    ),
    Mutant(
        "core/tautline/integrators/rk4.py", "rk4_step", "h if stage == 2 else", "h if stage == 1 else",
        "stage that goes a whole step ahead", ("order/test_order.py",),
    ),
    Mutant(
        "core/tautline/integrators/explicit.py", "accelerate", "state.a[k] if method.felt else 0.0", "0.0",
        "accelerations that are felt left out of what they are solved for from",
        ("physics/lifting/test_crane_closed_forms.py",), plain=False,
    ),
    Mutant(
        "core/tautline/lumped/generated.py", "body_residual", "-c10*c11 -", "-m*sd*c11 -",
        "factor 2 of the Coriolis force of Kane's string", ("kernels/strings/test_string_groups.py",),
    ),
    Mutant(
        "core/tautline/lumped/link.py", "_residual", "tension * d[3], tension * d[4]", "tension * d[3], tension * d[1]",
        "index of the stretch's gradient", ("kernels/strings/test_string_groups.py",),
    ),
    Mutant(
        "core/tautline/lumped/string.py", "_residual",
        "where(within(i, bends), gather(g.bends.stiffness, i, count - 2), 0.0)",
        "gather(g.bends.stiffness, i, count - 2)",
        "bends below the last link", ("kernels/test_lanes.py",),
    ),
    Mutant(
        "core/tautline/integrators/corrector/single_precision.py", "_make_sure", "<= LEFT", "<= 1.0 / LEFT**2",
        "test of factors that are rounded", ("kernels/matrices/test_band_blocks.py", "order/test_single_precision.py"),
    ),
    Mutant(
        "apps/drillstring/groups/friction.py", "_settle_events", "limit = f.static * touch.normal",
        "limit = f.kinetic * touch.normal", "factor that holds what has come to rest",
        ("kernels/strings/test_coming_to_rest.py", "kernels/strings/test_contact_groups.py"),
    ),
    Mutant(
        "apps/drillstring/drilling/bit_rock.py", "_advance_rock", "0.5 * (t - b.time) * (b.drilled + g.value[RATE])",
        "(t - b.time) * b.drilled", "order of the hole's depth in time", ("kernels/strings/test_bit_groups.py",),
    ),
    Mutant(
        "apps/crane/groups/span.py", "_flow", "(kinetic + dot(p, t)) / size", "(kinetic - dot(p, t)) / size",
        "sign of the momentum that flows through a span", ("cranes/groups/test_spans.py",),
    ),
    Mutant(
        "apps/crane/groups/capstan_friction.py", "_limit", "g.found[row.before, LAST_PSI])) - 1.0",
        "g.found[row.before, LAST_PSI]))", "1 subtracted from exp(mu psi)",
        ("physics/lifting/test_crane_closed_forms.py",), False,
    ),
    Mutant(
        "apps/crane/groups/hydrodynamics.py", "_resist", "- 2.0 * along * x[E_D, c]", "- along * x[E_D, c]",
        "factor of the turning chord in the water's acceleration", ("cranes/groups/test_immersed_rope.py",), False,
    ),
    Mutant(
        "core/tautline/kernels/moving_frame.py", "_product", "2.0 * a[1, i, k] * b[1, k, j]",
        "a[1, i, k] * b[1, k, j]", "Coriolis term of a frame on a moving vessel", ("cranes/sea/test_frames.py",),
    ),
    Mutant(
        "core/tautline/statistics/streaming.py", "rainflow_cycles", "found.append(size[inner + 1])",
        "found.append(size[inner])",
        "range before the one that is closed counted",
        (
            "storms/test_results_that_keep_statistics.py::test_rainflow_cycles_of_turning_points_are_those_of_the_standard",
        ),
    ),
)  # fmt: skip


class Outcome(NamedTuple):
    """The test that failed, empty where none did; what went wrong besides, empty where nothing; the time, s."""

    killer: str
    fault: str
    seconds: float


def function_lines(text: str, name: str) -> tuple[int, int]:
    """First line of a function of a module and the line after its last, counted from zero."""
    (found,) = (node for node in ast.parse(text).body if isinstance(node, ast.FunctionDef) and node.name == name)
    return found.lineno - 1, found.end_lineno or found.lineno


def mutated(text: str, mutant: Mutant) -> str:
    """A module's text with the change.

    Raises
    ------
    ValueError
        If the function does not have the text exactly once, or there is no such function.
    """
    lines = text.splitlines(keepends=True)
    first, last = function_lines(text, mutant.function)
    before = "".join(lines[first:last])
    if before.count(mutant.was) != 1:
        raise ValueError(f"{mutant.file}: {mutant.function} has `{mutant.was}` {before.count(mutant.was)} times")
    return "".join(lines[:first]) + before.replace(mutant.was, mutant.now) + "".join(lines[last:])


def copy_of_sources(folder: Path) -> None:
    """Make a copy of what is compiled and tested; all else is only linked."""
    for path in ROOT.iterdir():
        if path.name in COPIED:
            shutil.copytree(path, folder / path.name, ignore=LEFT_OUT)
        elif not path.name.startswith(".") and not path.name.endswith(".egg-info"):
            (folder / path.name).symlink_to(path)


def tested(folder: Path, tests: Sequence[str], cache: Path, plain: bool) -> Outcome:
    """Run tests of a copy until one fails."""
    paths = os.pathsep.join(str(folder / name) for name in ("core", "apps"))
    env = os.environ | {"PYTHONPATH": paths, "TAUTLINE_CACHE": str(cache), "PYTHONDONTWRITEBYTECODE": "1"}
    env["NUMBA_DISABLE_JIT"] = "1" if plain else "0"
    where = "import tautline, crane; print(tautline.__file__, crane.__file__)"
    seen = subprocess.run([sys.executable, "-c", where], env=env, cwd=folder, capture_output=True, text=True)
    if seen.stdout.count(str(folder)) != 2:
        return Outcome("", f"the copy is not what is tested: {seen.stdout}{seen.stderr}", 0.0)
    begun = time.monotonic()
    command = [sys.executable, "-m", "pytest", "-x", "-q", "-rfE", "-p", "no:cacheprovider", "--tb=line"]
    command += ["--ignore", "tests/compiling"]  # How kernels are compiled is not what is changed.
    try:
        done = subprocess.run(
            [*command, *(f"tests/{test}" for test in tests)], env=env, cwd=folder, capture_output=True, text=True,
            timeout=LONGEST,
        )  # fmt: skip
    except subprocess.TimeoutExpired:
        return Outcome("", f"not done after {LONGEST:.0f} s", LONGEST)
    seconds = time.monotonic() - begun
    if done.returncode == 0:
        return Outcome("", "", seconds)
    found = FAILED.search(done.stdout)
    if done.returncode != 1 or found is None:
        return Outcome("", f"pytest ended with {done.returncode}: {(done.stdout + done.stderr)[-2000:]}", seconds)
    return Outcome(found[1].removeprefix("tests/"), "", seconds)


def outcome(mutant: Mutant, work: Path) -> Outcome:
    """What tests say of a copy with a change: the one that fails, which passes without the change."""
    with tempfile.TemporaryDirectory(dir=work) as name:
        folder = Path(name)
        copy_of_sources(folder)
        path = folder / mutant.file
        text = path.read_text(encoding="utf8")
        path.write_text(mutated(text, mutant), encoding="utf8")
        found = tested(folder, mutant.tests, work / "kernels", mutant.plain)
        if found.killer:
            path.write_text(text, encoding="utf8")
            control = tested(folder, [found.killer], work / "kernels", mutant.plain)
            if control.killer or control.fault:
                return Outcome("", f"{found.killer} fails without the change too{control.fault}", found.seconds)
        return found


def outcomes(mutants: Sequence[Mutant], workers: int) -> Iterator[tuple[Mutant, Outcome]]:
    """Each mutant with what became of it, some at a time."""
    with tempfile.TemporaryDirectory() as name, ThreadPoolExecutor(workers) as pool:
        work = Path(name)
        if (known := storage.root()).is_dir():
            shutil.copytree(known, work / "kernels" / storage.OWN)
        waiting = [pool.submit(outcome, mutant, work) for mutant in mutants]
        for mutant, each in zip(mutants, waiting, strict=True):
            yield mutant, each.result()


def rows(found: Sequence[tuple[Mutant, Outcome]]) -> Iterator[tuple[str, ...]]:
    """Rows of the table."""
    for mutant, what in found:
        file, _, test = what.killer.partition("::")
        killer = f"`tests/{file}`: {test.replace('|', ' ')}" if what.killer else f"**survived** {what.fault}"
        yield f"`{mutant.file}`, `{mutant.function}`", mutant.what, killer, f"{what.seconds:.0f}"


def main() -> None:
    """Change, test, and write the table."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--quick", action="store_true", help="the first two only; writes nothing")
    parser.add_argument("names", nargs="*", help="parts of files or functions; writes nothing")
    parser.add_argument("-j", "--jobs", type=int, default=os.cpu_count(), help="how many at a time")
    asked, before = parser.parse_args(), load()
    chosen = [m for m in MUTANTS if not asked.names or any(name in f"{m.file}:{m.function}" for name in asked.names)]
    found = []
    for mutant, what in outcomes(chosen[:2] if asked.quick else chosen, asked.jobs):
        found.append((mutant, what))
        told = what.killer or f"SURVIVED {what.fault}"
        print(f"{mutant.file}: {mutant.function}: {told} ({what.seconds:.0f} s)", flush=True)
    killed = sum(bool(what.killer) for _, what in found)
    header = ("kernel", "change", "first test that fails", "s")
    text = f"{killed} of {len(found)} are killed.\n\n{table(header, rows(found))}\n{machine(before)}.\n"
    print(text)
    if not asked.quick and not asked.names:
        begin, end = MARKS
        page = PAGE.read_text(encoding="utf8")
        PAGE.write_text(between(page, f"{begin}\n{text}{end}", begin, end), encoding="utf8")
    if killed < len(found):
        sys.exit(1)


if __name__ == "__main__":
    main()
