"""Links that feel the bends of a hole, against a soft string in a channel of the hole's width.

The hole leans by 45 degrees and swings by 1 degree with a period of 40 m, which is 0.11 m to either side beside a
clearance of 45 mm. The channel's string (tests/references/channel_string.py) has points 0.25 m apart, and neither
stretch nor bending, as the links have none here; the hole's inclination is straight between
its stations, as minimum curvature has it in a plane.
"""

import re
from functools import cache

import numpy as np
import pytest
import yaml
from cli.in_process import commands_of, only_object
from references.channel_string import ChannelString

import tautline
from drillstring.application import Drillstring
from drillstring.mesh import follows_hole, scatter
from drillstring.model.prepared import well_of
from drillstring.scene.scene import BEAM
from drillstring.statics import enough_links
from drillstring.statics.back_calculation import Measured, fit
from drillstring.statics.enough_links import Doubling
from drillstring.statics.torque_drag import torque_drag
from drillstring.view.torque_summary import fit_in_words, sentences
from drillstring.warnings import warnings
from drillstring.well.followed import followed
from drillstring.well.wellbore import from_survey

FRICTION, LENGTH, APART, PERIOD = 0.3, 800.0, 5.0, 40.0
DEPTH = np.arange(0.0, LENGTH + 1.0, APART)
SWING = np.radians(45.0 + np.sin(2.0 * np.pi * DEPTH / PERIOD))
OD, ID, HOLE, MASS, HEAVY = 0.127, 0.1086, 0.2159, 30.0, 200.0


def document(folder, inclination=SWING, depth=DEPTH, elements=20, kind="lumped", bending="none"):
    rows = "".join(f"{s:.4f},{phi:.12f},0\n" for s, phi in zip(depth, inclination, strict=True))
    (folder / "survey.csv").write_text(f"md [m],inc [rad],azi [deg]\n{rows}")
    return {
        "well": {
            "survey": str(folder / "survey.csv"),
            "diameter": HOLE,
            "wall": {"stiffness": 1e9, "damping": 1e6, "friction": FRICTION},
        },
        "gravity": 10.0,
        "string": [
            {"name": "pipe", "length": "rest", "od": OD, "id": ID, "mass_per_length": MASS},
            {"name": "sinker", "length": HEAVY, "od": OD, "id": ID, "mass_per_length": 10.0 * MASS},
        ],
        "material": {"youngs_modulus": 206e9, "shear_modulus": 79e9, "density": 7850},
        "model": {"kind": kind, "elements": elements, "bending": bending},
        "solver": {"step": 0.01, "end": 1.0},
        "output": {"interval": 0.1},
    }


def scene(folder, *given, **others):
    return tautline.read(document(folder, *given, **others))


@cache
def channel():
    """Hook load picking up and slacking off, N, and torque, N m."""
    s = np.arange(0.0, LENGTH + 0.1, 0.25)
    arc = np.minimum((s / APART).astype(int), DEPTH.size - 2)
    even = np.ones(s.size)
    weight = 10.0 * MASS * np.where(s > LENGTH - HEAVY, 10.0, 1.0)
    inclination, curvature = np.interp(s, DEPTH, SWING), (np.diff(SWING) / APART)[arc]
    string = ChannelString(s, inclination, curvature, weight, 0.5 * (HOLE - OD) * even, OD * even)
    up, down = (string.solve(FRICTION, eps)[0] for eps in (1.0, -1.0))
    return np.array([up, down, string.solve(FRICTION, 0.0)[1]])


def loads(case):
    (point,) = case.points
    return np.array([point.hook_load("pick_up"), point.hook_load("slack_off"), point.torque("rotating")])


@pytest.fixture
def few(monkeypatch):
    """A smooth hole has 20 links where none are asked for: the tests are faster, and 20 miss every bend."""
    monkeypatch.setattr(enough_links, "ELEMENTS", 20)


def mesh_warning(found):
    (text,) = (one.text for one in warnings(found) if one.where == "model.elements")
    return text


@pytest.mark.parametrize(("kind", "within"), [("lumped", 5e-3), (BEAM, 3e-2)])
def test_links_that_nobody_gave_follow_a_hole_that_bends_to_and_fro(kind, within, few, tmp_path):
    # The channel's string has no bending stiffness, and a beam presses by 2.5 % more here.
    string = scene(tmp_path, kind=kind, bending="stiff" if kind == BEAM else "none")
    (given,), (own,) = torque_drag(string, elements=20), torque_drag(string)
    assert loads(given)[2] < 0.9 * channel()[2] and not given.follows
    assert loads(own) == pytest.approx(channel(), rel=within)
    assert own.doubling.settled and own.doubling.links == own.points[0].link_depth.size
    (said,) = (text for text, _ in sentences([own], None) if "bends to and fro" in text)
    assert f"so {own.doubling.links} " in said


def test_links_are_of_one_length_at_all_depths(few, tmp_path):
    (case,) = torque_drag(scene(tmp_path), depths=[500.0, LENGTH])
    short, long = (point.link_depth.size for point in case.points)
    assert long == case.doubling.links and short == pytest.approx(long * 500.0 / LENGTH, abs=2.0)


def test_without_friction_nothing_is_doubled_and_nothing_is_told_of_it(few, tmp_path):
    (case,) = torque_drag(scene(tmp_path), [0.0])
    assert case.doubling is None and not [text for text, _ in sentences([case], None) if "were taken" in text]


@pytest.mark.parametrize("kind", ["lumped", BEAM])
def test_a_mesh_that_misses_bends_is_told_with_where_and_the_number_that_does_not(kind, tmp_path):
    text = mesh_warning(scene(tmp_path, kind=kind))
    assert text.startswith(("from 40 m to 760 m", "from 30 m to 790 m")) and "the clearance is 0.04445 m" in text
    wanted = int(re.search(r"take (\d+) elements", text)[1])
    assert follows_hole(scene(tmp_path, kind=kind, elements=wanted))
    assert not follows_hole(scene(tmp_path, kind=kind, elements=wanted // 2))


def test_the_number_that_is_told_brings_the_torque_within_5_percent(tmp_path):
    wanted = int(re.search(r"take (\d+) elements", mesh_warning(scene(tmp_path)))[1])
    (case,) = torque_drag(scene(tmp_path), elements=wanted)
    assert loads(case) == pytest.approx(channel(), rel=5e-2)


def test_what_a_string_feels_of_a_sine_is_the_mean_of_its_curvature_under_a_triangle():
    # Places h apart see curvature times (sin(x)/x)^2, x = pi h / period, of a sine of small angles.
    depth = np.arange(0.0, 801.0, 0.1)
    well = from_survey(depth, 0.5 + 1e-3 * np.sin(2.0 * np.pi * depth / PERIOD), np.zeros(depth.size))
    found = followed(well, np.arange(3.0, 800.0, 10.0))
    curvature = 1e-3 * 2.0 * np.pi / PERIOD * np.cos(2.0 * np.pi * found.depth / PERIOD)
    assert found.felt == pytest.approx(np.abs(curvature) * 10.0 * np.sinc(10.0 / PERIOD) ** 2, abs=1e-7)


def test_links_follow_a_hole_of_few_arcs_whatever_their_number(tmp_path):
    arcs = np.radians(np.interp(DEPTH, [0.0, 200.0, 500.0, 800.0], [0.0, 0.0, 40.0, 40.0]))
    assert all(follows_hole(scene(tmp_path, arcs, elements=count)) for count in (5, 20, 100))


def test_scatter_of_a_fine_survey_asks_for_no_links_and_is_told_of_the_soft_string(tmp_path):
    fine = np.linspace(0.0, LENGTH, 4001)
    smooth = np.radians(45.0) + np.radians(20.0) * fine / LENGTH
    # 0.02 deg between stations 0.2 m apart move the axis by a millimetre.
    noise = np.random.default_rng(1).normal(0.0, np.radians(0.02), fine.size)
    for inclination, told in ((smooth + noise, True), (smooth, False)):
        found = scene(tmp_path, inclination, fine)
        assert follows_hole(found)
        texts = [one.text for one in scatter(found, well_of(found))]
        assert [text.startswith("the stations are 0.2 m apart and scatter") for text in texts] == [True] * told


def test_stations_10_m_apart_or_more_are_not_said_to_scatter(tmp_path):
    depth = np.arange(0.0, LENGTH + 1.0, 20.0)
    noise = np.random.default_rng(1).normal(0.0, np.radians(0.03), depth.size)
    found = scene(tmp_path, np.radians(45.0) + noise, depth)
    assert scatter(found, well_of(found)) == []


def test_scatter_that_moves_no_load_is_not_warned_of(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    fine = np.arange(0.0, LENGTH + 1.0, 2.0)
    noise = np.random.default_rng(1).normal(0.0, 1.0, fine.size)
    here = commands_of(Drillstring(), capsys)
    # The side force of the tension in bends of 0.05 deg in 2 m is that of the weight; in those of 1e-6 deg it is none.
    for degrees, told in ((1e-6, False), (0.05, True)):
        document_ = document(tmp_path, np.radians(45.0 + degrees * noise), fine)
        (tmp_path / "slant.yaml").write_text(yaml.safe_dump(document_))
        code, out, err = here("torque-drag", "slant.yaml", "--elements", "40", "--json")
        texts = [one["text"] for one in only_object(out)["warnings"]]
        assert code == 0 and any("scatter" in text for text in texts) == told == ("scatter" in err)


def test_a_doubling_that_found_no_load_is_told_with_its_number_of_links(tmp_path):
    (case,) = torque_drag(scene(tmp_path), elements=20)
    nothing = Doubling(1600, None, None, None, case.friction, LENGTH, True)
    (said,) = (text for text, _ in sentences([case._replace(doubling=nothing)], None) if "were taken" in text)
    assert "so 1600 links were taken" in said and "is not known" in said and not nothing.settled


def test_a_load_that_doubling_takes_away_is_no_share_of_nothing():
    assert enough_links._changes((50.0, 0.0, None), (0.0, 0.0, 30.0)) == (-50.0, 0.0, None)


def of_the_channel():
    up, down, _ = channel()
    return Measured(np.array([LENGTH]), np.array([up]), np.array([down]), np.array([2]))


def test_links_that_miss_bends_have_an_error_that_covers_the_friction_of_the_channel(tmp_path):
    off = fit(scene(tmp_path), of_the_channel(), 20)
    # Half of 20 links miss the same bends, and would change nothing.
    assert off.friction > 1.1 * FRICTION and off.elements_error > 0.1 * FRICTION
    assert abs(off.friction - FRICTION) < off.error
    text = f"With {off.compared} elements, which follow the hole"
    assert text in fit_in_words(off._replace(model_error=off.elements_error))


@pytest.mark.study
def test_a_fit_has_links_that_follow_the_hole_where_nobody_gave_any(few, tmp_path):
    found = fit(scene(tmp_path), of_the_channel())
    assert found.friction == pytest.approx(FRICTION, rel=1e-2) and found.elements > 100


def test_the_verb_tells_of_links_that_follow_and_of_those_that_do_not(few, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "swing.yaml").write_text(yaml.safe_dump(document(tmp_path)))
    here = commands_of(Drillstring(), capsys)
    code, out, err = here("torque-drag", "swing.yaml", "--json")
    (case,) = only_object(out)["cases"]
    assert code == 0 and case["elements"] == case["doubling"]["links"] > 100
    assert "elements were taken" not in err and f"so {case['elements']} links were taken" in " ".join(err.split())
    code, out, err = here("torque-drag", "swing.yaml", "--elements", "20", "--json")
    told = only_object(out)
    assert code == 0 and told["elements"] == 20 and told["cases"][0]["doubling"] is None
    assert [one for one in told["warnings"] if "give --elements" in one["text"]]
