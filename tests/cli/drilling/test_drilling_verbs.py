"""What verbs do with a bit on the bottom: check warns, plot draws, torque-drag and form take its weight as a force."""

from pathlib import Path

import numpy as np
import pytest
from cli.in_process import commands_of, leave_out_pixels, only_object
from physics.wells.strings import GRAVITY, mass_per_length, run, shipped, straight_hole

from drillstring.application import Drillstring
from drillstring.model.build import build
from drillstring.scene.scene import DrillstringScene, read
from drillstring.view.figures import draw
from drillstring.warnings import warnings
from tautline.results.errors import ResultError
from tautline.results.result import Result
from tautline.simulation import simulate

DATA = Path(__file__).parents[3] / "data"
DRILLING = (DATA / "drilling.yaml").read_text(encoding="utf8")
HANGING = (DATA / "hanging.yaml").read_text(encoding="utf8")
BIT = DRILLING[DRILLING.index("bit:\n") : DRILLING.index("model:")]


def with_bit(text, keys):
    """The drilling scene with another bit."""
    return DRILLING.replace(BIT, f"bit: {{{keys}}}\n") if text is None else text + f"\nbit: {{{keys}}}\n"


@pytest.fixture
def drawing(tmp_path, monkeypatch, capsys):
    """Commands that draw their figures in full."""
    monkeypatch.chdir(tmp_path)
    Path("drilling.yaml").write_text(DRILLING, encoding="utf8")
    return commands_of(Drillstring(), capsys)


@pytest.fixture
def drillstring_(drawing, monkeypatch):
    leave_out_pixels(monkeypatch)
    return drawing


def test_torque_and_drag_take_the_weight_on_bit_as_a_force_on_the_string(drillstring_):
    Path("force.yaml").write_text(with_bit(None, "force: -100 kN"), encoding="utf8")
    Path("off.yaml").write_text(with_bit(None, "on_bottom: false"), encoding="utf8")
    found = {}
    for name in ("drilling", "force", "off"):
        code, out, _ = drillstring_("torque-drag", f"{name}.yaml", "--json", "--elements", "20")
        assert code == 0
        found[name] = only_object(out)
    for key in ("pick_up", "slack_off", "rotating"):
        assert found["drilling"][key] == pytest.approx(found["force"][key], rel=1e-9)
    assert found["off"]["rotating"][0] - found["drilling"]["rotating"][0] == pytest.approx(1e5, rel=1e-6)


def test_form_finds_the_string_pressed_by_its_weight_on_bit_as_by_a_force(drillstring_):
    found = []
    for keys in ("on_bottom: true, weight: 20 kN", "force: -20 kN"):
        Path("pressed.yaml").write_text(with_bit(HANGING, keys), encoding="utf8")
        code, out, err = drillstring_("form", "pressed.yaml", "--json")
        assert code == 0, err
        found.append(only_object(out))
    one, other = found
    assert np.allclose(one["position"], other["position"], atol=1e-9)
    assert np.abs(one["difference"]).max() < 1e-5, "the exact rod under that force stands beside it"


WARNED = {
    "more than the string weighs": (with_bit(None, "on_bottom: true, weight: 2 MN"), "bit.weight", "hook load is"),
    "more than the collars weigh": (with_bit(None, "on_bottom: true, weight: 400 kN"), "bit.weight", "may buckle"),
    "a straight hole": (DRILLING, "bit.weight", "hole is perfectly straight, and nothing pushes the string out of it"),
    "long elements": (DRILLING, "bit.weight", "give string[2] `elements: 17` and model `elements: 39`"),
    "a push without a rock": (with_bit(None, "force: -100 kN"), "bit.force", "Beyond 53.7 kN it buckles: from"),
    "a bit without torque": (with_bit(None, "on_bottom: true, weight: 1 kN"), "bit.torque", "no torque at all"),
    "more than a hoist can give": (with_bit(None, "on_bottom: true, weight: 2 MN"), "bit.weight", "hoist cannot push"),
    "a heavy top drive": (
        with_bit(None, "on_bottom: true, weight: 1100 kN").replace("top:\n", "top:\n  weight: 350 kN\n"),
        "bit.weight", "which the top drive's weight gives",
    ),
    "nothing is drilled": (with_bit(None, "on_bottom: true, weight: 1 kN"), "top.block", "not drilled; give bit.pen"),
    "the block is too fast": (DRILLING.replace("to: 20 m/h", "to: 30 m/h"), "top.block", "goes to 150 kN"),
    "the block comes up": (DRILLING.replace("to: 20 m/h", "to: -72 m/h"), "top.block", "is raised at 72 m/h"),
    "the block rests": (DRILLING.replace("to: 20 m/h", "to: 0 m/h"), "top.block", "goes to 0 N"),
    "the bit turns backwards": (
        DRILLING.replace("to: 120 rpm", "to: -120 rpm"), "top.block",
        "a bit that turns backwards does not cut. The hole gets no deeper",
    ),
    "the bit does not turn": (
        DRILLING.replace("to: 120 rpm", "to: 0 rpm"), "top.block", "Give top.rotation a speed, or hold the block"
    ),
    "no numerical damping": (DRILLING.replace("rho_inf: 0.5", "rho_inf: 1"), "solver.rho_inf", "released too early"),
    "an explicit step": (
        DRILLING.replace("generalized-alpha, rho_inf: 0.5", "rk4"), "bit.slip_speed", "chatters at a step of 0.002 s"
    ),
    "Newmark": (
        DRILLING.replace("generalized-alpha, rho_inf: 0.5", "newmark"), "solver.method", "released too early"
    ),
}  # fmt: skip


@pytest.mark.parametrize(
    "keys, key, more",
    [("weight: 100 kN", "weight", ""), ("torque: {static: 8 kN m, kinetic: 4 kN m}", "torque", ""),
     ("penetration: {rate: 20 m/h, speed: 120 rpm, weight: 1 kN}", "penetration", ""),
     ("cutting: {specific_energy: 120 MPa}", "cutting", ""), ("rock: {stiffness: 5.0e7}", "rock", ""),
     ("on_bottom: false, weight: 1 kN, slip_speed: 1", "weight", ", and neither has bit.slip_speed")],
)  # fmt: skip
def test_a_key_of_a_bit_on_bottom_is_warned_of_where_the_bit_hangs_and_puts_no_load_on_the_string(keys, key, more):
    bare, given = DrillstringScene.parse(with_bit(HANGING, "force: 0")), DrillstringScene.parse(with_bit(HANGING, keys))
    (told,) = [one for one in warnings(given) if one.where == f"bit.{key}"]
    assert f"has no effect while bit.on_bottom is false{more}; write on_bottom: true" in told.text
    assert len(warnings(given)) == len(warnings(bare)) + 1
    assert given.bit.load == 0.0


def test_no_scene_of_the_repository_has_a_key_of_the_bit_that_counts_for_nothing():
    wells = [path for path in DATA.rglob("*.yaml") if "\nwell:" in path.read_text(encoding="utf8")]
    assert len(wells) >= 10
    for path in wells:
        assert not any("bit.on_bottom is false" in one.text for one in warnings(read(path))), path


@pytest.mark.parametrize("case", WARNED)
def test_what_a_driller_should_know_is_warned_of(case):
    text, key, words = WARNED[case]
    told = [warning for warning in warnings(DrillstringScene.parse(text)) if warning.where == key]
    assert any(words in warning.text for warning in told), told


@pytest.mark.parametrize(("block", "told"), [(0.0, True), (1.5e5, True), (2.5e5, False)])
def test_a_run_in_which_the_hoist_would_have_to_push_is_warned_of_unless_the_block_weighs_enough(block, told):
    """A string of the weight w L on which its bit pushes upwards with w L + 200 kN: the hook load is -200 kN."""
    weight = mass_per_length() * GRAVITY * 100.0
    changes = {"bit": {"force": -weight - 2e5}, "top": {"weight": block}}
    result = run(straight_hole(0.0, elements=2, **changes))
    assert result["hook_load"].min() == pytest.approx(-2e5, rel=1e-6)
    said = [one for one in result.warnings if "a hoist cannot push" in one]
    assert len(said) == told
    if told:
        assert "the hook load falls to -200 kN at t = " in said[0]
        assert ("no top.weight is given" in said[0]) == (block == 0.0) != ("is only 150 kN" in said[0])
        assert ". Put less force on the bit" in said[0] and "Where the model begins below the rig, add the" in said[0]


@pytest.mark.parametrize(("speed", "lowered"), [(1.0, True), (0.0, False), (-1.0, False)])
def test_to_lower_the_block_more_slowly_is_the_cure_only_where_it_was_lowered(speed, lowered):
    weight = mass_per_length() * GRAVITY * 100.0
    changes = {"bit": {"force": -weight - 2e5}, "top": {"block": {"velocity": {"ramp": {"to": speed, "over": 0.01}}}}}
    (said,) = [one for one in run(straight_hole(0.0, elements=2, **changes)).warnings if "a hoist cannot push" in one]
    assert ("Lower the block more slowly, or put less force" in said) == lowered


@pytest.mark.parametrize(("share", "told"), [(0.005, False), (0.02, True)])
def test_a_push_of_less_than_a_hundredth_of_the_strings_weight_is_no_word(share, told):
    weight = mass_per_length() * GRAVITY * 100.0
    said = run(straight_hole(0.0, elements=2, bit={"force": -(1.0 + share) * weight})).warnings
    assert any("a hoist cannot push" in one for one in said) == told


@pytest.mark.parametrize("name", ["hanging", "configuration_a", "configuration_b", "whirl"])
def test_no_push_is_told_of_a_string_that_is_not_pushed(name):
    assert not any("push" in one for one in run(shipped(name, solver__end=0.1, output__interval=0.1)).warnings)


def test_a_scene_to_start_from_is_the_shipped_one(drillstring_):
    code, _, _ = drillstring_("new", "drilling", "-o", "mine.yaml")
    assert code == 0 and Path("mine.yaml").read_text(encoding="utf8") == DRILLING


def told_of(text):
    return {warning.where for warning in warnings(DrillstringScene.parse(text))}


def test_the_shipped_scene_is_warned_of_nothing_but_that_it_hides_its_buckling_though_it_drills_past_its_well():
    assert told_of(DRILLING) == {"bit.weight"}
    deep = DRILLING.replace("to: 20 m/h", "to: 20 m/s").replace("rate: 20 m/h", "rate: 20 m/s")
    assert told_of(deep) == {"bit.weight"}


def test_what_the_warning_of_buckling_says_makes_the_collars_buckle_onto_the_wall():
    """As it stands nothing ever touches; eccentric collars of short elements bow as soon as they turn."""
    long, bowed = "drill collar 6 1/2 x 2 13/16, length: 160 m", "elements: 17, eccentricity: [0, 2 mm]"
    cured = DRILLING.replace(long, f"{long}, {bowed}").replace("elements: 24", "elements: 39")
    assert told_of(cured) == set()
    short = cured.replace("end: 60 s", "end: 8 s").replace("hold: 3000 m", "hold: 400 m")
    assert told_of(short) == set()
    assert simulate(build(DrillstringScene.parse(short)))["contact_force"].max() > 1e3


@pytest.mark.parametrize(
    "change",
    [
        ("weight: 100 kN", "weight: 50 kN"),  # below 2.55 (EI w^2)^(1/3) = 53.7 kN
        ("model: {kind: lumped, ", "model: {kind: lumped, bending: none, "),
        ("on_bottom: true", "on_bottom: false"),
    ],
)
def test_nothing_is_told_of_buckling_where_nothing_buckles(change):
    found = warnings(DrillstringScene.parse(DRILLING.replace(*change)))
    assert not [one for one in found if "buckl" in one.text]


def test_a_bit_that_cuts_or_does_not_turn_needs_no_torque():
    still = with_bit(None, "on_bottom: true, weight: 1 kN").replace("to: 120 rpm", "to: 0 rpm")
    cuts = with_bit(None, "on_bottom: true, weight: 1 kN, cutting: {specific_energy: 120 MPa}")
    assert "bit.torque" not in told_of(still) | told_of(cuts)


def test_plot_draws_drilling_and_phase_of_one_result_and_of_several(drawing):
    for name, speed in (("one", 120), ("two", 160)):
        Path("scene.yaml").write_text(DRILLING.replace("to: 120 rpm", f"to: {speed} rpm"), encoding="utf8")
        code, _, err = drawing("simulate", "scene.yaml", "-o", f"{name}.nc", "--end", "12", "--no-verify")
        assert code == 0 and "weight on bit at the start" in err and "m/h" in err
    results = [Result.read(f"{name}.nc") for name in ("one", "two")]
    for shown in (results[:1], results):
        made = draw(shown, ["drilling", "phase"])
        assert set(made) == {"drilling", "phase"}
        assert len(made["drilling"].axes) == 4
    lines = {line.get_label(): line for line in draw(results[:1], ["drilling"])["drilling"].axes[0].lines}
    assert lines["bit"].get_ydata() == pytest.approx(results[0]["rotation_rate"][:, -1] * 30.0 / np.pi)
    assert lines["drive"].get_ydata() == pytest.approx(results[0]["drive_speed"] * 30.0 / np.pi)
    code, _, _ = drawing("plot", "one.nc", "two.nc")
    assert code == 0 and list(Path().glob("*drilling*.png"))


def test_a_result_without_a_bit_on_bottom_has_no_drilling_to_draw(drillstring_):
    Path("hanging.yaml").write_text(HANGING, encoding="utf8")
    assert drillstring_("simulate", "hanging.yaml", "--end", "0.1", "--no-verify")[0] == 0
    result = Result.read("hanging.nc")
    assert not {"weight_on_bit", "drive_torque"} & set(result.variables)
    for name in ("drilling", "phase"):
        with pytest.raises(ResultError, match="no bit on the bottom"):
            draw([result], [name])
    assert not {"drilling", "phase"} & set(draw([result]))


@pytest.mark.parametrize(
    ("solver", "told"),
    [
        ("newmark, rho_inf: 0.5", "note: newmark has no rho_inf and ignores it"),
        ("rk4, alpha_m: 0, alpha_f: 0.3", "note: rk4 has no alpha_m and alpha_f and ignores them"),
        ("generalized-alpha, rho_inf: 0.5", ""),
    ],
)
def test_parameters_that_a_method_does_not_have_are_told_when_a_scene_is_checked(drillstring_, solver, told):
    Path("other.yaml").write_text(DRILLING.replace("generalized-alpha, rho_inf: 0.5", solver), encoding="utf8")
    code, _, err = drillstring_("check", "other.yaml")
    said = " ".join(err.split())
    assert code == 0 and told in said and ("ignores" in said) == bool(told)


def test_soft_torque_tells_its_gains_when_a_scene_is_checked(drillstring_):
    soft = DRILLING.replace("kind: pi", "kind: soft_torque").replace("      integral: 2000", "      # integral: 2000")
    Path("soft.yaml").write_text(soft, encoding="utf8")
    code, _, err = drillstring_("check", "soft.yaml")
    said = " ".join(err.split())
    assert code == 0 and "note: soft torque: proportional 5000 N m s/rad, integral" in said
    assert read("soft.yaml").top.rotation.kind == "soft-torque"
