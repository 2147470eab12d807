"""A little application, a little model and a little `tautline.simulation`, to try the command line without a solver."""

from __future__ import annotations

import os
import sys
import time
import types
from dataclasses import dataclass, replace
from pathlib import Path

from tautline.scene.errors import Problem, SceneError, SceneWarning

INTERVAL = 0.1


@dataclass(frozen=True)
class Settings:
    method: str = "generalized-alpha"
    step: float = 0.01
    end: float = 2.0


@dataclass(frozen=True)
class FakeScene:
    text: str
    solver: Settings
    trouble: str = ""


class FakeApplication:
    name = "fake"
    title = "A pendulum that pretends to be a drill string."

    @property
    def templates(self):
        return {"pendulum": "# A pendulum.\nfake: true\n", "other": "# Another.\nfake: true\n"}

    def recognises(self, root):
        return "fake" in root

    def read(self, path):
        try:
            text = Path(getattr(path, "path", path)).read_text()  # a file, or the document that was read of it
        except OSError as error:
            raise SceneError([Problem(str(path), None, "", None, "there is no such file", "check the name")]) from error
        if "fake" not in text:
            raise SceneError([Problem(str(path), 1, "fake", None, "is missing", "add fake: true")])
        words = [line.split(":")[1].strip() for line in text.splitlines() if line.startswith("trouble:")]
        return FakeScene(text, Settings(), words[0] if words else "")

    def with_overrides(self, scene, method=None, step=None, end=None, rho_inf=None):
        if step is not None and step <= 0:
            raise SceneError([Problem("--step", None, "solver.step", str(step), "must be above zero", "take 1e-3")])
        given = {"method": method, "step": step, "end": end}
        chosen = {key: value for key, value in given.items() if value is not None}
        return replace(scene, solver=replace(scene.solver, **chosen))

    def schema(self):
        return {"type": "object", "title": "fake"}

    def warnings(self, scene):
        return [SceneWarning("solver.step", "longer than the critical step")] if scene.trouble == "warning" else []

    def check_figures(self, scene):
        return {"length": 1.0}

    def build(self, scene):
        if scene.trouble == "unbuildable":
            raise SceneError([Problem("fake.yaml", 3, "trouble", "unbuildable", "cannot be built", "remove it")])
        if scene.trouble == "bug":
            raise ZeroDivisionError("nobody\nforesaw this")
        return FakeModel(scene)

    def figures(self, results, folder, what, formats, stem):
        from tautline.results.errors import ResultError

        known = ("overview", "tension")
        for name in what:
            if name not in known:
                raise ResultError("--what", f"unknown figure '{name}'", f"known: {', '.join(known)}")
        files = []
        for name in what or known:
            for ending in formats:
                full = stem if stem and len(what) == 1 else f"{stem or results[0].path.stem}_{name}"
                files.append(folder / f"{full}.{ending}")
                files[-1].write_text("a picture")
        return files


class FakeModel:
    def __init__(self, scene):
        from tautline.results.variable import Variable

        self.scene, self.solver = scene, scene.solver
        self.variables = [
            Variable("angle", ("time",), "rad", "angle"),
            Variable("tension", ("time", "link"), "N", "tension"),
        ]
        self.coordinates = {}
        self.attributes = {"scene": scene.text, "method": scene.solver.method, "step": scene.solver.step}
        self.attributes |= {"end": scene.solver.end, "version": "0"}

    def observe(self, times):
        import numpy as np

        return {"time": times, "angle": np.cos(times), "tension": np.outer(1e6 + times, [1.0, 2.0, 3.0])}


def simulate(model, path=None, progress=None, resume=None, announce=None, afterwards=None, begin=None):
    """Stand-in for `tautline.simulation.simulate`."""
    import numpy as np

    from tautline.integrators.status import Interrupted, Status, StoppedEarly
    from tautline.results.headline import Figure
    from tautline.results.store import Store

    if begin is not None:
        begin()
    pause = float(os.environ.get("FAKE_PAUSE", "0"))
    started, reached = time.perf_counter(), 0.0
    with Store(path, model.variables, model.coordinates, model.attributes) as store:

        def finish(status):
            wall = time.perf_counter() - started
            numbers = {"steps": 200, "newton_iterations": 420, "halvings": 1, "energy_error": float("nan")}
            headline = {"largest_tension": Figure(float(store.result["tension"].max()), "N", "largest tension")}
            headline["odd"] = Figure(float("inf"), "", "a number that is none")
            numbers |= {"wall_time": wall, "real_time_factor": wall / max(reached, 1e-9), "headline": headline}
            return store.finish({"status": status, **numbers})

        try:
            if os.environ.get("FAKE_COLD") == "1" and announce is not None:
                announce(3)
            for first in np.arange(0.0, model.solver.end - 1e-9, 10 * INTERVAL):
                store.append(model.observe(first + INTERVAL * np.arange(10)))
                reached = first + 10 * INTERVAL
                if progress is not None:
                    progress(reached, time.perf_counter() - started)
                if model.scene.trouble == "stops":
                    raise StoppedEarly(Status.NOT_CONVERGED, reached, "link 2", result=finish("stopped"))
                time.sleep(pause)
        except KeyboardInterrupt:
            raise Interrupted(reached, finish("interrupted")) from None
        return finish("done")


def install():
    """Put the stand-ins where the command line looks for the real ones."""
    stub = types.ModuleType("tautline.simulation")
    stub.simulate = simulate
    sys.modules["tautline.simulation"] = stub


def main():
    install()
    from tautline.cli.run import run
    from tautline.cli.verbs import make_app

    run(make_app(FakeApplication()))


if __name__ == "__main__":
    main()
