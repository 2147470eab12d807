"""What the slave of FMI 2.0 asks, which PythonFMU makes of the FMU's own script: only that imports this."""

from __future__ import annotations

from functools import partial
from typing import Any
from xml.etree.ElementTree import Element, SubElement

from pythonfmu import Fmi2Slave
from pythonfmu.default_experiment import DefaultExperiment
from pythonfmu.enums import Fmi2Causality, Fmi2Initial, Fmi2Status, Fmi2Variability
from pythonfmu.variables import Real

from tautline.errors import TautlineError
from tautline.live.errors import SimulationError
from tautline.live.fmu.unit import BASE, Core, no_state
from tautline.version import __version__

KINDS: dict[str, dict[str, Any]] = {
    "input": {"causality": Fmi2Causality.input, "variability": Fmi2Variability.continuous},
    "output": {
        "causality": Fmi2Causality.output, "variability": Fmi2Variability.continuous, "initial": Fmi2Initial.calculated
    },
    "parameter": {
        "causality": Fmi2Causality.parameter, "variability": Fmi2Variability.tunable, "initial": Fmi2Initial.exact
    },
}  # fmt: skip


def as_format(error: Exception) -> str:
    """What an error says, as a format of printf: the host's logger of FMI 2 takes any text for one."""
    return str(error).replace("%", "%%")


class Unit:
    """A simulation that an FMI 2.0 slave asks for all that it is.

    It is no slave itself: PythonFMU's library runs a line of its own in the namespace of the second instance's script,
    and a process that holds two ends there if the class has a base from elsewhere than PythonFMU.

    Parameters
    ----------
    slave : Fmi2Slave
        Made already; variables are registered with it.

    Raises
    ------
    SimulationError
        Where the scene cannot be read or no start is found.
    """

    def __init__(self, slave: Fmi2Slave) -> None:
        self.slave = slave
        try:
            self.core = core = Core(str(slave.resources))
        except TautlineError as error:
            # PythonFMU hands it to the host's logger.
            raise SimulationError(as_format(error)) from None
        slave.author, slave.version = "Tautline", __version__
        slave.modelName = core.told["name"]
        slave.description = core.sim.scene.title or "a Tautline scene"
        solver = core.sim.model.solver
        slave.default_experiment = DefaultExperiment(0.0, solver.end, solver.interval)
        self.units: dict[str, str] = {}
        for name, unit, text, kind in core.signals():
            self.units[name] = unit
            variable = Real(
                name, description=text, getter=lambda name=name: core.get(name),
                setter=partial(self._refuse if kind == "output" else self._set, name), **KINDS[kind],
            )  # fmt: skip
            slave.register_variable(variable, nested=False)

    def complete(self, root: Element) -> Element:
        """The model description, with units and the unknowns of the initialisation."""
        # PythonFMU takes one name for the model and its library. Only that of the library has to be one of C.
        root.set("modelName", self.core.told["title"])
        # Names of things may have blanks.
        root.set("variableNamingConvention", "flat")
        used = [unit for unit in dict.fromkeys(self.units.values()) if unit in BASE]
        definitions = Element("UnitDefinitions")
        for unit in used:
            base = {name: str(power) for name, power in BASE[unit].items()}
            SubElement(SubElement(definitions, "Unit", {"name": unit}), "BaseUnit", base)
        if used:
            root.insert(1, definitions)
        for variable in root.findall("ModelVariables/ScalarVariable"):
            unit = self.units[variable.attrib["name"]]
            if unit in BASE:
                variable[0].set("unit", unit)
        for structure in root.findall("ModelStructure"):
            unknowns = SubElement(structure, "InitialUnknowns")
            for unknown in structure.findall("Outputs/Unknown"):
                SubElement(unknowns, "Unknown", dict(unknown.attrib))
        return root

    def initialise(self) -> None:
        """Find the start with the parameters and inputs as they are now."""
        self._guarded(self.core.initialise)

    def step(self, current_time: float, step_size: float) -> bool:
        """One communication step; a failure is told in the host's log."""
        return self._guarded(lambda: self.core.asked_step(current_time, step_size))

    def save(self) -> dict[str, Any]:
        """All that a state is. Where no start is found it is told in the host's log, and the state is none."""
        try:
            return self.core.save()
        except TautlineError as error:
            self._tell(error)
            return no_state(str(error))

    def restore(self, state: dict[str, Any]) -> None:
        """Stand where a state was saved; what is none is told in the host's log, and steps fail until one is set."""
        self._guarded(lambda: self.core.restore(state))

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
            self._tell(error)
            return False
        return True

    def _tell(self, error: TautlineError) -> None:
        self.slave.log(as_format(error), Fmi2Status.error)
