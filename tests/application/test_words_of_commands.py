"""What commands and objects say where a name, a folder or an option was meant in another way than it can be taken."""

import math
import re
from pathlib import Path

import pytest
from cli.in_process import commands_of, leave_out_pixels, only_object
from figures.synthetic_crane import forces_in

import tautline
from crane.warnings import warnings
from drillstring.application import Drillstring
from gardenhose.stability import Critical
from gardenhose.verbs import words_of
from tautline.application.installed import Installed

DATA = Path(__file__).parents[2] / "data"
HOIST = (DATA / "hoist.yaml").read_text(encoding="utf8")
FOOT = 0.3048


@pytest.fixture
def command(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    leave_out_pixels(monkeypatch)
    Path("hoist.yaml").write_text(HOIST, encoding="utf8")
    return commands_of(Installed(), capsys)


def test_a_place_of_figures_that_is_a_file_of_another_kind_is_told_to_be_one(command, tmp_path):
    tautline.simulate(tautline.read(HOIST), end=0.1, path=tmp_path / "own.nc")
    before = {name: Path(name).read_bytes() for name in ("hoist.yaml", "own.nc")}
    for name in before:
        code, _, err = command("plot", "own.nc", "-o", name)
        assert code == 2 and "is a file that is there, and no figure" in err and "name a folder" in err
    assert {name: Path(name).read_bytes() for name in before} == before


@pytest.mark.parametrize(
    ("scene", "key"), [("hoist.yaml", "solver.end"), ("cantilever_bar.yaml", "GeneralizedAlpha.time_end")]
)
def test_an_option_of_simulate_in_a_sweep_is_told_the_key_to_set(command, scene, key):
    Path(scene).write_text((DATA / scene).read_text(encoding="utf8"), encoding="utf8")
    text = "scene: {}\nvary: {{title: [a, b]}}\ncollect: [steps]\noptions: {{{}: 150 s}}\n"
    Path("several.yaml").write_text(text.format(scene, "end"), encoding="utf8")
    (problem,) = only_object(command("sweep", "several.yaml", "--json")[1])["problems"]
    assert problem["key"] == "options" and f"--set '{key}=150 s'" in problem["cure"]
    Path("several.yaml").write_text(text.format(scene, "speed"), encoding="utf8")
    (problem,) = only_object(command("sweep", "several.yaml", "--json")[1])["problems"]
    assert "--set" in problem["cure"] and "speed" not in problem["cure"]


def test_a_simulation_prints_its_scene_its_time_and_what_it_keeps():
    sim = tautline.Simulation(tautline.read(HOIST).replace({"title": "Some hoist"}))
    sim.advance(0.1)
    assert repr(sim) == str(sim) == "Simulation('Some hoist', at 0.1 s, 3 frames kept)"


def test_a_hose_that_flutters_from_a_speed_below_rounding_does_so_from_almost_no_speed():
    def at(speed):
        return Critical(speed, 0.5596, "any", "flutter")

    assert words_of(at(-3.54992e-07)) == "flutters at 0.5596 Hz from almost no speed"
    assert words_of(at(-5.25)) == "flutters at 0.5596 Hz from -5.25 m/s"


WELL = """
units: field
well: {sections: [{hold: 12000 ft}], diameter: 8.5 in, wall: {stiffness: 1 GN/m, casing: {shoe: 13000 ft, friction: 0}}}
string: [{name: drill pipe, length: rest, od: 5 in, id: 4.276 in}]
material: {youngs_modulus: 200 GPa, shear_modulus: 79 GPa, density: 7850}
model: {kind: lumped, elements: 12}
top: {block: {ramp: {to: -300 ft, over: 100 s}}}
solver: {method: generalized-alpha, step: 1 ms, end: 100 s}
output: {interval: 50 ms}
"""


def test_depths_and_heights_in_feet_are_those_that_were_written():
    # Rounded to whole metres, 12000 ft were 12001 ft, and 300 ft were 298.6 ft.
    assert round(12000 * FOOT) / FOOT > 12000.5 and round(300 * FOOT) / FOOT < 299.0
    text = " ".join(one.text for one in Drillstring().warnings(tautline.read(WELL)))
    assert "13000 ft is below the end of the hole at 12000 ft" in text
    assert "lifts the top of the string 300 ft above the table" in text


def test_the_front_of_a_sudden_start_is_the_speed_that_is_told_times_the_impedance_that_is_told():
    mass, stiffness = 2.2, 40.0e6
    scene = tautline.read(f"""
rope: {{mass_per_length: {mass} kg/m, axial_stiffness: {stiffness} N, breaking_load: 0.6 MN}}
bodies: [{{name: crate, mass: 5 t, position: [8.2, 0, -80]}}]
path:
  - drum: {{name: winch, center: [0, 0, 0], radius: 0.3, axis: [0, 1, 0], wrap: over, pay_out: 0}}
  - sheave: {{name: tip, center: [8, 0, 6], radius: 0.2, axis: [0, 1, 0], wrap: over}}
  - end: {{name: hook, body: crate}}
vessel: {{reference: [0, 0, 0], motion: {{heave: {{harmonic: {{amplitude: 0.9 m, period: 9 s}}}}}}}}
solver: {{step: 10 ms, end: 1 s}}
output: {{interval: 50 ms}}
""")
    (text,) = (one.text for one in warnings(scene) if "a tension wave of" in one.text)
    (front,), (speed,) = forces_in(text, "a tension wave of FORCE"), re.findall(r"v = ([\d.e+-]+) m/s", text)
    assert front == pytest.approx(float(speed) * math.sqrt(stiffness * mass), rel=1e-2)
