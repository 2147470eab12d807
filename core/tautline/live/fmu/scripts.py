"""The script of an FMU: the class that the library of PythonFMU makes in the host's Python."""

from __future__ import annotations

SCRIPTS = {
    2: '''"""Written by Tautline: the class that the host makes."""

from pythonfmu import Fmi2Slave

from tautline.live.fmu import fmi2, unit


class Scene(Fmi2Slave):
    """A Tautline scene."""

    def __init__(self, **kwargs):
        super().__init__(**kwargs)
        self.unit = fmi2.Unit(self)

    def to_xml(self, model_options=None):
        return self.unit.complete(super().to_xml(model_options or {}))

    def setup_experiment(self, start_time, stop_time=None, tolerance=None):
        self.unit.core.start_at(start_time)

    def exit_initialization_mode(self):
        self.unit.initialise()

    def do_step(self, current_time, step_size):
        return self.unit.step(current_time, step_size)

    def _get_fmu_state(self):
        return self.unit.core.save()

    def _set_fmu_state(self, state):
        self.unit.restore(state)

    _fmu_state_to_bytes = staticmethod(unit.to_bytes)
    _fmu_state_from_bytes = staticmethod(unit.state_from_bytes)
''',
    3: '''"""Written by Tautline: the class that the host makes."""

from pythonfmu3 import Fmi3Slave

from tautline.live.fmu.fmi3 import Unit


class Scene(Unit, Fmi3Slave):
    """A Tautline scene."""
''',
}
"""By version of the standard. A class of FMI 2 has no base but PythonFMU's: see `tautline.live.fmu.fmi2`.

The class has one name whatever the FMU's: the name of a file would hide one that the script uses, or be none in Python.
"""
