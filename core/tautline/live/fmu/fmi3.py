"""The slave of FMI 3.0, as PythonFMU3 makes it: only the FMU's own script imports this."""

from __future__ import annotations

from functools import partial
from typing import Any
from xml.etree.ElementTree import Element

from pythonfmu3 import Fmi3Slave
from pythonfmu3.default_experiment import DefaultExperiment
from pythonfmu3.enums import Fmi3Causality, Fmi3Initial, Fmi3Status, Fmi3Variability
from pythonfmu3.fmi3slave import Fmi3StepResult
from pythonfmu3.unit import Unit as NamedUnit
from pythonfmu3.variables import Float64

from tautline.errors import TautlineError
from tautline.live.fmu.unit import BASE, Core, no_state, state_from_bytes, to_bytes
from tautline.version import __version__

KINDS: dict[str, dict[str, Any]] = {
    "input": {"causality": Fmi3Causality.input, "variability": Fmi3Variability.continuous},
    "output": {
        "causality": Fmi3Causality.output, "variability": Fmi3Variability.continuous, "initial": Fmi3Initial.calculated
    },
    "parameter": {
        "causality": Fmi3Causality.parameter, "variability": Fmi3Variability.tunable, "initial": Fmi3Initial.exact
    },
}  # fmt: skip


class Unit(Fmi3Slave):
    """A simulation as an FMI 3.0 slave.

    PythonFMU3 drops the start time that the host gives: the first step says it.
    """

    def __init__(self, **kwargs: Any) -> None:
        super().__init__(**kwargs)
        self.author, self.version = "Tautline", __version__
        self.core = core = Core(str(self.resources))
        self.modelName = core.told["name"]
        self.description = core.sim.scene.title or "a Tautline scene"
        solver = core.sim.model.solver
        self.default_experiment = DefaultExperiment(0.0, solver.end, solver.interval)
        signals = core.signals()
        used = [unit for unit in dict.fromkeys(("s", *(unit for _, unit, _, _ in signals))) if unit in BASE]
        self.register_units([NamedUnit(unit, **BASE[unit]) for unit in used])
        clock = Float64(
            "time", description="simulated time", unit="s", causality=Fmi3Causality.independent,
            variability=Fmi3Variability.continuous, getter=lambda: core.begin + core.sim.time,
            setter=lambda value: self._guarded(core.refuse_time),
        )  # fmt: skip
        self.register_variable(clock, nested=False)
        for name, unit, text, kind in signals:
            variable = Float64(
                name, description=text, unit=unit if unit in BASE else None, getter=lambda name=name: core.get(name),
                setter=partial(self._refuse if kind == "output" else self._set, name), **KINDS[kind],
            )  # fmt: skip
            self.register_variable(variable, nested=False)

    def to_xml(self, model_options: Any = None) -> Element:
        """The model description; names of things may have blanks."""
        root = super().to_xml(model_options or {})
        root.set("variableNamingConvention", "flat")
        # PythonFMU3 takes one name for the model and its library. Only that of the library has to be one of C.
        root.set("modelName", self.core.told["title"])
        return root

    def exit_initialization_mode(self) -> None:
        """Find the start with the parameters and inputs as they are now."""
        self._guarded(self.core.initialise)

    def terminate(self) -> None:
        """Take no further step."""
        self.core.terminate()

    def do_step(self, current_time: float, step_size: float) -> Fmi3StepResult:
        """One communication step; a failure is told in the host's log."""
        done = self._guarded(lambda: self.core.asked_step(current_time, step_size))
        return Fmi3StepResult(status=Fmi3Status.ok if done else Fmi3Status.error)

    def _set(self, name: str, value: float) -> None:
        """Set an input or a parameter. PythonFMU has no way to say that it is refused but the log: steps then fail."""
        self._guarded(lambda: self.core.set(name, value))

    def _refuse(self, name: str, value: float) -> None:
        """What a host gives an output: it is told in the log, and nothing is changed."""
        self._guarded(lambda: self.core.refuse_output(name))

    def _guarded(self, act: Any) -> bool:
        try:
            act()
        except TautlineError as error:
            self.log(str(error), Fmi3Status.error)
            return False
        return True

    def _get_fmu_state(self) -> dict[str, Any]:
        try:
            return self.core.save()
        except TautlineError as error:
            self.log(str(error), Fmi3Status.error)
            return no_state(str(error))

    def _set_fmu_state(self, state: dict[str, Any]) -> None:
        self._guarded(lambda: self.core.restore(state))

    @staticmethod
    def _fmu_state_to_bytes(state: dict[str, Any]) -> bytes:
        return to_bytes(state)

    @staticmethod
    def _fmu_state_from_bytes(state: bytes) -> dict[str, Any]:
        return state_from_bytes(state)
