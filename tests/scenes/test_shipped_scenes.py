"""Every scene in data/ runs through the command line, and a number in its result is right."""

import json
import re
import subprocess
import sys
from importlib import metadata
from pathlib import Path
from typing import NamedTuple

import numpy as np
import pytest
import yaml
from references import cables
from references import extensible_rod as rod
from references import soft_string as soft

from tautline.application.installed import Installed
from tautline.results.result import Result
from tautline.study.trials.between_frames import way_of

DATA = Path(__file__).parents[2] / "data"
FILES = {path: yaml.safe_load(path.read_text(encoding="utf8")) for path in sorted(DATA.glob("*.yaml"))}
EXTREME = re.compile(r"(largest|smallest)\b")
SCENES = [path for path, root in FILES.items() if {"well", "string", "CableModel", "path"} & set(root)]


def jwell(report, result):
    # frictionless soft string, dT/ds = -w cos(inclination): hook load within 0.5 % at 12 lumps, and the stretch, the
    # integral of T/EA, 1.665 m, within 1 %; measured 1.650 m at 12 links, 1.661 at 48, 1.662 at 400
    well, string = soft.jwell()
    (pipe, *_), (collar, *_) = string.sections
    s = np.linspace(0.0, well.length, 100_001)
    middle = 0.5 * (s[1:] + s[:-1])
    sizes = np.where(middle < pipe, 0, 1)
    weight, area = (
        np.array([of(od, bore) for _, od, bore in string.sections])[sizes]
        for of in (string.weight, lambda od, bore: np.pi / 4.0 * (od**2 - bore**2))
    )
    step = s[1] * weight * np.cos(np.clip((middle - 2200.0) / 1000.0, 0.0, None))
    tension = np.cumsum(step[::-1])[::-1] - 0.5 * step
    assert collar == 240.0
    assert report["stretch_start"] == pytest.approx((tension / (200e9 * area)).sum() * s[1], rel=1e-2)
    assert report["hook_load_start"] == pytest.approx(soft.hook_load(well, string, 0.0, "rotating"), rel=5e-3)


def iscwsa(report, result):
    # frictionless soft string through the same survey within 1 % at 12 lumps
    md, inc, azi = np.loadtxt(DATA / "iscwsa_reference.csv", delimiter=",", skiprows=5, usecols=(0, 1, 2), unpack=True)
    well = soft.well_from_survey(md, np.radians(inc), np.radians(azi))
    string = soft.String([(md[-1] - 240.0, 0.127, 0.1086), (240.0, 0.165, 0.0572)], mud=1200.0)
    assert report["hook_load_start"] == pytest.approx(soft.hook_load(well, string, 0.0, "rotating"), rel=1e-2)


def field_well(report, result):
    # at rest the wall bears nothing along the hole: weights in mud, from lb/ft of the published tables, by vertical
    # depths of hold, 3 deg/100 ft to 40 deg, hold; the stiff string's bending is what is left
    foot, pound, mud = 0.3048, 0.45359237, 1.0 - 10.0 * 1728.0 / 231.0 / 490.0
    depth = 2000.0 + 100.0 / np.radians(3.0) * np.sin(np.radians(40.0)) + 5000.0 * np.cos(np.radians(40.0))
    below = np.cos(np.radians(40.0)) * np.array([600.0, 270.0 + 6.0 + 30.0])
    collar = np.pi / 4.0 * (6.5**2 - 2.8125**2) / 144.0 * 490.0
    weight = 22.60 * (depth - below.sum()) + 49.3 * below[0] + collar * below[1]
    assert report["hook_load_start"] == pytest.approx(weight * mud * pound * 9.81, rel=1e-3)
    # 30 ft/min up for 6 s less half of the ramp's 2 s, in SI whatever is printed; the bit follows, later and less
    assert result["block_position"][-1] == pytest.approx(-2.5 * foot, rel=1e-9)
    assert 0.0 < report["bit_displacement"] < 2.5 * foot and result.attributes["printed_in"] == "field"


def drilling(report, result):
    # buoyed weights of 2730 m at 22.60 lb/ft, 110 m at 49.3 lb/ft and 160 m of round collar, less the weight on bit
    pound = 0.45359237 / 0.3048
    collar = 7850.0 * np.pi / 4.0 * (6.5**2 - 2.8125**2) * 0.0254**2
    weight = (2730.0 * 22.60 * pound + 110.0 * 49.3 * pound + 160.0 * collar) * (1.0 - 1200.0 / 7850.0) * 9.81
    assert report["hook_load_start"] == pytest.approx(weight - 1e5, rel=1e-3)
    assert report["weight_on_bit_start"] == pytest.approx(1e5, rel=1e-9)
    # wound up to its static torque in proportion to the weight, it sticks and slips at up to twice the drive's speed
    ratio = result["torque_on_bit"] / result["weight_on_bit"]
    assert ratio.max() == pytest.approx(8e3 / 1e5, rel=1e-3)
    spin = result["rotation_rate"][:, -1] * 30.0 / np.pi
    assert 200.0 < spin.max() < 260.0 and (np.abs(spin) < 1e-5).mean() > 0.05
    # 20 m/h at 120 rpm and 100 kN is so much a turn
    turns = result["rotation"][-1, -1] / (2.0 * np.pi)
    assert np.ptp(result["hole_depth"]) == pytest.approx(20.0 / 3600.0 / 2.0 * turns, rel=0.03)


def tripping(report, result):
    # 28 m up, then 0.3 m down; the bit follows but for what the string's friction keeps stretched; the gauge shows the
    # block's 350 kN besides
    assert result["block_position"].min() == pytest.approx(-28.0, abs=1e-5)
    assert result["block_position"][-1] == pytest.approx(-27.7, abs=1e-5)
    assert report["bit_displacement"] == pytest.approx(27.75, abs=0.05)
    assert report["hook_load_max_with_block"] == pytest.approx(report["hook_load_max"] + 350e3, rel=1e-12)
    # 2000 m of mostly drill pipe in mud: the frictionless hook load by vertical depths (22.6 and 49.3 lb/ft, collars)
    sine, cosine = np.sin(np.radians(50.0)), np.cos(np.radians(50.0))
    depth = 600.0 + 500.0 / np.radians(50.0) * sine + (result["bit_depth"][0] - 1100.0) * cosine
    below = cosine * np.array([150.0, 75.0])
    collar = 7850.0 * np.pi / 4.0 * (6.5**2 - 2.8125**2) * 0.0254**2
    kilograms = 22.6 * 1.488164 * (depth - below.sum()) + 49.3 * 1.488164 * below[0] + collar * below[1]
    assert report["hook_load_start"] == pytest.approx(kilograms * GRAVITY * (1.0 - 1250.0 / 7850.0), rel=3e-3)


def hanging(report, result):
    # exact, and nothing moves
    assert report["stretch_start"] == pytest.approx(0.376529, abs=1e-6)
    assert report["bit_displacement"] < 1e-9


def level(case):
    def check(report, result):
        # extensible elastica; it stays at rest
        down = result["position"][:, :, 2]
        assert -down[0].max() == pytest.approx(rod.solve(case).sag, rel=1e-3)
        assert np.ptp(down, axis=0).max() < 1e-6

    return check


def whirl(report, result):
    # the critical speed lies between that of a span pinned and that of one clamped at the stabilisers, under 30 kN and
    # less of compression; the unbalance leads all the way, and above it the offset falls to the order of the unbalance
    span, od, bore, hole, mud = 18.0, 6.5 * 0.0254, 2.8125 * 0.0254, 8.5 * 0.0254, 1200.0
    rigidity = 206e9 * np.pi / 64 * (od**4 - bore**4)
    annular = (hole**2 + od**2) / (hole**2 - od**2)
    mass = np.pi / 4 * (7850.0 * (od**2 - bore**2) + mud * (annular * od**2 + bore**2))
    pinned = (np.pi / span) ** 2 * np.sqrt(rigidity / mass) * np.sqrt(1 - 30e3 / (rigidity * (np.pi / span) ** 2))
    clamped = (4.73004 / span) ** 2 * np.sqrt(rigidity / mass)
    offset = np.hypot(*result["lateral_displacement"][:, 8].T)
    peak = result["rotation_rate"][offset.argmax(), 0]
    assert pinned < peak < clamped and offset.max() > 5.0 * 1.5e-3
    assert report["lateral_offset_max"] == pytest.approx(offset.max())
    assert report["whirl_ratio"] == pytest.approx(1.0, abs=0.02)
    assert offset[-100:].max() < 1.2 * 1.5e-3


def cantilever_bar(report, result):
    # the semidiscrete bar with Green strain, integrated apart (DOP853), over the first 8 s; measured 3.4e-4
    exact = cables.hammer_green(np.asarray(result["time"]))
    tip = result["position"][:, 2, 0] - 1.0
    assert np.abs(tip - exact[:, -2]).max() < 1e-3 * np.abs(tip).max()


def reeled_span(report, result):
    # p of the winch is the integral of the rate in the scene; the tie holds
    assert result["material_coordinate"][-1, 4] == pytest.approx(1.5 - 0.0125 - 0.1 - 0.0125, abs=1e-12)
    assert np.abs(result["position"][:, 2] - result["position"][:, 3]).max() < 1e-9
    assert np.abs(result["slope"][:, 2] - result["slope"][:, 3]).max() < 1e-9


GRAVITY = 9.81


def hoist(report, result):
    # 2 m/s less half of the ramp's second, and the vessel's heave is zero at 12 s; at rest the hook holds the payload,
    # and the rope beside the sheave its 25 m as well
    assert report["rise"] == pytest.approx(23.0, abs=0.05)
    assert result["tension"][0, 1, 1] == pytest.approx(5000.0 * GRAVITY, rel=1e-6)
    assert result["tension"][0, 1, 0] == pytest.approx((5000.0 + 25.0 * 6.5) * GRAVITY, rel=1e-3)


def hookblock(report, result):
    # half of the rope's 9.5 m on two falls, which hold half of the load each, and the weight of 25 m of rope
    assert report["rise"] == pytest.approx(4.75, abs=0.01)
    assert result["tension"][0, 2, 0] == pytest.approx(2500.0 * GRAVITY, rel=5e-4)
    assert result["tension"][0, 2, 1] == pytest.approx((2500.0 + 25.0 * 6.5) * GRAVITY, rel=2e-3)


def landing(report, result):
    # 30 m are paid out; at rest the hook holds the template, and the tip the rope in air and water besides
    assert result["body_position"][-1, 0, 2] == pytest.approx(-2005.0, abs=0.5)
    assert result["tension"][0, 1, 1] == pytest.approx(1.0e5 * GRAVITY, rel=1e-6)
    displaced = 1025.0 * np.pi / 4.0 * 0.077**2
    weight = (1.0e5 + 33.0 * 2000.0 - displaced * 1975.0) * GRAVITY
    assert result["tension"][0, 1, 0] == pytest.approx(weight, rel=5e-3)


def slewing(report, result):
    # 4.8 m are hoisted in all; the boom has turned by 2.75 rad, and the payload is thrown outwards
    assert result["paid_out"][-1, 0] == pytest.approx(-4.8, abs=1e-6)
    tip = np.arctan2(*result["position"][-1, 3, 1::-1])
    assert tip == pytest.approx(0.25 * (12.0 - 1.0), abs=0.05)


def sixteen_falls(report, result):
    # a sixteenth of the rope that is hoisted, and of the load on every fall at rest
    tension = result["tension"][0]
    assert result["paid_out"][-1, 0] == pytest.approx(-9.0, abs=1e-9)
    assert tension[-1].mean() == pytest.approx((80.0e3 / 16.0 + 15.0 * 6.5) * GRAVITY, rel=5e-3)


CLAIMS = {"jwell": jwell, "iscwsa": iscwsa, "hanging": hanging, "field_well": field_well, "drilling": drilling}
CLAIMS |= {"whirl": whirl, "tripping": tripping}
CLAIMS |= {f"configuration_{case.lower()}": level(case) for case in "ABC"}
CLAIMS |= {"cantilever_bar": cantilever_bar, "reeled_span": reeled_span}
CLAIMS |= {"hoist": hoist, "hookblock": hookblock, "landing": landing, "slewing": slewing}
CLAIMS |= {"sixteen_falls": sixteen_falls}
BALANCE = {"reeled_span": 1e-2}
"""Energy that a scene's step of generalized-alpha damps away, where it is more than a thousandth."""
ENDS = {"cantilever_bar": "8", "drilling": "20", "jwell": "1", "iscwsa": "1", "hanging": "0.1"}


APART = ("jwell", "cantilever_bar", "hoist")
"""Scenes that are run by the installed command in a process of its own, one of each command."""


class Printed(NamedTuple):
    out: str
    err: str


def run(name, arguments, apart, monkeypatch, capsys):
    """Exit code of a command and what it prints: in a process of its own, or by the function that its script calls.

    A process spends most of its time on imports and on loading kernels, which this one has done before.
    """
    command = [str(part) for part in (Path(sys.executable).with_name(name), *arguments)]
    if apart:
        done = subprocess.run(command, capture_output=True, text=True, timeout=300)
        return done.returncode, Printed(done.stdout, done.stderr)
    (script,) = metadata.entry_points(group="console_scripts", name=name)
    monkeypatch.setattr(sys, "argv", command)
    with pytest.raises(SystemExit) as ended:
        script.load()()
    return ended.value.code, Printed(*capsys.readouterr())


def without_a_way(scene, result):
    """Headline figures that are called largest or smallest, and that a run does not look for between its frames."""
    application = Installed().for_scene(scene)
    model = application.build(application.read(scene))
    extremes = {name: one["text"] for name, one in result.headline.items() if EXTREME.match(str(one["text"]))}
    return [name for name, text in extremes.items() if not way_of(model, name)]


def test_there_are_scenes():
    assert {"jwell", "iscwsa"} <= {path.stem for path in SCENES}


@pytest.mark.parametrize("scene", SCENES, ids=lambda path: path.stem)
def test_every_shipped_scene_runs_and_a_number_in_its_result_is_right(scene, tmp_path, monkeypatch, capsys):
    assert scene.stem in CLAIMS, f"{scene.name} is new: give it a number to assert in CLAIMS"
    out = tmp_path / "run.nc"
    # Two more runs that estimate the error of the step are for scenes that are run apart, and for tests/study.
    verify = [] if scene.stem in APART else ["--no-verify"]
    name = "crane" if "path" in FILES[scene] else "tautline" if "CableModel" in FILES[scene] else "drillstring"
    end = ["--end", ENDS[scene.stem]] if scene.stem in ENDS else []
    monkeypatch.chdir(tmp_path)
    words = ["simulate", scene, "-o", out, "--json", *end, *verify]
    code, printed = run(name, words, scene.stem in APART, monkeypatch, capsys)
    assert code == 0, printed
    report = json.loads(printed.out)
    assert report["status"] == "done" and report["frames"] >= 2
    assert report["energy_error"] < BALANCE.get(scene.stem, 1e-3)
    result = Result.read(out)
    CLAIMS[scene.stem](report, result)
    assert not without_a_way(scene, result)


@pytest.mark.parametrize("scene", FILES, ids=lambda path: path.stem)
def test_no_shipped_scene_is_warned_of_its_own_steps(scene):
    application = Installed().for_scene(scene)
    found = application.warnings(application.read(scene))
    assert not [one for one in found if one.where.startswith(("solver", "GeneralizedAlpha", "output.interval"))]


@pytest.mark.parametrize("scene", ["hoist", "hose", "jwell", "cantilever_bar"])
def test_parameters_that_a_method_does_not_have_are_a_note_in_every_application(scene):
    """cantilever_bar is a run of RK4 that gives the alphas, as the thesis' files do; the others give rho_inf."""
    from tautline.application.installed import Installed

    application = Installed().for_scene(DATA / f"{scene}.yaml")
    read = application.read(DATA / f"{scene}.yaml")
    other = read if scene == "cantilever_bar" else application.with_overrides(read, method="newmark")
    assert any("ignores" in note for note in application.build(other).notes)
    if scene != "cantilever_bar":
        assert not any("ignores" in note for note in application.build(read).notes)
