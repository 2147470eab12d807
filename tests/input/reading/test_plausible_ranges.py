"""Numbers that are a slip of a unit are warned of, with the unit that was meant; numbers that are right are not."""

import json
import re
from pathlib import Path

import numpy as np
import pytest

from crane.scene.scene import CraneScene
from crane.warnings import rope_warnings
from drillstring.model.prepared import prepared
from drillstring.scene.scene import DrillstringScene
from drillstring.warnings import soft_wall
from gardenhose.scene import HoseScene
from tautline.application.installed import Installed
from tautline.cable.input.syntax.models import WrittenCable
from tautline.cable.input.syntax.thesis_compat import read_compat
from tautline.scene.errors import SceneError, SceneWarning
from tautline.scene.model import validate
from tautline.scene.reading.document import Document
from tautline.scene.unit_slips import slips_of_units
from tautline.scene.values.printed import in_words
from tautline.scene.values.quantity import quantity
from tautline.scene.values.ranges import RANGES
from tautline.scene.values.units import read_unit

ROOT = Path(__file__).parents[3]
SHIPPED = sorted(ROOT.glob("data/*.yaml")) + sorted(ROOT.glob("**/templates/*.yaml"))
MODELS = {"well": DrillstringScene, "path": CraneScene, "hose": HoseScene, "CableModel": WrittenCable}

STRING = """\
well: {sections: [{hold: 500 m}, {build: {radius: 400 m, to: 60 deg}}], diameter: 8.5 in,
       wall: {stiffness: 1.0e9, friction: 0.2}}
string: [{name: drill pipe, length: rest, od: 5 in, id: 4.276 in}]
material: {youngs_modulus: 30 Mpsi, shear_modulus: 11.5 Mpsi, density: 490 pcf}
mud: {density: 12 ppg}
top: {rotation: {ramp: {to: 60 rpm, over: 2 s}}}
bit: {on_bottom: true, weight: 40 klbf, torque: {static: 6 kN m, kinetic: 4 kN m}}
model: {kind: lumped, elements: 12}
solver: {method: generalized-alpha, step: 2 ms, end: 1 s}
output: {interval: 50 ms}
"""
HOSE = (ROOT / "data" / "hose.yaml").read_text(encoding="utf8")
CRANE = """\
rope: {mass_per_length: 5.5 kg/m, axial_stiffness: 80 MN, diameter: 36 mm, breaking_load: 1.1 MN}
bodies: [{name: payload, mass: 5 t, position: [10, 0, 2]}]
path:
  - drum: {name: winch, center: [0, 0, 0], radius: 0.4, axis: [0, 1, 0], wrap: over, pay_out: 0, frame: boom}
  - sheave: {name: tip, center: [9.6, 0, 20], radius: 0.4, axis: [0, 1, 0], wrap: over, frame: boom}
  - end: {name: hook, body: payload}
frames: [{name: boom, pivot: [0, 0, 0], luff: {ramp: {to: -10 deg, over: 5}}}]
solver: {step: 5 ms, end: 1 s}
output: {interval: 50 ms}
"""


def model_of(root):
    return next(model for key, model in MODELS.items() if key in root)


def warned(text):
    document = Document.parse(text)
    model = model_of(document.root)
    validate(model, document)
    return slips_of_units(model, document)


SLIPS = [
    (STRING, "diameter: 8.5 in", "diameter: 8.5 m", "well.diameter", "0.004 to 2 m", "8.5 in = 0.2159 m", 1),
    (STRING, "density: 12 ppg", "density: 10", "mud.density", "200 to 3000 kg/m^3", "10 ppg = 1198 kg/m^3", 5),
    (STRING, "30 Mpsi", "30 psi", "material.youngs_modulus", "1 GPa", "30 Mpsi = 206.8 GPa", 4),
    (STRING, "to: 60 rpm", "to: 60", "top.rotation.ramp.to", "40 rad/s", "60 rpm = 6.283 rad/s", 6),
    (STRING, "to: 60 rpm", "to: 60 rad/s", "top.rotation.ramp.to", "40 rad/s", "60 rpm = 6.283 rad/s", 6),
    (STRING, "40 klbf", "40", "bit.weight", "100 N to 2 MN", "40 kN or 40 klbf = 177.9 kN", 7),
    (STRING, "friction: 0.2", "friction: 20", "well.wall.friction", "1.5", "20 % = 0.2", 2),
    (CRANE, "-10 deg", "-10", "frames[0].luff.ramp.to", "up to 3.15 rad", "-10 deg = -0.1745 rad", 7),
    (STRING, "elements: 12", "elements: 12}\ndamping: {structural: 20", "damping.structural", "10 s", "20 ms", 9),
    (CRANE, "step: 5 ms, end: 1 s}\noutput: {interval: 50 ms}", "step: 5, end: 50}\noutput: {interval: 5}",
     "solver.step", "2 s", "5 ms = 0.005 s", 8),
    (CRANE, "mass: 5 t", "mass: 5 t, orientation: [0, 0, 90], inertia: [1, 1, 1]",
     "bodies[0].orientation[2]", "6.3 rad", "90 deg", 2),
]  # fmt: skip


@pytest.mark.parametrize(("scene", "right", "wrong", "key", "within", "meant", "line"), SLIPS)
def test_a_slip_of_a_unit_is_warned_of_with_its_line_range_and_the_unit_that_was_meant(
    scene, right, wrong, key, within, meant, line
):
    assert warned(scene) == []
    (found,) = warned(scene.replace(right, wrong, 1))
    assert found.where == key
    assert within in found.text and f"(line {line})" in found.text
    assert f"Was {meant}" in found.text


def test_a_survey_whose_depths_are_those_of_no_hole_is_warned_of(tmp_path):
    """Inches in a column that says metres; the angles turn slowly enough for any hole."""
    rows = "\n".join(f"{39.37 * 30.0 * i:.2f},{0.1 * i:.2f},0" for i in range(60))
    (tmp_path / "survey.csv").write_text(f"md [m],inc [deg],azi [deg]\n{rows}\n")
    text = STRING.split("string:")
    well = "well: {survey: {file: survey.csv, max_gap: 2 km}, diameter: 0.2 m, wall: none}\n"
    (tmp_path / "scene.yaml").write_text(well + "string:" + text[1])
    found = Installed().for_scene(tmp_path / "scene.yaml")
    said = [one.text for one in found.warnings(found.read(tmp_path / "scene.yaml")) if one.where == "well.survey"]
    assert len(said) == 1 and "check the unit of the column md" in said[0]


def walled(text):
    scene = DrillstringScene.parse(text)
    return [SceneWarning(where, in_words(text, "si")) for where, text in soft_wall(scene, prepared(scene))]


@pytest.mark.parametrize("system", ["si", "metric", "field"])
def test_the_unit_that_was_perhaps_meant_stands_as_it_would_be_typed_in_a_scene_of_any_units(tmp_path, system):
    (tmp_path / "scene.yaml").write_text(STRING.replace("1.0e9", "1.0e3 N/m") + f"units: {system}\n")
    found = Installed().for_scene(tmp_path / "scene.yaml")
    told = [one.text for one in found.warnings(found.read(tmp_path / "scene.yaml")) if "is soft" in one.text]
    assert len(told) == 1 and "Was 1.0e3 MN/m = 1 GN/m meant? Then correct the unit" in told[0]
    assert "\u00a0" not in told[0] and ("kip/ft" in told[0]) is (system == "field")


def test_warnings_beside_the_faults_of_a_scene_say_that_they_are_no_faults(tmp_path):
    deep = (ROOT / "data" / "jwell.yaml").read_text(encoding="utf8").replace("hold: 2200 m", "hold: 1e29")
    (tmp_path / "odd.yaml").write_text(deep, encoding="utf8")
    found = Installed().for_scene(tmp_path / "odd.yaml")
    with pytest.raises(SceneError) as caught:
        found.warnings(found.read(tmp_path / "odd.yaml"))
    slip, *faults = str(caught.value).splitlines()
    assert slip.startswith(f"warning: {tmp_path / 'odd.yaml'}: well.sections[0].hold: ") and slip.count("(line 5)") == 1
    assert "is unusual" in slip and faults and not any(one.startswith("warning") for one in faults)


def test_a_wall_too_soft_for_its_string_is_warned_of_with_the_depth_and_the_unit_that_was_meant():
    assert walled(STRING) == []
    (found,) = walled(STRING.replace("1.0e9", "1.0e3"))
    assert found.where == "well.wall.stiffness" and "1.0e3 MN/m = 1 GN/m" in found.text
    depth = float(re.search(r"by about ([\d.]+) m into", found.text)[1])
    # Johancsik by hand: steel of 490 pcf in mud of 12 ppg. The weight on bit compresses the last of 12 elements the
    # most, and over 400 m radius that is more than the weight across. In all (919 m), over 12 contacts of 1 kN/m.
    area = np.pi / 4.0 * (0.127**2 - (4.276 * 0.0254) ** 2)
    weight = area * (490.0 * 16.0185 - 12.0 * 119.826) * 9.81
    length = 500.0 + 400.0 * np.pi / 3.0
    lean = np.pi / 3.0 - length / 24.0 / 400.0
    tension = weight * 400.0 * (np.sin(np.pi / 3.0) - np.sin(lean)) - 177.9e3
    across = max(abs(tension) / 400.0, weight * np.sin(lean))
    assert depth == pytest.approx(across * length / 12.0 / 1.0e3, rel=0.01)


def test_a_small_model_of_the_laboratory_with_a_soft_wall_is_not_warned_of():
    # a rod of 6 mm plastic in a tube of 20 mm, 5 m long: 1 kN/m bears its weight
    small = STRING.replace("hold: 500 m", "hold: 2 m").replace("radius: 400 m", "radius: 2 m")
    small = small.replace("8.5 in", "20 mm").replace("od: 5 in, id: 4.276 in", "od: 6 mm, id: 0")
    small = small.replace("30 Mpsi", "3 GPa").replace("11.5 Mpsi", "1 GPa").replace("490 pcf", "1200")
    small = (
        small.replace("1.0e9", "1.0e3").replace("weight: 40 klbf", "weight: 0, force: 2 N").replace("12 ppg", "1000")
    )
    small = re.sub(r"torque: \{.*?\}", "cutting: {specific_energy: 1 MPa}", small)
    assert walled(small) == [] and warned(small) == []


@pytest.mark.parametrize("path", SHIPPED, ids=lambda path: path.name)
def test_no_shipped_scene_or_template_is_warned_of(path):
    document = Document.read(path)
    if not any(key in document.root for key in MODELS):
        return
    model = model_of(document.root)
    if model is WrittenCable:
        document, _ = read_compat(document)
    scene = validate(model, document)
    assert slips_of_units(model, document) == []
    if model is CraneScene:
        assert list(rope_warnings(scene)) == []
    if model is DrillstringScene:
        assert list(soft_wall(scene, prepared(scene))) == []


def quantities(schema, path="", within=False):
    """Path and row of every number of a JSON schema; None where it has no row."""
    if isinstance(schema, dict):
        kinds = schema.get("anyOf") or []
        own = schema.get("type") == "number" or any(isinstance(k, dict) and k.get("type") == "number" for k in kinds)
        if "quantity" in schema or (own and not within):
            yield path, schema.get("quantity")
        for key, value in schema.items():
            yield from quantities(value, f"{path}/{key}", "quantity" in schema or (own and key == "anyOf"))
    elif isinstance(schema, list):
        for i, value in enumerate(schema):
            yield from quantities(value, f"{path}/{i}", within)


def test_every_quantity_of_every_application_has_a_row_in_the_table_of_ranges():
    applications = Installed().all()
    assert len(applications) == 4
    used = set()
    for application in applications:
        found = list(quantities(json.loads(json.dumps(application.schema()))))
        assert len(found) > 40
        assert [path for path, row in found if row not in RANGES] == []
        used |= {row for _, row in found}
    # Rows of relations between numbers, and rates of functions, are no key's own.
    own = {"modulus of the rope", "strength of the rope", "density of the rope", "rate of change"}
    assert set(RANGES) - used <= own


def test_a_number_without_a_row_is_found_in_a_schema():
    assert list(quantities({"properties": {"x": {"anyOf": [{"type": "number"}, {"type": "string"}]}}})) == [
        ("/properties/x", None)
    ]


@pytest.mark.parametrize("name", RANGES)
def test_a_row_of_the_table_has_a_range_or_a_reason_and_units_that_can_be_read(name):
    row = RANGES[name]
    assert row.why
    if row.low is None:
        return
    assert 0.0 <= row.low < row.high
    for unit in row.meant:
        assert read_unit(unit).dimension == read_unit(row.unit or "%").dimension


def test_a_key_declared_with_an_unknown_row_is_refused_with_the_nearest_row_and_a_cure():
    with pytest.raises(ValueError, match=r"'quadratic dragg'.*did you mean 'quadratic drag'.*add a row"):
        quantity("N s^2/m^2", of="quadratic dragg")


def test_numbers_without_unit_in_a_scene_of_field_units_are_told_in_one_warning_with_both_readings():
    assert warned("units: field\n" + STRING) == []
    bare = "units: field\n" + STRING.replace("hold: 500 m", "hold: 1500").replace(
        "od: 5 in, id: 4.276 in", "od: 0.127, id: 0.1"
    )
    (found,) = warned(bare)
    assert found.where == "units"
    assert "3 numbers have no unit" in found.text
    assert "well.sections[0].hold = 1500 (line 2) is 1500 m, and 1500 ft would be 457.2 m" in found.text
    assert "string[0].od = 0.127 (line 4) is 0.127 m, and 0.127 in would be 0.003226 m" in found.text
    # The same in a scene of SI is what SI is for; times and stiffnesses have no field unit.
    assert warned(bare.replace("units: field", "units: si")) == []


def test_a_bare_number_outside_of_its_range_in_a_scene_of_field_units_is_told_with_the_fields_unit_first():
    (found,) = warned("units: field\n" + STRING.replace("12 ppg", "12"))
    assert found.where == "mud.density" and "Was 12 ppg = 1438 kg/m^3 meant?" in found.text
    (found,) = warned("units: field\n" + STRING.replace("40 klbf", "40"))
    assert "Was 40 klbf = 177.9 kN" in found.text


def test_of_many_wrong_numbers_of_one_key_the_first_is_told_and_the_others_counted():
    values = ", ".join(["0"] + ["10"] * 40)
    times = ", ".join(str(k) for k in range(41))
    text = CRANE.replace("{ramp: {to: -10 deg, over: 5}}", f"{{table: {{time: [{times}], value: [{values}]}}}}")
    (found,) = warned(text)
    assert found.where == "frames[0].luff.table.value[1]" and "39 more numbers" in found.text


def test_a_slip_in_a_csv_file_is_told_at_the_key_that_names_the_file(tmp_path):
    (tmp_path / "luff.csv").write_text("time,value\n0,0\n1,-10\n2,-20\n3,-30\n4,-40\n")
    text = CRANE.replace("{ramp: {to: -10 deg, over: 5}}", "{table: {file: luff.csv}}")
    document = Document.parse(text, tmp_path / "scene.yaml")
    (found,) = slips_of_units(CraneScene, document)
    assert found.where == "frames[0].luff.table.file" and "-10.0 deg" in found.text
    (tmp_path / "luff.csv").write_text("time,value [deg]\n0,0\n1,-10\n2,-20\n")
    assert slips_of_units(CraneScene, document) == []


def test_a_slip_in_an_option_is_told_without_a_line_of_the_file():
    document = Document.parse(CRANE).replaced({("solver", "step"): (5.0, "--step"), ("solver", "end"): (50.0, "--end")})
    (found,) = slips_of_units(CraneScene, document.replaced({("output", "interval"): (5.0, "--interval")}))
    assert found.where == "solver.step" and "line" not in found.text and "5.0 ms = 0.005 s" in found.text


def roped(text):
    return [(key, in_words(told, "si")) for key, told in rope_warnings(CraneScene.parse(text))]


def test_numbers_of_a_rope_that_do_not_go_with_its_diameter_are_warned_of():
    assert roped(CRANE) == []
    ((key, text),) = roped(CRANE.replace("1.1 MN", "1100"))
    assert key == "rope.breaking_load" and "1100 kN = 1.1 MN" in text
    ((key, text),) = roped(CRANE.replace("80 MN", "80"))
    assert key == "rope.axial_stiffness" and "80 MN" in text
    ((key, text),) = roped(CRANE.replace("5.5 kg/m", "5500"))
    assert key == "rope.mass_per_length" and "5500 g/m = 5.5 kg/m" in text


def test_check_tells_slips_of_units_of_every_application(tmp_path):
    wrong = {
        "string.yaml": (STRING.replace("12 ppg", "12"), "mud.density"),
        "crane.yaml": (CRANE.replace("-10 deg", "-10"), "frames[0].luff.ramp.to"),
        "hose.yaml": (
            re.sub(r"bending_stiffness: *[\d.e-]+", "bending_stiffness: 1.0e15", HOSE),
            "hose.bending_stiffness",
        ),
    }
    appendix = (ROOT / "tests" / "input" / "appendix_a.yaml").read_text()
    wrong["cable.yaml"] = (
        re.sub(r"(Gravity: .*)-9.81", r"\1-9810", appendix),
        "CableModelMaterial.Gravity[2]",
    )
    for name, (text, _) in wrong.items():
        (tmp_path / name).write_text(text)
    for name in wrong:
        application = Installed().for_scene(tmp_path / name)
        warnings = application.warnings(application.read(tmp_path / name))
        assert wrong[name][1] in [warning.where for warning in warnings], name
