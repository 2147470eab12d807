"""The slave of FMI 2.0, as PythonFMU makes it: only the FMU's own script imports this."""

from __future__ import annotations

from typing import Any
from xml.etree.ElementTree import Element, SubElement

from pythonfmu import Fmi2Slave
from pythonfmu.default_experiment import DefaultExperiment
from pythonfmu.enums import Fmi2Causality, Fmi2Initial, Fmi2Status, Fmi2Variability
from pythonfmu.variables import Real

from tautline.errors import TautlineError
from tautline.live.fmu.unit import Core, from_bytes, to_bytes
from tautline.version import __version__

BASE = {
    "m": {"m": 1}, "m/s": {"m": 1, "s": -1}, "m/s^2": {"m": 1, "s": -2}, "rad": {"rad": 1},
    "rad/s": {"rad": 1, "s": -1}, "N": {"kg": 1, "m": 1, "s": -2}, "N m": {"kg": 1, "m": 2, "s": -2}, "kg": {"kg": 1},
    "s": {"s": 1}, "1/s": {"s": -1},
    "W": {"kg": 1, "m": 2, "s": -3}, "J": {"kg": 1, "m": 2, "s": -2}, "kg m^2": {"kg": 1, "m": 2}, "1/m": {"m": -1},
    "N s/m": {"kg": 1, "s": -1}, "N s^2/m^2": {"kg": 1, "m": -1}, "N m^2": {"kg": 1, "m": 3, "s": -2},
    "kg/m": {"kg": 1, "m": -1},
}  # fmt: skip
"""Units that are written, by their base units."""
ORDER = ("UnitDefinitions", "TypeDefinitions", "LogCategories")


class Unit(Fmi2Slave):
    """A simulation as an FMI 2.0 slave."""

    author = "Tautline"
    version = __version__

    def __init__(self, **kwargs: Any) -> None:
        super().__init__(**kwargs)
        self.core = core = Core(str(self.resources))
        self.modelName = core.told["name"]
        self.description = core.sim.scene.title or "a Tautline scene"
        solver = core.sim.model.solver
        self.default_experiment = DefaultExperiment(0.0, solver.end, solver.interval)
        self.units: dict[str, str] = {}
        sim = core.sim
        for name in core.inputs:
            one = sim.inputs.handle(name).steering
            self._add(name, one.unit, one.text, Fmi2Causality.input, Fmi2Variability.continuous)
        for name, (output, _) in core.outputs.items():
            one = sim.outputs.handle(output)
            self._add(
                name, one.unit, one.text, Fmi2Causality.output, Fmi2Variability.continuous, Fmi2Initial.calculated
            )
        for name, told in sim.parameters.describe().items():
            if name not in self.units:
                self._add(
                    name,
                    told["unit"],
                    told["text"],
                    Fmi2Causality.parameter,
                    Fmi2Variability.tunable,
                    Fmi2Initial.exact,
                )

    def _add(self, name: str, unit: str, text: str, causality: Any, variability: Any, initial: Any = None) -> None:
        self.units[name] = unit
        setter = None if causality == Fmi2Causality.output else (lambda value: self.core.set(name, value))
        variable = Real(
            name, causality=causality, variability=variability, initial=initial, description=text,
            getter=lambda: self.core.get(name), setter=setter,
        )  # fmt: skip
        self.register_variable(variable, nested=False)

    def to_xml(self, model_options: Any = None) -> Element:
        """The model description, with units and the unknowns of the initialisation."""
        root = super().to_xml(model_options or {})
        # Names of things may have blanks.
        root.set("variableNamingConvention", "flat")
        used = [unit for unit in dict.fromkeys(self.units.values()) if unit in BASE]
        definitions = Element("UnitDefinitions")
        for unit in used:
            SubElement(
                SubElement(definitions, "Unit", {"name": unit}), "BaseUnit", {k: str(n) for k, n in BASE[unit].items()}
            )
        if used:
            root.insert(1, definitions)
        variables = root.find("ModelVariables")
        assert variables is not None
        for variable in variables:
            unit = self.units[variable.attrib["name"]]
            if unit in BASE:
                variable[0].set("unit", unit)
        structure = root.find("ModelStructure")
        assert structure is not None
        unknowns = SubElement(structure, "InitialUnknowns")
        for outputs in structure.findall("Outputs"):
            for unknown in outputs:
                SubElement(unknowns, "Unknown", dict(unknown.attrib))
        return root

    def setup_experiment(
        self, start_time: float, stop_time: float | None = None, tolerance: float | None = None
    ) -> None:
        """Take the host's time of the start."""
        self.core.begin = float(start_time)

    def exit_initialization_mode(self) -> None:
        """Find the start with the parameters as they are now."""
        self._guarded(lambda: self.core.ready)

    def do_step(self, current_time: float, step_size: float) -> bool:
        """One communication step; a failure is told in the host's log."""
        return self._guarded(lambda: self.core.step(current_time, step_size))

    def _guarded(self, act: Any) -> bool:
        try:
            act()
        except TautlineError as error:
            self.log(str(error), Fmi2Status.error)
            return False
        return True

    def _get_fmu_state(self) -> dict[str, Any]:
        return self.core.save()

    def _set_fmu_state(self, state: dict[str, Any]) -> None:
        self.core.restore(state)

    @staticmethod
    def _fmu_state_to_bytes(state: dict[str, Any]) -> bytes:
        return to_bytes(state)

    @staticmethod
    def _fmu_state_from_bytes(state: bytes) -> dict[str, Any]:
        return from_bytes(state)
