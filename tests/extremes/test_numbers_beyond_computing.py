"""Numbers at the ends of what a computer holds: refused where they are read, with line and key, or without effect.

Each scene exits 2 with one message and writes nothing, or exits 0; never is there a warning of NumPy's.
"""

import numpy as np
import pytest
import yaml
from extremes.fuzzing import outcome
from extremes.mutations import Case, scenes
from of_the_suite import studies

from tautline.kernels.time_function import sample
from tautline.scene.functions import Table
from tautline.scene.values.magnitude import LARGEST, SMALLEST
from tautline.system.time_functions import FunctionRequest, compile_functions


def checked(application, name, tmp_path, *changes, table=None, verb="check"):
    """Outcome of a verb on a shipped scene with other values at some places."""
    root = yaml.safe_load(yaml.safe_dump(dict(scenes(application))[name]))
    for place, value in changes:
        parent = root
        for key in place[:-1]:
            parent = parent[key]
        parent[place[-1]] = value
    files = {"scene.yaml": yaml.safe_dump(root).encode()} | ({"table.csv": table.encode()} if table else {})
    return outcome(Case("own", 0, application, name, files), verb, tmp_path / f"{len(list(tmp_path.iterdir()))}")


def refused(end, *words):
    """Bad input, told once, with all of some words, and nothing written."""
    assert (end.code, end.warned, end.written, end.failure) == (2, [], [], "")
    assert len(end.said.splitlines()) == 1 and "unexpected" not in end.said
    for word in words:
        assert word in end.said


# Key of a function of time in a scene of each application, and how it is called in messages.
FUNCTIONS = {
    "drillstring": ("vertical", ("top", "block"), "top.block"),
    "crane": ("lift", ("path", 0, "drum", "pay_out"), "path[0].drum.pay_out"),
    "gardenhose": ("hose", ("water", "speed"), "water.speed"),
    "cable": ("reeled_span", ("CableModel", -1, "Function_VelocityDefined"), "Function"),
}
WRITTEN = {
    "a ramp to": ({"ramp": {"to": 1e308, "over": 1.0}}, "to"),
    "a ramp over": ({"ramp": {"to": 1.0, "over": 1e308}}, "over"),
    "a ramp in no time": ({"ramp": {"to": 1.0, "over": 1e-308}}, "over"),
    "a ramp's rate": ({"ramp": {"rate": -1e300, "over": 1.0}}, "rate"),
    "a period of nothing": ({"harmonic": {"amplitude": 1.0, "period": 1e-308}}, "period"),
    "a frequency beyond all": ({"harmonic": {"amplitude": 1.0, "frequency": 1e308}}, "frequency"),
    "a frequency of nothing": ({"harmonic": {"amplitude": 1.0, "frequency": 5e-324}}, "frequency"),
    "an amplitude beyond all": ({"harmonic": {"amplitude": 1e308, "period": 1.0}}, "amplitude"),
    "a phase beyond all": ({"harmonic": {"amplitude": 1.0, "period": 1.0, "phase": 1e308}}, "phase"),
    "a chirp's rate": ({"chirp": {"amplitude": 1.0, "period": 20.0, "rate": 1e308}}, "rate"),
    "a chirp's shift": ({"chirp": {"amplitude": 1.0, "period": 20.0, "rate": 1.0, "shift": 1e308}}, "shift"),
    "a sea's height": ({"spectrum": {"significant_height": 1e308, "peak_period": 9.0}}, "significant_height"),
    "a sea's period": ({"spectrum": {"significant_height": 1.0, "peak_period": 1e-308}}, "peak_period"),
    "a table's value": ({"table": {"time": [0, 1], "value": [0, 1e308]}}, "value[1]"),
    "a table's times": ({"table": {"time": [0, 1e-308], "value": [0, 1]}}, "time[1]"),
    "a term of a sum": ({"sum": [{"constant": 1.0}, {"constant": -1e308}]}, "sum[1].constant"),
}


@pytest.mark.parametrize("application", ["drillstring", "crane", "gardenhose"])
@pytest.mark.parametrize("written", WRITTEN)
def test_a_function_of_time_of_1e308_or_1e_minus_308_is_refused_by_its_key(application, written, tmp_path):
    name, place, key = FUNCTIONS[application]
    function, odd = WRITTEN[written]
    refused(checked(application, name, tmp_path, (place, function)), key, odd)


DIVISORS = {
    "drillstring": [
        ("vertical", ("well", "diameter")), ("vertical", ("string", 0, "od")), ("jwell", ("well", "wall", "stiffness")),
        ("vertical", ("solver", "end")), ("vertical", ("material", "youngs_modulus")),
        ("configuration_c", ("string", 1, "second_moment")), ("drilling", ("bit", "penetration", "rate")),
        ("jwell", ("mud", "density")), ("vertical", ("output", "interval")),
    ],
    "crane": [
        ("lift", ("rope", "mass_per_length")), ("lift", ("rope", "axial_stiffness")), ("lift", ("bodies", 0, "mass")),
        ("lift", ("path", 0, "drum", "radius")), ("hoist", ("path", 1, "sheave", "inertia")),
        ("hoist", ("rope", "breaking_load")), ("hoist", ("rope", "diameter")), ("lift", ("solver", "step")),
    ],
    "gardenhose": [
        ("hose", ("hose", "length")), ("hose", ("hose", "axial_stiffness")), ("hose", ("hose", "mass_per_length")),
        ("hose", ("water", "mass_per_length")), ("hose", ("hose", "damping")), ("hose", ("solver", "end")),
    ],
    "cable": [
        ("cantilever_bar", ("CableModel", 3, "CableALEelement", "EA")),
        ("cantilever_bar", ("CableModel", 3, "CableALEelement", "rhoA")),
        ("cantilever_bar", ("GeneralizedAlpha", "time_step")), ("cantilever_bar", ("GeneralizedAlpha", "time_end")),
    ],
}  # fmt: skip


@pytest.mark.parametrize("value", [1e308, 1e-308, *studies(5e-324, 1e155)])
@pytest.mark.parametrize(
    ("application", "name", "place"), [(a, *place) for a, places in DIVISORS.items() for place in places],
    ids=lambda value: ".".join(map(str, value)) if isinstance(value, tuple) else None,
)  # fmt: skip
def test_a_size_of_1e308_or_1e_minus_308_is_refused_by_its_key(application, name, place, value, tmp_path):
    refused(checked(application, name, tmp_path, (place, value)), str(place[-1]))


@pytest.mark.parametrize("value", [1e155, -1e308])
def test_a_force_beyond_all_is_refused(value, tmp_path):
    place = ("CableModel", 5, "PointForce", "force", 1)
    refused(checked("cable", "cantilever_bar", tmp_path, (place, value)), "force[1]", "from 1e-30 to 1e+30")


def test_a_hole_so_deep_that_its_string_is_lost_in_rounding_is_refused(tmp_path):
    for place, value, key in (
        (("well", "sections", 0), {"hold": 1e29}, "well.sections[0].hold"),
        (("string", 1, "length"), "1e-15 m", "string[1].length"),
    ):
        end = checked("drillstring", "jwell", tmp_path, (place, value))
        assert (end.code, end.warned, end.written, end.failure) == (2, [], [], "")
        # First the number that is probably in a wrong unit, then what it leads to.
        cause, lost = end.said.splitlines()
        assert key in cause and "string[1].length" in lost and "lost in rounding" in lost


def test_an_azimuth_of_many_turns_is_the_one_that_is_left(tmp_path):
    """360 degrees a hundred times are none, and 1e19 degrees are something."""
    place = ("well", "sections", 1, "build", "azimuth")
    ends = [checked("drillstring", "tripping", tmp_path, (place, f"{30 + 360 * n} deg")) for n in (0, 1, 100, 10**16)]
    assert [(end.code, end.warned) for end in ends] == [(0, [])] * 4
    # more than a turn is warned of; what is computed is the same
    without = [end.said[end.said.index("measured depth") :].split(str(end.scene))[0] for end in ends]
    assert without[0] == without[1] == without[2]


@pytest.mark.parametrize("cell", ["1e308", "-1e308", "1e31"])
def test_a_table_s_cell_beyond_all_is_refused_by_its_line(cell, tmp_path):
    drawn = (("water", "speed"), {"table": {"file": "table.csv"}})
    end = checked("gardenhose", "hose", tmp_path, drawn, table=f"time,value\n0,0\n1,{cell}\n2,0\n")
    refused(end, "table.csv:3", cell, "from 1e-30 to 1e+30")


def test_a_table_that_rises_by_next_to_nothing_is_flat_there():
    """A secant of 5e-324 has a slope of nothing, without a word of NumPy's."""
    table = Table(time=(0.0, 1.0, 2.0, 3.0), value=(0.0, 5e-324, 1.0, 1.0), interpolation="cubic")
    with np.errstate(all="raise", under="ignore"):
        found = sample(compile_functions([FunctionRequest(table)]), 0, np.linspace(0.0, 3.0, 31))
    assert np.isfinite(found).all() and np.abs(found[:11, 0]).max() < 1e-300 and found[:, 0].max() <= 1.0 + 1e-12


def test_a_direction_may_have_any_length_and_a_place_may_be_next_to_nothing(tmp_path):
    """1e300 along an axis is that axis; 1e-40 m from it is on it."""
    place = ("hose", "direction")
    ends = [checked("gardenhose", "hose", tmp_path, (place, [size, 0.0, 0.0])) for size in (1.0, 1e300, 1e-300)]
    ends.append(checked("gardenhose", "hose", tmp_path, (("hose", "root"), [0.0, 1e-40, 0.0])))
    assert [(end.code, end.warned) for end in ends] == [(0, [])] * 4
    assert len({end.said.replace(str(end.scene), "") for end in ends}) == 1


def test_the_ends_of_what_can_be_computed_with_are_good_themselves(tmp_path):
    """A stiffness of 1e30 N and a height of 1e-30 are odd, and no reason for a warning of NumPy's."""
    for value in (SMALLEST, LARGEST):
        end = checked("cable", "cantilever_bar", tmp_path, (("CableModel", 3, "CableALEelement", "EA"), value))
        assert (end.code, end.warned) in ((0, []), (2, []))
