"""The script of an FMU: the class that the library of PythonFMU makes in the host's Python."""

from __future__ import annotations

from hashlib import sha256

from tautline.version import __version__

HEAD = '''"""Written by Tautline: the class that the host makes."""

import sys

from PYTHONFMU import SLAVE

FAULT = ""
try:
    from tautline.version import __version__

    if __version__ != "VERSION":
        raise ImportError(f"Tautline {__version__} is installed")
    from tautline.live.fmu import MODULES
except Exception as error:
    FAULT = (
        f"{error}. The FMU was written by Tautline VERSION, and its host needs the same: "
        f'in the Python {sys.executable or sys.prefix}, pip install "tautline[fmi]==VERSION"'
    )
'''
"""What both begin with. An error of the import itself ends a host of FMI 3 and names no cure: the class raises it.

Another version is refused: it may compute other numbers, and read neither the scene nor a state.
"""
BODIES = {
    2: '''

class Scene(Fmi2Slave):
    """A Tautline scene."""

    def __init__(self, **kwargs):
        super().__init__(**kwargs)
        if FAULT:
            # PythonFMU hands it to the host's logger, if that is asked to log, which takes it for a format of printf.
            print(FAULT, file=sys.stderr, flush=True)
            raise ImportError(FAULT.replace("%", "%%"))
        self.unit = fmi2.Unit(self)

    def to_xml(self, model_options=None):
        return self.unit.complete(super().to_xml(model_options or {}))

    def setup_experiment(self, start_time, stop_time=None, tolerance=None):
        self.unit.core.start_at(start_time)

    def exit_initialization_mode(self):
        self.unit.initialise()

    def terminate(self):
        self.unit.core.terminate()

    def do_step(self, current_time, step_size):
        return self.unit.step(current_time, step_size)

    def _get_fmu_state(self):
        return self.unit.save()

    def _set_fmu_state(self, state):
        self.unit.restore(state)

    @staticmethod
    def _fmu_state_to_bytes(state):
        return unit.to_bytes(state)

    @staticmethod
    def _fmu_state_from_bytes(state):
        return unit.state_from_bytes(state)
''',
    3: '''

class Missing:
    """What stands for a scene that cannot be read."""

    def __new__(cls, **kwargs):
        raise ImportError(FAULT)


Unit = Missing if FAULT else fmi3.Unit


class Scene(Unit, Fmi3Slave):
    """A Tautline scene."""
''',
}
"""By version of the standard. A class of FMI 2 has no base but PythonFMU's: see `tautline.live.fmu.fmi2`.

The class has one name whatever the FMU's: the name of a file would hide one that the script uses, or be none in Python.
"""
NAMES = {
    2: {"PYTHONFMU": "pythonfmu", "SLAVE": "Fmi2Slave", "MODULES": "fmi2, unit"},
    3: {"PYTHONFMU": "pythonfmu3", "SLAVE": "Fmi3Slave", "MODULES": "fmi3"},
}
"""What stands in the head for its words in capitals, by version of the standard."""


def script_of(fmi: int) -> str:
    """The script of an FMU by version of the standard, 2 or 3."""
    script = HEAD + BODIES[fmi]
    for word, told in {**NAMES[fmi], "VERSION": __version__}.items():
        script = script.replace(word, told)
    return script


def module_of(script: str) -> str:
    """The name of a script's module, which no other script has.

    A host's Python imports by name, once: of two scripts of one name it would run the first for both FMUs, though the
    second is of another version of the standard, or of Tautline and is to be refused.
    """
    return f"tautline_unit_{sha256(script.encode()).hexdigest()[:16]}"
