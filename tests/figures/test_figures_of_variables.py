"""Any stored variable is drawn by its name: against time, against another, down a profile, of several results."""

import json

import numpy as np
import pytest
from figures.synthetic_crane import elevator, falls, one_fall
from figures.synthetic_crane import result as crane
from figures.synthetic_hose import result as hose
from figures.synthetic_string import result as string

from crane.view.figures import draw as draw_crane
from drillstring.view.figures import draw
from gardenhose.view.figures import draw as draw_hose
from tautline.application.installed import Single
from tautline.cli.commands.plot import plot as verb
from tautline.results.errors import ResultError
from tautline.results.store import Store
from tautline.results.variable import Variable
from tautline.view.figures.choice import choose
from tautline.view.figures.curves import MOST_LINES, variable_figure

ONE, FALLS = one_fall(), falls(2)


@pytest.fixture(scope="module")
def well():
    return string(frames=60)


@pytest.fixture(scope="module")
def hoist():
    return crane(ONE, frames=40)


def only(figures):
    (figure,) = figures.values()
    return figure


def curves(plot):
    return {line.get_label(): (np.asarray(line.get_xdata()), np.asarray(line.get_ydata())) for line in plot.get_lines()}


def test_a_variable_is_drawn_against_time_in_a_unit_that_keeps_its_numbers_short(well):
    (plot,) = only(draw([well], ["hook_load"])).axes
    ((_, (x, y)),) = curves(plot).items()
    np.testing.assert_array_equal(x, well.time)
    np.testing.assert_allclose(y, well["hook_load"] / 1e3)
    assert (plot.get_xlabel(), plot.get_ylabel()) == ("time [s]", "hook load [kN]")


@pytest.mark.parametrize(
    ("words", "picked"),
    [
        ("tension:winch to boom tip:last", (slice(None), 0, 1)),
        ('tension:"winch to boom tip":last', (slice(None), 0, 1)),
        ("tension:0:1", (slice(None), 0, 1)),
        ("body_position:payload:z", (slice(None), 0, 2)),
        ("body_position:z", (slice(None), slice(None), 2)),
        ("axial_force:3", (slice(None), 2)),
        ("axial_force:-1", (slice(None), -1)),
        ("position:4:x", (slice(None), 3, 0)),
        ("wrap_angle:boom tip", (slice(None), 0)),
    ],
)
def test_a_part_of_a_variable_is_chosen_by_the_name_number_or_place_of_its_members(hoist, words, picked):
    name = words.partition(":")[0]
    np.testing.assert_array_equal(choose(hoist, words).values, hoist[name][picked])


def test_members_whose_names_begin_alike_are_told_apart():
    run = crane(FALLS, frames=5)
    names = [str(name) for name in run["span"]]
    assert "head 1 to block 1" in names
    for k, name in enumerate(names):
        np.testing.assert_array_equal(choose(run, f"tension:{name}:first").values, run["tension"][:, k, 0])


def test_directions_stand_one_below_the_other_and_things_in_one_panel(hoist):
    plots = only(draw_crane([hoist], ["body_position"])).axes
    assert [plot.get_ylabel() for plot in plots] == [f"position of a body, {axis} [m]" for axis in "xyz"]
    for k, plot in enumerate(plots):
        np.testing.assert_allclose(curves(plot)["payload"][1], hoist["body_position"][:, 0, k])
    (plot,) = only(draw_crane([hoist], ["tension:boom tip to hook"])).axes
    assert list(curves(plot)) == ["boom tip", "hook"]


def test_ends_of_a_span_are_called_by_their_items_and_by_first_and_last_where_a_result_does_not_tell_them(hoist):
    whole = ("winch to boom tip, first", "winch to boom tip, last")
    assert choose(hoist, "tension").panels()[0][1][:2] == list(whole)
    assert choose(hoist, "tension:winch to boom tip:last").text == "tension, winch to boom tip, boom tip"
    assert choose(hoist, "fleet_angle:boom tip").panels()[0][1] == ["first", "last"]


def test_directions_are_called_what_the_description_lists():
    coordinates = {
        "axis": ("axis", np.array(["x", "y", "z"]), "", "north, east, down"),
        "side": ("side", np.array(["m1", "m2"]), "", "across the hole, in the Bishop frame"),
    }
    variables = [
        Variable("time", ("time",), "s", "time"),
        Variable("velocity", ("time", "body", "axis"), "m/s", "velocity north, east, down"),
        Variable("lateral_displacement", ("time", "body", "side"), "m", "offset from the hole's axis"),
    ]
    with Store(None, variables, coordinates, {}) as store:
        store.append(
            {"time": np.arange(2.0), "velocity": np.zeros((2, 3, 3)), "lateral_displacement": np.zeros((2, 3, 2))}
        )
        run = store.finish()
    plots = only(draw([run], ["velocity"])).axes
    assert [plot.get_ylabel() for plot in plots] == [f"velocity, {way} [m/s]" for way in ("north", "east", "down")]
    assert choose(run, "velocity:z").text == "velocity, down"
    # what is said of m1 and m2 are not their names
    assert choose(run, "lateral_displacement").labels[-1] == ("m1", "m2")


def test_many_columns_are_a_band_that_holds_all_of_them_and_the_two_ends(well):
    assert well["tension"].shape[1] > MOST_LINES
    (plot,) = only(draw([well], ["tension"])).axes
    (band,) = plot.collections
    points = band.get_paths()[0].vertices
    for time, row in zip(well.time, well["tension"] / 1e3, strict=True):
        at = points[np.isclose(points[:, 0], time), 1]
        assert (at.min(), at.max()) == (pytest.approx(row.min()), pytest.approx(row.max()))
    assert list(curves(plot)) == ["link 0", "link 12"] and band.get_label() == "all 13"


def test_a_variable_against_another_gives_their_pairs(well):
    figures = draw([well], ["hook_load"], "block_position")
    assert list(figures) == ["hook_load_vs_block_position"]
    (plot,) = only(figures).axes
    x, y = plot.get_lines()[0].get_data()
    np.testing.assert_allclose(x, well["block_position"])
    np.testing.assert_allclose(y, well["hook_load"] / 1e3)
    assert (plot.get_xlabel(), plot.get_ylabel()) == ("block position [m]", "hook load [kN]")
    start = plot.get_lines()[1]
    assert start.get_xdata()[0] == well["block_position"][0] and start.get_marker() == "o"


def test_histories_of_one_thing_are_drawn_as_pairs_over_the_run(hoist):
    (plot,) = only(draw_crane([hoist], ["drum_tension"], "paid_out")).axes
    x, y = plot.get_lines()[0].get_data()
    np.testing.assert_allclose(x, hoist["paid_out"][:, 0])
    np.testing.assert_allclose(y, hoist["drum_tension"][:, 0] / 1e3)
    (plot,) = only(draw_crane([hoist], ["wrap_angle"], "paid_out")).axes
    np.testing.assert_allclose(plot.get_lines()[0].get_xdata(), hoist["paid_out"][:, 0])


def test_histories_of_the_same_things_are_drawn_each_against_its_own():
    run = crane(elevator(), frames=10)
    (plot,) = only(draw_crane([run], ["body_velocity:z"], "body_position:z")).axes
    found = curves(plot)
    for k, name in enumerate(("car", "counterweight")):
        np.testing.assert_allclose(found[name][0], run["body_position"][:, k, 2])
        np.testing.assert_allclose(found[name][1], run["body_velocity"][:, k, 2])


def test_along_nodes_a_profile_is_drawn_and_so_it_is_where_times_are_named(hoist):
    (plot,) = only(draw_crane([hoist], ["position:z"], "material_coordinate")).axes
    np.testing.assert_allclose(plot.get_lines()[0].get_xdata(), hoist["material_coordinate"][-1])
    (plot,) = only(draw_crane([hoist], ["drum_tension"], "paid_out@0")).axes
    assert list(curves(plot)) == ["at 0 s"]


def test_a_variable_down_the_string_is_its_profile_at_the_times_that_are_named(well):
    (plot,) = only(draw([well], ["contact_force"], "measured_depth")).axes
    ((text, (x, y)),) = [(text, pair) for text, pair in curves(plot).items() if not text.startswith("_")]
    np.testing.assert_allclose(x, well["contact_force"][-1] / 1e3)
    np.testing.assert_allclose(y, well["measured_depth"][-1])
    assert text == "at 2.95 s" and plot.yaxis_inverted() and plot.get_ylabel() == "measured depth [m]"
    (plot,) = only(draw([well], ["contact_force"], "measured_depth@0,1.01s")).axes
    texts = [text for text in curves(plot) if not text.startswith("_")]
    assert texts == ["at 0 s", "at 1 s"]
    np.testing.assert_allclose(curves(plot)["at 1 s"][0], well["contact_force"][20] / 1e3)


def test_what_belongs_to_elements_is_drawn_in_the_middle_between_their_nodes():
    run = hose(frames=20)
    (plot,) = only(draw_hose([run], ["axial_force"], "arc_length")).axes
    x, y = plot.get_lines()[0].get_data()
    np.testing.assert_allclose(x, 0.5 * (run["arc_length"][1:] + run["arc_length"][:-1]))
    np.testing.assert_allclose(y, run["axial_force"][-1])
    assert plot.get_xlabel() == "unstretched length from the root [m]"


def test_results_of_other_lengths_steps_and_of_one_frame_have_a_line_each_in_one_figure(tmp_path):
    runs = [string(tmp_path / f"{name}.nc", frames=frames) for name, frames in (("a", 40), ("b", 90), ("c", 1))]
    (plot,) = only(draw(runs, ["bit_speed"])).axes
    assert list(curves(plot)) == ["a", "b", "c"]
    for run, (x, y) in zip(runs, curves(plot).values(), strict=True):
        np.testing.assert_array_equal(x, run.time)
        np.testing.assert_allclose(y, run["bit_speed"])
    assert len({line.get_color() for line in plot.get_lines()}) == 3 and plot.get_lines()[2].get_marker() == "o"
    (plot,) = only(draw(runs, ["tension"])).axes
    assert len(plot.collections) == 3 and len(curves(plot)) == 6
    (plot,) = only(draw(runs, ["contact_force"], "measured_depth")).axes
    assert [text for text in curves(plot) if not text.startswith("_")] == ["a, at 1.95 s", "b, at 4.45 s", "c, at 0 s"]
    (plot,) = only(draw(runs, ["hook_load"], "block_position")).axes
    assert [text for text in curves(plot) if not text.startswith("_")] == ["a", "b", "c"]


@pytest.mark.parametrize(
    ("what", "vs", "axis"),
    [
        ("body_velocity", None, "y"),
        ("body_velocity:payload:x", None, "y"),
        ("body_velocity:payload:x", "body_velocity:payload:z", "y"),
        ("body_velocity:payload:z", "body_velocity:payload:x", "x"),
        ("velocity", "material_coordinate", "y"),
    ],
)
def test_a_direction_in_which_nothing_moves_but_for_rounding_is_drawn_as_zero(what, vs, axis):
    run = crane(ONE, frames=40, sway=0.0)
    for name in ("body_velocity", "velocity"):
        moving = run[name].copy()
        moving[..., 2] = 1.3
        moving[..., 0] = 3.6e-14 * np.sin(np.arange(moving[..., 0].size)).reshape(moving[..., 0].shape)
        run._contents[1][name] = moving
    plot = only(draw_crane([run], [what], vs)).axes[0]
    assert getattr(plot, f"get_{axis}lim")() == pytest.approx((-0.13, 0.13))


def test_a_small_motion_that_is_no_rounding_beside_the_other_directions_keeps_its_axis():
    run = crane(ONE, frames=40, sway=1.0e-6)
    (x, *_) = only(draw_crane([run], ["body_velocity"])).axes
    assert max(np.abs(x.get_ylim())) < 2.0e-6


@pytest.mark.parametrize(("axis", "begin"), [(2, 0.0), (2, -100.0), (1, 4.2e6)])
def test_millimetres_are_drawn_where_coordinates_are_those_of_a_map(axis, begin):
    run = crane(ONE, frames=40, sway=0.0)
    place = np.zeros_like(run["position"])
    place[..., 1] = 4.2e6
    place[..., axis] = begin - np.linspace(0.0, 2.8e-3, 40)[:, None]
    # in x doubles of 4.2e6 m are rounded
    place[..., 0] = 9.3e-10 * np.sin(np.arange(place[..., 0].size)).reshape(place[..., 0].shape)
    run._contents[1]["position"] = place
    plots = only(draw_crane([run], ["position"])).axes
    low, high = plots[axis].get_ylim()
    assert 2.8e-3 < high - low < 4e-3
    assert np.ptp(plots[0].get_ylim()) > 1.0


def test_what_is_level_but_for_rounding_is_drawn_level(well):
    well._contents[1]["bit_speed"][:] = 3.0
    well._contents[1]["bit_speed"][::2] += 1e-13
    low, high = only(draw([well], ["bit_speed"])).axes[0].get_ylim()
    assert high - low > 0.1


REFUSED = [
    (
        ["hook_loat"],
        None,
        r"no figure or variable 'hook_loat'; did you mean 'hook_load'\? known: overview \(.*bit_speed",
    ),
    (["tension:99"], None, r"'tension:99': there is no '99' in link; there are 0, 1.* and 1 more"),
    (["hook_load:1"], None, "there is nothing to choose from with '1'"),
    (["well_position"], None, "'well_position' does not change with time; name what to draw it against"),
    (["hook_load"], "blok_position", r"--vs: .*has no variable 'blok_position'; did you mean 'block_position'\?"),
    (["overview"], "time", "--vs: 'overview' is a figure"),
    ([], "time", "--vs: 'time' is to be drawn against, but nothing is named"),
    (["path:2"], None, "the figure 'path' has no parts to choose from"),
    (["hook_load"], "measured_depth", "'measured_depth' has 13 values a frame, and what is drawn against it 1"),
    (["hook_load"], "block_position@3", "'block_position' has one value a frame: it is no profile"),
    (["tension"], "measured_depth@noon", r"'noon' are no times in seconds; .*measured_depth@0,12.5"),
    (["tension"], "measured_depth@0,99", r"t = 99 s is outside of the run.*give times from 0 to 2.95 s"),
    (["tension"], "measured_depth@-1", r"t = -1 s is outside of the run"),
    (["measured_depth@0,12.5"], None, r"--what: times after @ belong to --vs.*--what NAME --vs measured_depth@0,12.5"),
    (["waterfall:nothing"], None, "has no variable 'nothing'"),
]


@pytest.mark.parametrize(("what", "vs", "why"), REFUSED, ids=[f"{what} {vs}" for what, vs, _ in REFUSED])
def test_what_cannot_be_drawn_is_refused_with_what_can(well, what, vs, why):
    with pytest.raises(ResultError, match=why):
        draw([well], what, vs)


def test_names_are_no_curve(hoist):
    with pytest.raises(ResultError, match="'span' are names, not numbers"):
        draw_crane([hoist], ["span"])


def test_a_result_that_lacks_the_member_of_another_is_named(tmp_path):
    runs = [crane(ONE, tmp_path / "one.nc", frames=5), crane(FALLS, tmp_path / "falls.nc", frames=5)]
    with pytest.raises(ResultError, match="there is no 'boom tip to hook' in span or end; there are winch to head 1"):
        draw_crane(runs, ["tension:boom tip to hook"])


def test_the_verb_draws_a_variable_against_another_into_the_file_that_it_is_given(tmp_path, capsys):
    from drillstring.application import Drillstring

    string(tmp_path / "well.nc", frames=20)
    file = tmp_path / "loop.svg"
    verb(Single(Drillstring()), [tmp_path / "well.nc"], file, ["hook_load"], "block_position", None, True)
    assert json.loads(capsys.readouterr().out)["figures"] == [str(file)]
    assert "hook load [kN]" in file.read_text() and "block position [m]" in file.read_text()


def bounded(name, bound):
    """A result of one variable, which goes from 0 to 10 kN, with a limit of its scene."""
    time = np.linspace(0.0, 10.0, 11)
    record = {"name": name, "limit": bound, "variable": "hook_load"}
    with Store(None, [Variable("hook_load", ("time",), "N", "hook load")], None, {}) as store:
        store.append({"time": time, "hook_load": 1e3 * time})
        return store.finish({"limits": [record]})


def test_limits_of_several_results_under_one_name_say_which_results_they_are_of():
    runs, names = [bounded("overload", bound) for bound in (8e3, 9e3, 9e3)], ["a", "b", "c"]
    figure = variable_figure(runs, names, "hook_load", None, "")
    (plot,) = figure.axes
    levels = {label: y[0] for label, (_, y) in curves(plot).items() if label not in names}
    assert levels == {"overload (a)": pytest.approx(8.0), "overload (b, c)": pytest.approx(9.0)}
    drawn = {line.get_label(): line.get_color() for line in plot.get_lines()}
    assert drawn["overload (a)"] == drawn["a"] and drawn["overload (b, c)"] == "black"
    alike = variable_figure(runs[1:], names[1:], "hook_load", None, "").axes[0]
    assert "overload" in curves(alike), "one that all have needs no name of a result"
    alone = variable_figure(runs[:1], names[:1], "hook_load", None, "").axes[0]
    assert "overload" in curves(alone)
