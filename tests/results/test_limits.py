"""A run says which limits it broke, by how much, when and where; values by hand or from the stored frames."""

import json
from pathlib import Path

import numpy as np
import pytest
from scipy.interpolate import CubicHermiteSpline

from drillstring.model.prepared import prepared
from drillstring.scene.scene import DrillstringScene
from drillstring.string.strength import extreme_tension
from tautline.application.installed import Installed
from tautline.cable.model.limits import stretches_within
from tautline.cli.commands.simulate import simulate as verb
from tautline.results.assessment.limits import AT_LEAST, judged
from tautline.simulation import simulate

ROOT = Path(__file__).parents[2]

CRANE = """\
rope: {mass_per_length: 0.01, axial_stiffness: 5.0e3, diameter: 40 mm, breaking_load: 5 kN}
bodies: [{name: payload, mass: 1 t, position: [10.2, 3, 2]}]
path:
  - drum: {name: winch, center: [0, 2, 0], radius: 0.2, axis: [0, 1, 0], wrap: over, pay_out: 0}
  - sheave: {name: tip, center: [10, 0, 20], radius: 0.2, axis: [0, 1, 0], wrap: over}
  - end: {name: hook, body: payload}
mesh: {elements_per_span: 3}
start: as drawn
solver: {step: 1 ms, end: 50 ms}
output: {interval: 10 ms}
"""
FOLDED = """\
rope: {mass_per_length: 1, axial_stiffness: 1.0e6, length: 30 m}
bodies: [{name: payload, mass: 100, position: [0, 0, 10]}]
path: [{anchor: {name: top, position: [0, 0, 20]}}, {end: {name: hook, body: payload}}]
mesh: {elements_per_span: 3}
start: as drawn
solver: {step: 1 ms, end: 20 ms}
output: {interval: 10 ms}
"""
STRING = """\
well: {sections: [{hold: 500 m}, {build: {radius: 400 m, to: 60 deg}}], diameter: 8.5 in, wall: {stiffness: 1.0e9}}
string: [{name: drill pipe, length: rest, od: 5 in, id: 4.276 in, yield_load: 2 MN}]
material: {youngs_modulus: 200 GPa, shear_modulus: 79 GPa, density: 7850}
model: {kind: lumped, elements: 12}
solver: {method: generalized-alpha, step: 5 ms, end: 50 ms}
output: {interval: 50 ms}
"""
CABLE = """\
CableModelMaterial: {Gravity: [0, 0, -9.81], CableStiffness: 50, CableMass: 1, CableDamping: 0}
CableModel:
  - Node7Dof: {id: 0, xyz: [0, 0, 0], xyz_d: [0, 0, -1], BC: [1, 1, 1, 0, 0, 0, 1]}
  - Node7Dof: {id: 1, xyz: [0, 0, -5], xyz_d: [0, 0, -1], BC: [0, 0, 0, 0, 0, 0, 1]}
  - Node7Dof: {id: 2, xyz: [0, 0, -10], xyz_d: [0, 0, -1], BC: [0, 0, 0, 0, 0, 0, 1]}
  - CableALEelement: {id: 0, nodes7: [0, 1], EJ: 0.1, strain: engineering}
  - CableALEelement: {id: 1, nodes7: [1, 2], EJ: 0.1, strain: engineering}
GeneralizedAlpha: {type: G-alpha, rho_inf: 0.8, time_step: 0.01, time_end: 0.02, start: static}
"""


def run(text, tmp_path):
    """Limits of a run, by name."""
    path = tmp_path / "scene.yaml"
    path.write_text(text)
    application = Installed().for_scene(path)
    result = simulate(application.build(application.read(path)))
    return result, {record["name"]: record for record in result.limits}


def test_the_worst_is_told_with_time_and_place_and_at_the_limit_it_is_kept():
    time = np.array([0.0, 0.5, 1.0])
    values = np.array([[1.0, 8.0], [4.0, 9.0], [3.9, 2.0]])
    # 4 of 5 is nearer to its limit than 9 of 20
    record = judged("x", "largest x", "N", time, values, np.array([5.0, 20.0]), ["left", "right"])
    assert (record["value"], record["limit"], record["passed"], record["time"], record["place"]) == (
        4,
        5,
        True,
        0.5,
        "left",
    )
    assert judged("x", "", "N", time, values, 4.0, ["left", "right"])["place"] == "right"
    assert judged("x", "", "N", time[:1], values[:1, :1], 1.0, ["left"])["passed"]
    least = judged("x", "", "N", time, values, 1.5, ["left", "right"], AT_LEAST)
    assert (least["value"], least["passed"], least["time"], least["place"]) == (1.0, False, 0.0, "left")


def test_a_crane_that_breaks_all_of_its_limits_says_so(tmp_path):
    result, found = run(CRANE, tmp_path)
    assert set(found) == {
        "breaking_load", "strain", "least_stretch", "most_stretch", "fleet_angle", "drum_fleet_angle", "sidelead",
        "bending_ratio",
    }  # fmt: skip
    failed = {name for name, record in found.items() if not record["passed"]}
    # Nothing has pulled the rope to twice its length yet, and nothing folds it.
    assert failed >= {"fleet_angle", "drum_fleet_angle", "sidelead", "bending_ratio"}
    assert found["bending_ratio"]["value"] == pytest.approx(10.0)
    # drum to sheave: 2 m aside over some 22 m; the load hangs 3 m aside of its sheave, 18 m below
    assert found["drum_fleet_angle"]["value"] == pytest.approx(np.arctan2(2.0, np.hypot(10.0, 20.0)), rel=0.02)
    assert found["sidelead"]["value"] == pytest.approx(np.arctan2(3.0, 18.0), rel=0.02)
    assert found["fleet_angle"]["place"] == "tip" and found["drum_fleet_angle"]["place"] == "winch"
    assert found["breaking_load"]["value"] == pytest.approx(np.asarray(result["tension"]).max())


def test_a_rope_pulled_beyond_its_breaking_load_and_strain_says_when_and_where(tmp_path):
    straight = CRANE.replace("[0, 2, 0]", "[0, 0, 0]").replace("[10.2, 3, 2]", "[10.2, 0, 2]")
    straight = straight.replace("as drawn", "static").replace("5.0e3", "2.5e3")
    result, found = run(straight, tmp_path)
    # 1 t on EA of 2.5 kN: the tension is 9.81 kN, 3.92 EA, and by Green's strain N = EA l (l^2 - 1) / 2 at l = 2.15
    assert found["breaking_load"]["value"] == pytest.approx(9.81e3, rel=0.01) and not found["breaking_load"]["passed"]
    assert found["strain"]["value"] == pytest.approx(3.924, rel=0.01) and not found["strain"]["passed"]
    stretch = found["most_stretch"]["value"]
    assert stretch * (stretch**2 - 1.0) / 2.0 == pytest.approx(3.924, rel=0.01) and not found["most_stretch"]["passed"]
    assert found["sidelead"]["passed"] and found["fleet_angle"]["passed"] and found["drum_fleet_angle"]["passed"]
    assert 0.0 <= found["strain"]["time"] <= result.time[-1]


def test_a_rope_three_times_longer_than_its_path_is_folded(tmp_path):
    _, found = run(FOLDED, tmp_path)
    assert not found["least_stretch"]["passed"] and found["least_stretch"]["value"] == pytest.approx(1.0 / 3.0, rel=0.1)
    assert found["strain"]["passed"] and "breaking_load" not in found


def test_a_string_that_a_soft_wall_lets_through_says_so_and_one_on_rock_does_not(tmp_path):
    result, found = run(STRING, tmp_path)
    assert all(record["passed"] for record in found.values())
    assert set(found) == {"strain", "yield_load", "penetration"}
    assert found["yield_load"]["value"] == pytest.approx(np.asarray(result["hook_load"]).max(), rel=1e-9)
    result, found = run(STRING.replace("1.0e9", "1.0e3"), tmp_path)
    assert not found["penetration"]["passed"]
    far = np.linalg.norm(result["lateral_displacement"], axis=-1).max()
    clearance = 0.5 * (8.5 - 5.0) * 0.0254
    assert found["penetration"]["value"] == pytest.approx(far / clearance - 1.0, rel=1e-6)


def test_a_string_beyond_its_yield_load_says_in_which_section(tmp_path):
    _, found = run(STRING.replace("2 MN", "10 kN"), tmp_path)
    assert not found["yield_load"]["passed"] and found["yield_load"]["place"].startswith("drill pipe, ")


PIPE, HUNG, GRAVITY = (0.127, 0.1086), 3000.0, 9.80665
WEIGHT = 7850.0 * np.pi / 4.0 * (PIPE[0] ** 2 - PIPE[1] ** 2) * HUNG * GRAVITY
"""Of a pipe that hangs free: its tension is w (L - s), and the hook load w L."""
HANGING_PIPE = """\
well: {sections: [{hold: 3000 m}], diameter: 0.25, wall: none}
string: [{name: pipe, length: 3000 m, od: 0.127, id: 0.1086, yield_load: YIELD}]
material: {youngs_modulus: 200 GPa, shear_modulus: 79 GPa, density: 7850}
gravity: 9.80665
model: {kind: KIND, elements: COUNT}
solver: {method: generalized-alpha, rho_inf: 0.5, step: 10 ms, end: 0.1 s}
output: {interval: 50 ms}
limits: [{output: tension, above: YIELD}, {output: "tension[0]", above: YIELD}, {output: tension, below: 10 N}]
"""


@pytest.mark.parametrize("kind", ["lumped", "ale-ancf"])
@pytest.mark.parametrize("elements", [1, 2, 7])
@pytest.mark.parametrize("share", [0.999, 1.001])
def test_whether_a_hanging_pipe_yields_at_its_hook_load_does_not_depend_on_the_mesh(tmp_path, kind, elements, share):
    text = HANGING_PIPE.replace("YIELD", f"{share * WEIGHT:.3f}").replace("KIND", kind).replace("COUNT", str(elements))
    _, found = run(text, tmp_path)
    assert found["yield_load"]["value"] == pytest.approx(WEIGHT, rel=1e-5)
    assert found["yield_load"]["passed"] == (share > 1.0)
    assert found["yield_load"]["place"].startswith("pipe, 0 to ")
    own = [record for name, record in found.items() if name.startswith("tension")]
    most, first, least = own
    assert [one["value"] for one in (most, first)] == pytest.approx([WEIGHT, WEIGHT], rel=1e-5)
    # The place is that of the element's upper end, and not of its middle.
    assert most["place"] == found["yield_load"]["place"]
    assert most["passed"] == first["passed"] == (share > 1.0)
    # Nothing hangs on its end.
    assert least["value"] == pytest.approx(0.0, abs=1e-5 * WEIGHT) and not least["passed"]


def test_tension_at_the_ends_of_unequal_elements_of_two_sections_is_the_weight_below_them():
    pipe = "{name: pipe, length: 3000 m,"
    heavy = "{name: heavy, length: 500 m, od: 0.2, id: 0.05}, {name: pipe, length: 2500 m,"
    text = HANGING_PIPE.replace(pipe, heavy).replace("YIELD", "1 MN").replace("KIND", "lumped")
    scene = DrillstringScene.parse(text.replace("COUNT", "4"))
    lumps = prepared(scene).lumps
    weight = lumps.of_links(lambda tube: tube.mass_per_length) * GRAVITY * lumps.length
    below = np.append(np.cumsum(weight[::-1])[::-1], 0.0)
    middles = 0.5 * (below[1:] + below[:-1])
    assert np.ptp(lumps.length) > 100.0
    hook = np.asarray(below[0])
    assert extreme_tension(scene, lumps, hook, middles) == pytest.approx(below[:-1], rel=1e-12)
    assert extreme_tension(scene, lumps, hook, middles, least=True) == pytest.approx(below[1:], rel=1e-12, abs=1e-6)


def test_a_rubber_cable_that_stretches_under_its_weight_says_so(tmp_path):
    _, found = run(CABLE, tmp_path)
    # at the top N = w L = 98.1 N, and r' = 1 + N / EA = 2.96; the two elements' ends come near
    assert found["most_stretch"]["value"] == pytest.approx(2.96, rel=0.1) and found["most_stretch"]["place"] == "node 0"
    assert not found["most_stretch"]["passed"] and not found["strain"]["passed"] and found["least_stretch"]["passed"]
    _, found = run(CABLE.replace("CableStiffness: 50", "CableStiffness: 5.0e5"), tmp_path)
    assert all(record["passed"] for record in found.values())


def test_the_shipped_hose_neither_folds_nor_stretches_too_far(tmp_path):
    text = (ROOT / "data" / "hose.yaml").read_text(encoding="utf8")
    _, found = run(text.replace("end: 5 s", "end: 10 ms"), tmp_path)
    assert set(found) == {"least_stretch", "most_stretch"} and all(record["passed"] for record in found.values())


HANGING = """\
hose: {length: 0.5, elements: 10, axial_stiffness: 0.004, bending_stiffness: 1.0e-6, mass_per_length: 0.00313,
       direction: [0, 0, -1]}
gravity: 9.81
disturbance: [0.001, 0, 0]
start: static
solver: {method: generalized-alpha, step: 1 ms, end: 5 ms}
output: {interval: 5 ms}
"""


def test_a_hose_of_rubber_that_hangs_more_than_twice_its_length_says_so_at_its_root(tmp_path):
    _, found = run(HANGING, tmp_path)
    # by Green's strain N = EA l (l^2 - 1) / 2, and the weight is 3.84 EA
    stretch = found["most_stretch"]["value"]
    assert stretch * (stretch**2 - 1.0) / 2.0 == pytest.approx(0.00313 * 0.5 * 9.81 / 0.004, rel=0.02)
    assert not found["most_stretch"]["passed"] and found["most_stretch"]["place"] == "0 m from the root"


def test_simulate_prints_broken_limits_and_gives_all_in_json(tmp_path, capfd, monkeypatch):
    monkeypatch.chdir(tmp_path)
    path = tmp_path / "scene.yaml"
    path.write_text(STRING.replace("1.0e9", "1.0e3"))
    verb(Installed(), path, None, {}, None, False, True, False)
    out, err = capfd.readouterr()
    (penetration,) = [record for record in json.loads(out)["limits"] if record["name"] == "penetration"]
    assert set(penetration) == {"name", "text", "unit", "sense", "limit", "value", "passed", "time", "place"}
    assert penetration["passed"] is False and penetration["limit"] == 1.0
    flat = " ".join(err.split())
    assert "limits satisfied" in flat and "2 of 3" in flat
    text = "largest penetration of the wall / clearance"
    assert f"warning: {text}" in flat and "must be at most 1" in flat
    assert flat.count(text) == 1, "the warning tells it, and no row tells it again"


def test_a_hose_that_relaxation_leaves_folded_within_an_element_is_told_so(tmp_path):
    # A coarse mesh takes it for rest: r' turns by 180 degrees within an element, and |r'| is near 1 at its ends.
    text = (ROOT / "data" / "hose.yaml").read_text(encoding="utf8")
    text = text.replace("speed: {ramp: {to: 35.0, over: 0.1}}", "speed: 27.0").replace("end: 5 s", "end: 10 ms")
    result, found = run(f"{text}start: relaxed\n", tmp_path)
    assert np.linalg.norm(result["slope"], axis=-1).min() > 0.9
    least = found["least_stretch"]
    assert not least["passed"] and least["value"] < 0.35
    # Rounding decides which element it is that folds.
    position, slope = result["position"][-1], result["slope"][-1]
    x = np.linspace(0.0, 0.5, len(position))
    within = np.add.outer(x[:-1], x[1] * np.array([0.25, 0.5, 0.75]))
    stretches = np.linalg.norm(CubicHermiteSpline(x, position, slope)(within, 1), axis=-1)
    folded = stretches.min(axis=1).argmin()
    assert slope[folded] @ slope[folded + 1] < -0.8
    assert x[folded] < float(least["place"].split()[0]) < x[folded + 1]


def test_length_within_an_element_is_that_of_its_polynomials():
    # an arc of 90 degrees of radius 1 in one element, and a straight one that is stretched to 1.5 times its length
    turned = stretches_within(
        np.array([[[1.0, 1.0, 0.0]]]), np.array([[[1.0, 0.0, 0.0]]]), np.array([[[0.0, 1.0, 0.0]]]),
        np.array([np.pi / 2]),
    )  # fmt: skip
    x = np.linspace(0.0, np.pi / 2, 5)
    cubic = CubicHermiteSpline([0.0, np.pi / 2], [[0.0, 0.0], [1.0, 1.0]], [[1.0, 0.0], [0.0, 1.0]])
    assert turned[0] == pytest.approx(np.linalg.norm(cubic(x, 1), axis=-1)[1:-1], rel=1e-12)
    straight = np.array([[[1.5, 0.0, 0.0]]])
    assert stretches_within(3.0 * straight, straight, straight, np.array([3.0]))[0] == pytest.approx(1.5, rel=1e-12)
