"""Oilfield units on the screen, SI in files and JSON: the same numbers, by factors that pint agrees with."""

import json
import re
import sys
from pathlib import Path

import pytest

from crane.application import Crane
from drillstring.application import Drillstring
from tautline.cli.run import run
from tautline.cli.verbs import make_app
from tautline.results.result import Result
from tautline.scene.errors import SceneError
from tautline.scene.values.printed import in_words, printed_in, shown
from tautline.scene.values.systems import SYSTEMS, in_system
from tautline.scene.values.units import pint_registry

FIELD_WELL = (Path(__file__).parents[3] / "data" / "field_well.yaml").read_text(encoding="utf8")
KIP, FOOT = 4448.2216152605, 0.3048


@pytest.fixture
def drillstring(tmp_path, monkeypatch, capsys):
    """Run a command in this process, as the console script does: exit code, standard output, standard error."""
    monkeypatch.chdir(tmp_path)
    Path("field.yaml").write_text(FIELD_WELL, encoding="utf8")
    Path("si.yaml").write_text(FIELD_WELL.replace("units: field", "units: si"), encoding="utf8")

    def command(*arguments):
        monkeypatch.setattr(sys, "argv", ["drillstring", *map(str, arguments)])
        with pytest.raises(SystemExit) as left:
            run(make_app(Drillstring()))
        captured = capsys.readouterr()
        return left.value.code or 0, captured.out, captured.err

    return command


@pytest.mark.parametrize(("system", "unit"), [(system, unit) for system in SYSTEMS for unit in SYSTEMS[system]])
def test_every_conversion_equals_pint_s(system, unit):
    registry = pint_registry()
    wanted = {"m/h": "m/hour", "1/m": "radian/m"}.get(unit, unit.replace("N m", "N*m"))
    for value in (1.0e-3, 7.0e2, 3.0e5, 8.0e8):
        converted, name = in_system(value, unit, system)
        # in pint a hyphen is a minus sign, its bbl another barrel than oil's, and a unit has no number in it
        pints, many = name, 1.0
        if match := re.fullmatch(r"deg/(\d+) (\w+)", name):
            pints, many = f"degree/{match[2]}", float(match[1])
        for ours, theirs in (("-", "*"), ("N m", "N*m"), ("lbm", "pound"), ("bbl", "oil_bbl"), ("/h", "/hour")):
            pints = pints.replace(ours, theirs)
        pints = "tonne" if pints == "t" else pints
        exact = registry.Quantity(value, wanted).to(pints).magnitude * many
        assert converted == pytest.approx(exact, rel=1e-12), name


@pytest.mark.parametrize(
    ("value", "unit", "text"),
    [
        (1.0e6, "N", "224.8 kip"),
        (1.0e3, "N", "224.8 lbf"),
        (-1.0e6, "N", "-224.8 kip"),
        (2.0e4, "N m", "14.75 kft-lbf"),
        (100.0, "N m", "73.76 ft-lbf"),
        (2.0e7, "Pa", "2901 psi"),
        (2.0e8, "Pa", "29.01 ksi"),
        (1000.0, "m", "3281 ft"),
        (6.283185307179586, "rad/s", "60 rpm"),
        (1498.0, "kg/m^3", "12.5 ppg"),
        (2.5, "s", "2.5 s"),
        (0.25, "", "0.25"),
        (3, "", "3"),
        (None, "N", "–"),
        ([1.0e6, 2.0e6], "N", "224.8 kip, 449.6 kip"),
        ("stiff", "", "stiff"),
    ],
)
def test_a_figure_is_written_as_a_driller_would(value, unit, text):
    assert shown(value, unit, "field") == text


@pytest.mark.parametrize("text", ["5 N m/rad", "1200 N m s/rad", "soft torque of 1.2 kN m s/rad", "40 N m²"])
def test_no_part_of_a_unit_that_has_no_other_is_converted(text):
    assert in_words(text, "field") == text


@pytest.mark.parametrize(
    ("attributes", "system"), [({"printed_in": "field"}, "field"), ({"units": "metric"}, "metric"), ({}, "si")]
)
def test_results_say_in_which_units_they_are_printed_and_those_of_earlier_versions_do(attributes, system):
    assert printed_in(attributes) == system


@pytest.mark.parametrize(
    ("value", "unit", "text"),
    [
        (1.2e6, "N", "1200 kN"),
        (250.0, "N", "250 N"),
        (-3.0e4, "N m", "-30 kN m"),
        (6.283185307179586, "rad/s", "60 rpm"),
        (18.0, "m/h", "18 m/h"),
        (1300.0, "kg/m^3", "1.3 sg"),
        (0.0017453292519943296, "1/m", "3 deg/30 m"),
        (85_000.0, "kg", "85 t"),
        (2.5e8, "Pa", "250 MPa"),
        (1234.5, "m", "1234 m"),
        (0.02, "rad", "1.146 deg"),
        ([1.0e6, 2.0e6], "N", "1000 kN, 2000 kN"),
    ],
)
def test_a_figure_in_metric_units_is_written_as_engineers_do(value, unit, text):
    assert shown(value, unit, "metric") == text


@pytest.mark.parametrize(
    ("text", "field"),
    [
        ("bending of a metre (20 to 21 m, winch)", "bending of a metre (65.62 to 68.9 ft, winch)"),
        ("between 0.1 and 0.4 m", "between 0.3281 and 1.312 ft"),
        ("elements of 2 x 3 m", "elements of 6.562 x 9.843 ft"),
        ("0.001 to 0.002 m of play", "0.03937 to 0.07874 in of play"),
        ("for 3 s and 4 m", "for 3 s and 13.12 ft"),
        ("3 and 4 of 5 m", "3 and 4 of 16.4 ft"),
        ("0 m, 12 rpm", "0 ft, 12 rpm"),
    ],
)
def test_all_figures_of_a_range_are_converted_in_a_sentence(text, field):
    assert in_words(text, "field") == field and in_words(text, "si") == text


def test_the_table_of_check_of_a_crane_is_in_the_units_of_its_scene(tmp_path):
    text = (Path(__file__).parents[3] / "data" / "hoist.yaml").read_text(encoding="utf8")
    (tmp_path / "scene.yaml").write_text(f"units: field\n{text}", encoding="utf8")
    crane = Crane()
    rows = dict(crane.describe(crane.check_figures(crane.read(tmp_path / "scene.yaml"))))
    assert all(value.endswith(" ft") for name, value in rows.items() if " to " in name or "length" in name)
    assert rows["length of the path"].endswith(" ft")


def test_a_refusal_is_in_the_units_of_its_scene(tmp_path):
    text = (Path(__file__).parents[3] / "data" / "hoist.yaml").read_text(encoding="utf8")
    (tmp_path / "scene.yaml").write_text(
        "units: field\n" + text.replace("rope:", "rope:\n  length: 20 m", 1), encoding="utf8"
    )
    crane = Crane()
    with pytest.raises(SceneError, match=r"65\.62 ft of rope are shorter than the path, which is [\d.]+ ft"):
        crane.build(crane.read(tmp_path / "scene.yaml"))


@pytest.mark.parametrize("units", ["metric", "field"])
def test_a_number_that_has_one_plausible_reading_is_not_warned_of(tmp_path, units):
    """Steel of 7850 kg/m^3 is no 7850 sg or ppg; 60 m/s as rotary speed in rad/s may be rpm."""
    text = re.sub(r"(?m)^units: .*\n", "", FIELD_WELL)
    assert "density" in text
    (tmp_path / "w.yaml").write_text(f"units: {units}\n" + text.replace("density: 490 pcf", "density: 7850"))
    for file in (Path(__file__).parents[3] / "data").glob("*.csv"):
        (tmp_path / file.name).write_bytes(file.read_bytes())
    string = Drillstring()
    assert not any("density" in one.text for one in string.warnings(string.read(tmp_path / "w.yaml")))


def test_without_a_word_about_units_figures_stay_si():
    assert shown(1.0e6, "N") == "1 MN" and shown(1000.0, "m") == "1000 m"


def test_the_summary_of_a_run_is_in_field_units_and_json_and_file_are_si(drillstring):
    code, out, err = drillstring("simulate", "field.yaml", "--end", "0.2", "--json")
    assert code == 0, err
    report = json.loads(out)
    hook = Result.read("field.nc")["hook_load"][0]
    assert report["hook_load_start"] == pytest.approx(hook, rel=1e-12) and hook > 1.0e5
    told = float(re.search(r"hook load at the start +([\d.]+) kip", err)[1])
    assert told == pytest.approx(hook / KIP, rel=1e-3)
    stretch = float(re.search(r"elongation of the string at the start +([\d.]+) ft", err)[1])
    assert stretch == pytest.approx(report["stretch_start"] / FOOT, rel=1e-3)
    assert re.search(r"surface torque at the end +[\d.]+ k?ft-lbf", err) and not re.search(r"\d k?N( m)?\b", err)
    attributes = Result.read("field.nc").attributes
    assert attributes["printed_in"] == "field" and "units" not in attributes


def test_units_change_what_is_printed_and_nothing_that_is_computed(drillstring):
    field = json.loads(drillstring("simulate", "field.yaml", "--end", "0.2", "--json")[1])
    code, out, err = drillstring("simulate", "si.yaml", "--end", "0.2", "--json")
    si = json.loads(out)
    assert "kN" in err and "kip" not in err
    assert si["hook_load_max"] == field["hook_load_max"] and si["bit_displacement"] == field["bit_displacement"]
    # a run may be gone on with in other units
    code, out, err = drillstring("simulate", "field.yaml", "--end", "0.4", "--resume", "si.nc", "-o", "on.nc")
    assert code == 0, err


def test_check_prints_well_and_string_in_field_units_and_json_in_si(drillstring):
    code, _, err = drillstring("check", "field.yaml")
    assert code == 0 and re.search(r"measured depth of the well +8333 ft", err), err
    assert re.search(r"largest inclination +40 deg", err)
    figures = json.loads(drillstring("check", "field.yaml", "--json")[1])
    assert figures["well"]["length"] == pytest.approx(8333.3333 * FOOT, rel=1e-6)


def test_tubulars_are_listed_and_those_that_some_words_fit(drillstring):
    code, out, err = drillstring("tubulars")
    assert code == 0 and "drill collar 11 x 3 in" in err and "drill pipe 2 3/8 in 4.85 lb/ft E75" in err
    code, out, err = drillstring("tubulars", "5", "in", "S135", "--json")
    (one,) = json.loads(out)["tubulars"]
    assert one["tubular"] == "drill pipe 5 in 19.50 lb/ft S135" and re.search(r"19.50 lb/ft S135 .* 712.1 NC50", err)
    assert one["od"] == pytest.approx(0.127) and one["yield_load"] == pytest.approx(712.07 * KIP, rel=1e-4)
    assert max(map(len, err.splitlines())) <= 100


@pytest.mark.parametrize("words", ["casing", "HWDP 7 in", "5 in V150"])
def test_words_that_fit_no_tubular_are_bad_input(words, drillstring):
    code, _, err = drillstring("tubulars", *words.split())
    assert code == 2 and words in err and "; " in err and "Traceback" not in err


BARE = {
    "50": "read in N, and 50 N is unusual for a weight on bit. 100 N to 2 MN is plausible. Write the unit: 50 kN",
    "50:250:50": "--weight 50:250:50: a number without a unit is read in N, and 50 N is unusual",
    "50 kN,60": "60 N is unusual",
    "50 kN": "",
    "50000,100000": "",
    "10000:50000:50": "",
    "20 N": "",
}


@pytest.mark.parametrize("text", BARE)
def test_a_bare_weight_on_bit_that_is_meant_in_another_unit_is_warned_of_and_no_other(text):
    from drillstring.verbs.stick_slip import _doubts

    told = " ".join(_doubts([10.0], text))
    assert BARE[text] in told and bool(told) == bool(BARE[text])


def test_a_duration_of_seconds_that_was_meant_in_hours_is_noted_with_what_to_write():
    from crane.operability.storms import Asked, duration_notes

    (note,) = duration_notes(Asked((), (), 3.0, 3.0, ()))
    assert duration_notes(Asked((), (), 3.0, 3.0, (), bare=False)) == []  # written as 3 s
    assert "--duration is 3 s" in note and note.endswith("write --duration '3 h'")
    for seconds in (60.0, 1200.0, 10800.0):
        assert duration_notes(Asked((), (), seconds, seconds, ())) == []
