"""The figures that sum a run of a crane up, against made-up runs of which they are known, and one that was computed."""

import math
import re
from pathlib import Path

import numpy as np
import pytest
from figures.synthetic_crane import HOOK, LOAD, TIP, WINCH, elevator, falls, fixed_rope, one_fall, result

import tautline
from crane.assembly.tension_at_rest import static_tension
from crane.model.build import build
from crane.results.angles import hook_span, leads
from crane.results.course import contacts_of, course_of, laid_out, nodes_of, scene_of
from crane.results.limits import limits
from crane.results.rows import aside
from crane.results.summary import headline, most_worked_end, possible_figures, span_ends
from crane.scene.scene import read
from tautline.integrators.status import Status, StoppedEarly
from tautline.results.errors import ResultError, once_each
from tautline.scene.errors import SceneError
from tautline.simulation import simulate

DATA = Path(__file__).parents[2] / "data"
KINDS = [
    (one_fall, {}), (one_fall, {"frames": 1}), (one_fall, {"frames": 2}), (one_fall, {"bounce": 0.0, "rise": 0.0}),
    (one_fall, {"slack": True}), (falls, {}), (elevator, {}), (fixed_rope, {}), (fixed_rope, {"frames": 1}),
]  # fmt: skip


def summed(of, **kind):
    return headline(result(of, **kind), of)


def value(found, name):
    return found[name]["value"]


@pytest.mark.parametrize(("of", "kind"), KINDS, ids=[f"{of.__name__} {kind}" for of, kind in KINDS])
def test_every_kind_of_run_is_summed_up_in_finite_numbers(of, kind):
    made = of(4) if of is falls else of()
    found = summed(made, **{"frames": 51} | kind)
    for figure in found.values():
        assert figure.keys() == {"value", "unit", "text"} and math.isfinite(figure["value"])
        assert isinstance(figure["value"], (int, float)) and figure["text"]
    assert {"max_tension", "min_tension", "slack_events", "safety_factor"} <= found.keys()
    assert ("max_winch_power" in found) == bool(made.drums)
    assert ("max_sheave_load" in found) == bool(made.sheaves)


def test_the_largest_tension_is_told_with_where_and_when():
    run = result(one_fall())
    found = headline(run, one_fall())
    tension = run["tension"]
    frame = int(np.argmax(tension[:, 1, 0]))
    assert value(found, "max_tension") == tension.max()
    assert found["max_tension"]["text"] == f"largest tension (boom tip, side of hook, at {run.time[frame]:.4g} s)"
    assert value(found, "safety_factor") == pytest.approx(1.1e6 / tension.max())
    assert value(found, "dynamic_amplification") == pytest.approx(tension.max() / tension[0, 1, 0])
    places = ("winch", "boom_tip_in", "boom_tip_out", "hook")
    assert [value(found, f"max_tension_{place}") for place in places] == list(tension.max(axis=0).ravel())


def test_of_many_sheaves_only_the_largest_tension_is_told():
    found = summed(falls(16), frames=11)
    told = [name for name in found if name.startswith("max_tension_")]
    assert told == ["max_tension_winch", "max_tension_dead_end", "max_tension_sheaves"]
    assert len(span_ends(falls(16))) == len(set(span_ends(falls(16)))) == 34


def test_without_a_breaking_load_there_is_no_safety_factor_and_without_a_diameter_no_ratio():
    bare = one_fall(rope={"breaking_load": None, "diameter": None})
    assert not {"safety_factor", "smallest_bending_ratio"} & summed(bare, frames=11).keys()


def test_without_a_diameter_no_bending_cycles_are_told_as_any_tremble_at_a_sheave_would_be_one():
    # 13 of a rope that is lowered and hoisted back, which makes 3
    trembling = {"bounce": 0.05, "rise": 0.0, "sway": 0.0, "frames": 201}
    bare = one_fall(rope={"diameter": None})
    assert "max_bending_cycles" not in summed(bare, **trembling)
    assert value(summed(one_fall(), **trembling), "max_bending_cycles") <= 1.0
    assert "max_bending_cycles" in possible_figures(one_fall()) and "max_bending_cycles" not in possible_figures(bare)


CURE = r"give rope\.diameter: without it each tremble"


def test_a_limit_on_bending_cycles_of_a_rope_without_a_diameter_is_refused_with_the_cure_and_its_line():
    """`check` passed it, and the run was not judged, without a reason."""
    limits = {"limits": [{"output": "max_bending_cycles", "at_most": 10}]}
    with pytest.raises(SceneError, match=rf"limits\[0\]\.output = max_bending_cycles: .*{CURE}"):
        build(one_fall(rope={"diameter": None}, **limits))
    assert [one.output for one in build(one_fall(**limits)).bounds] == ["max_bending_cycles"]


def test_a_sweep_that_collects_bending_cycles_of_a_rope_without_a_diameter_is_refused_with_the_cure():
    """It was refused after its first run: "did you mean 'tension_cycles'?"."""
    bare = tautline.read(DATA / "hoist.yaml").replace({"rope.diameter": None})
    with pytest.raises(SceneError, match=rf"collect\[0\] = max_bending_cycles: .*{CURE}"):
        tautline.sweep(bare, {"bodies[0].mass": ["5 t"]}, collect=["max_bending_cycles"])


def test_a_scene_that_starts_as_drawn_is_held_against_an_estimate_of_its_rest():
    drawn = one_fall(start="as drawn")
    run = result(drawn)
    run._contents[1]["tension"][0] = 0.0
    found = headline(run, drawn)
    rest = static_tension(drawn, laid_out(drawn).path).ravel()
    wanted = (run["tension"].reshape(-1, 4) / rest).max()
    assert value(found, "dynamic_amplification") == pytest.approx(wanted)
    assert "estimate" in found["dynamic_amplification"]["text"]


def test_slack_is_told_with_its_length_and_its_snap():
    run = result(one_fall(), slack=True)
    found = headline(run, one_fall())
    assert value(found, "slack_events") == 2 and isinstance(value(found, "slack_events"), int)
    assert value(found, "longest_slack") == pytest.approx(1.0, abs=0.11)
    after = run["tension"][(run.time > 5.0) & (run.time < 7.0)]
    assert value(found, "max_snap") == after.max() and "winch to boom tip" in found["longest_slack"]["text"]
    assert not {"longest_slack", "max_snap"} & summed(one_fall()).keys()


def test_the_snap_of_a_heavy_rope_is_that_of_its_upper_end():
    run = result(one_fall(), slack=True)
    ends = run._contents[1]["tension"]
    ends[:, 1, 0] += 2.0e5
    found = headline(run, one_fall())
    after = ends[(run.time > 5.0) & (run.time < 7.0)]
    assert value(found, "max_snap") == after[:, 1].max() and "boom tip to hook" in found["max_snap"]["text"]


def test_the_winch_gives_the_rope_its_tension_times_its_travel():
    coarse = {"bounce": 0.0, "sway": 0.0, "frames": 51}
    found = summed(one_fall(interval=0.2), rise=15.0, **coarse)
    assert value(found, "energy_hoisted") == pytest.approx(5000.0 * 9.81 * 15.0, rel=1e-6)
    assert value(found, "max_winch_power") == pytest.approx(5000.0 * 9.81 * 1.5, rel=1e-6)
    assert value(found, "energy_regenerated") == 0.0
    lowered = summed(one_fall(interval=0.2), rise=-15.0, **coarse)
    assert value(lowered, "energy_regenerated") == pytest.approx(5000.0 * 9.81 * 15.0, rel=1e-6)
    assert value(lowered, "energy_hoisted") == 0.0


def test_the_equivalent_range_is_that_of_equal_cycles():
    found = summed(one_fall(), frequency=1.0)
    assert value(found, "equivalent_tension_range") == pytest.approx(0.2 * 5000.0 * 9.81 * 1.01, rel=0.02)
    assert "m = 5" in found["equivalent_tension_range"]["text"]


def test_the_most_worked_end_is_that_of_most_damage():
    time = np.linspace(0.0, 10.0, 201)
    still, much = 1e5 + 0.0 * time, 1e5 + 1e4 * np.sin(2 * np.pi * time)
    few = 1e5 + 1.3e4 * np.where(time < 1.0, np.sin(2 * np.pi * time), 0.0)
    assert most_worked_end(time, np.stack([still, few, much], axis=1))[0] == 2
    assert most_worked_end(time, np.stack([still, still], axis=1))[0] == 0


def test_hoisting_over_a_sheave_bends_each_metre_once_and_back():
    found = summed(one_fall(interval=0.2), sway=0.0, frames=51)
    assert value(found, "max_bending_cycles") == 1.0 and "boom tip" in found["max_bending_cycles"]["text"]
    assert value(found, "smallest_bending_ratio") == pytest.approx(0.8 / 0.036)
    assert value(summed(one_fall(interval=0.2), sway=0.0, rise=0.0, frames=51), "max_bending_cycles") == 0.0
    # In four falls the rope that hoisting brings over two sheaves is bent by both.
    assert value(summed(falls(4), sway=0.0, rise=20.0, frames=51), "max_bending_cycles") >= 3.0


@pytest.mark.parametrize("of", [one_fall(), falls(4), elevator()], ids=lambda of: of.title)
def test_between_what_lies_on_two_wheels_is_the_rope_of_a_span(of):
    run = result(of, sway=1.0, across=0.7, bounce=0.0, frames=41)
    course = course_of(run, laid_out(of))
    wheels = {contact.name: contact for contact in contacts_of(run, course)}
    node = nodes_of(of)
    stretch = 1.0 + run["tension"].max() / of.rope.axial_stiffness
    for k in range(len(of.path) - 1):
        one, two = of.path[k], of.path[k + 1]
        begin = wheels[one.name].off if one.name in wheels else run["material_coordinate"][:, node[k]]
        end = wheels[two.name].on if two.name in wheels else run["material_coordinate"][:, node[k + 1]]
        length = np.linalg.norm(course.touch(k + 1, True) - course.touch(k, False), axis=1)
        # Made-up material is that of the middle of a wrap, and unstretched; marks stand still.
        assert np.abs(end - begin - length).max() < 0.05 + 2.0 * (stretch - 1.0) * length.max()


def test_the_course_of_a_single_element_is_that_of_many():
    coarse, fine = (falls(2, mesh={"elements_per_span": n}) for n in (1, 4))
    one, many = (course_of(result(of, sway=1.0, across=0.5, frames=41), laid_out(of)) for of in (coarse, fine))
    for name in ("comes", "leaves", "middle"):
        np.testing.assert_allclose(getattr(one, name), getattr(many, name), atol=1e-8)


def test_loads_are_told_by_rise_and_displacement():
    found = summed(elevator(interval=0.2), sway=0.3, frames=51)
    assert value(found, "rise_car") == pytest.approx(15.0) and value(found, "rise_counterweight") == pytest.approx(
        -15.0
    )
    assert value(summed(one_fall(interval=0.2), sway=0.3, frames=51), "max_displacement") == pytest.approx(
        np.hypot(15.0, 0.3 * np.sin(10.0)), rel=1e-3
    )


def test_lead_angles_are_those_of_the_rope_from_plumb_in_and_out_of_the_sheaves_plane():
    rope = np.array([[0.0, 2.0, -25.0], [2.0, 0.0, -25.0], [-2.0, 0.0, -25.0], [0.0, 0.0, -25.0]])
    axis = np.broadcast_to([0.0, 1.0, 0.0], rope.shape)
    off, side = leads(rope, axis, (0.0, 0.0, -9.81))
    lean = math.atan2(2.0, 25.0)
    np.testing.assert_allclose(np.abs(off), [0.0, lean, lean, 0.0], rtol=1e-14)
    assert off[1] == -off[2]
    np.testing.assert_allclose(side, [lean, 0.0, 0.0, 0.0], rtol=1e-14)


def test_angles_in_a_result_are_those_of_the_course_of_the_rope():
    scene = read(DATA / "slewing.yaml").replace({"solver.end": 3.0})
    run = simulate(build(scene))
    course = course_of(run, laid_out(scene))
    wheel, hook = hook_span(scene)
    e = course.comes[:, hook] if hook > wheel else -course.leaves[:, hook]
    off, side = leads(e, course.axis[:, wheel], scene.gravity)
    assert np.abs(run["offlead"]).max() > 1e-3 and np.abs(run["sidelead"]).max() > 1e-3
    np.testing.assert_allclose(run["offlead"], off, atol=1e-9)
    np.testing.assert_allclose(run["sidelead"], side, atol=1e-9)
    drum = scene.path.index(scene.drums[0])
    along = np.abs(np.arcsin((course.leaves[:, drum] * course.axis[:, drum]).sum(axis=-1)))
    np.testing.assert_allclose(run["drum_fleet_angle"][:, 0], along, atol=1e-9)
    assert value(headline(run, scene), "max_sidelead") == np.abs(run["sidelead"]).max()


def test_angles_that_are_rounding_are_none_and_have_no_time_and_larger_ones_stay():
    """Figures took them away, and limits did not."""
    of = one_fall()
    for size, there in ((8e-10, False), (2e-9, True)):
        run = result(of, frames=11)
        for name in ("offlead", "sidelead", "fleet_angle", "drum_fleet_angle"):
            run._contents[1][name] = np.full_like(run[name], -size)
        found = headline(run, of)
        for name in ("max_offlead", "max_sidelead", "max_fleet_angle"):
            assert value(found, name) == (size if there else 0.0)
            assert ("at 0 s" in found[name]["text"]) is there
        judged = {record["name"]: record["value"] for record in limits(run, of)}
        assert [judged[name] for name in ("fleet_angle", "drum_fleet_angle", "sidelead")] == [size * there] * 3


def test_a_ratio_of_diameters_is_of_no_time():
    (record,) = [one for one in limits(result(one_fall(), frames=11), one_fall()) if one["name"] == "bending_ratio"]
    assert record["time"] is None and record["place"] == "boom tip"


@pytest.mark.parametrize(
    ("ways", "left_out"),
    [
        ({"rise": 23.0, "max_rise": 23.0, "max_displacement": 23.0}, {"max_rise", "max_displacement"}),
        ({"rise": 4.9, "max_rise": 5.0, "max_displacement": 16.7}, set()),
        ({"rise": -30.0, "max_rise": 0.0, "max_displacement": 30.0}, {"max_rise", "max_displacement"}),
        ({"rise": -30.0, "max_rise": 0.5, "max_displacement": 30.3}, set()),
        ({"rise": 0.0, "max_rise": 2.0, "max_displacement": 2.0}, {"max_displacement"}),
    ],
)
def test_a_way_of_a_load_that_is_another_of_its_ways_is_not_printed_again(ways, left_out):
    for of in ("", "_car"):
        found = aside({name + of: {"value": way, "unit": "m", "text": ""} for name, way in ways.items()}, [])
        assert {name for name in found if name.endswith(("rise" + of, "displacement" + of))} == {
            n + of for n in left_out
        }


def test_what_a_winch_takes_back_is_printed_where_brakes_are_concerned():
    for hoisted, back in ((5.0, 0.04), (5.0, 1.0), (1.0, 5.0)):
        figures = {"energy_hoisted": {"value": hoisted}, "energy_regenerated": {"value": back}}
        assert ("energy_regenerated" in aside(figures, [])) is (back < 0.1)


def test_a_figure_that_a_limit_tells_is_printed_where_there_is_no_such_limit():
    figures = {"max_fleet_angle": {"value": 0.1}, "max_sidelead": {"value": 0.1}}
    assert {"max_fleet_angle"} == aside(figures, [{"name": "fleet_angle", "value": 0.1}]) & figures.keys()


def test_a_figure_is_printed_beside_a_limit_that_tells_of_another_place():
    """A sheave that may be run at 60 deg: the limit is of the one that is nearest to its own bound."""
    figures = {"max_fleet_angle": {"value": 0.106}}
    assert not aside(figures, [{"name": "fleet_angle", "value": 0.035}]) & figures.keys()


def test_tensions_at_drums_and_ends_are_printed_and_those_beside_sheaves_are_not():
    names = ("winch", "hook", "boom_tip_in", "boom_tip_out_2", "sheaves", "boom_tip_in_2")
    found = aside({f"max_tension_{name}": {"value": 1.0} for name in names}, [])
    assert {name for name in names if f"max_tension_{name}" not in found} == {"winch", "hook"}


def test_names_of_items_make_keys():
    odd = {"end": {"name": "Hook [5 t]!", "body": "payload"}}
    found = summed(one_fall(path=[WINCH, TIP, odd]), frames=11)
    assert "max_tension_hook_5_t" in found and all(re.fullmatch("[a-z0-9_]+", name) for name in found)
    alike = [WINCH, TIP, {"end": HOOK["end"] | {"name": "Boom tip, in"}}]
    told = [name for name in summed(one_fall(path=alike), frames=11) if name.startswith("max_tension_")]
    assert told == [f"max_tension_{end}" for end in ("winch", "boom_tip_in", "boom_tip_out", "boom_tip_in_2")]


def test_a_result_whose_scene_names_files_that_are_gone_says_so(tmp_path):
    run = result(one_fall())
    run.attributes["scene"] = run.attributes["scene"].replace("pay_out: 0", "pay_out: {table: {file: gone.csv}}")
    with pytest.raises(ResultError, match=r"its scene cannot be read: .*beside the result"):
        scene_of(run)


def test_a_result_of_another_version_whose_scene_has_keys_of_that_names_the_key_and_the_version():
    run = result(one_fall())
    run.attributes["scene"], run.attributes["version"] = run.attributes["scene"] + "\nof_later: 3\n", "99.0"
    with pytest.raises(ResultError, match=r"of_later: unknown key; read it with Tautline 99.0, which wrote it"):
        scene_of(run)


def test_a_vessel_whose_record_is_gone_is_taken_to_rest():
    vessel = {"reference": [0, 0, 0], "motion": {"file": "gone.csv"}}
    assert laid_out(one_fall(vessel=vessel)).path.length == laid_out(one_fall()).path.length


def test_a_computed_hoist_is_summed_up_as_its_frames_say():
    hoisting = {"drum": WINCH["drum"] | {"pay_out": {"ramp": {"to": -2.0, "over": 1.0}}}}
    of = one_fall(path=[hoisting, TIP, HOOK], bodies=[LOAD], solver={"end": "3 s", "rho_inf": 0.6}, interval=0.02)
    run = simulate(build(of))
    found = run.headline
    assert value(found, "rise") == pytest.approx(5.0, rel=2e-3)
    assert value(found, "max_tension") == run["tension"].max()
    work = run["external_work"][-1] - run["external_work"][0]
    assert value(found, "energy_hoisted") - value(found, "energy_regenerated") == pytest.approx(work, rel=2e-3)
    course = course_of(run, laid_out(of))
    drum, sheave = contacts_of(run, course)
    tension, stiffness = run["axial_force"], of.rope.axial_stiffness
    straight = np.linalg.norm(course.touch(1, True) - course.touch(0, False), axis=1)
    length = (sheave.on - drum.off) * (1.0 + tension[:, :4].mean(axis=1) / stiffness)
    # Its elements sag and sway between the two, by millimetres of length.
    np.testing.assert_allclose(length, straight, atol=5e-3)
    assert value(found, "max_bending_cycles") == 1.0


def test_the_rise_is_that_at_the_end_and_the_largest_stands_beside_it():
    of = one_fall()
    made = result(of, frames=51)
    found, height = headline(made, of), np.asarray(made["body_position"])[:, 0, 2]
    assert found["rise"]["text"].endswith("at the end")
    assert value(found, "rise") == pytest.approx(height[-1] - height[0])
    assert value(found, "max_rise") == pytest.approx(height.max() - height[0])


def test_what_happens_on_a_wheel_is_told_of_the_wheel_and_not_of_an_axis():
    stop = StoppedEarly(Status.SLACK_ON_WHEEL, 11.866, "winch: x")
    assert stop.line.startswith("stopped at t = 11.866 s, winch: slack rope has fallen back")
    assert "hook: x" in StoppedEarly(Status.NOT_FINITE, 1.0, "hook: x").line


def test_several_variables_in_one_option_are_to_be_written_once_for_each():
    assert once_each("a, b") == "write it once for each: --what a --what b"
    assert once_each("a") == ""


def test_an_element_of_a_rope_is_named_by_its_span():
    scene = read(DATA / "hoist.yaml")
    dims, names, *_ = build(scene).coordinates["element_name"]
    counts = scene.elements
    assert dims == "element" and len(names) == sum(counts)
    assert names[0] == f"winch to boom tip, element 1 of {counts[0]}"
