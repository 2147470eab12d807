"""Figures of cranes come out whole for every kind of result, and show what was stored."""

import subprocess
import sys
import warnings

import numpy as np
import pytest
from figures.pages import check, leave_out_pixels
from figures.synthetic_crane import HOOK, LOAD, TIP, WINCH, elevator, falls, fixed_rope, one_fall, result, scene
from of_the_suite import studies

from crane.results.course import course_of, laid_out
from crane.view.figures import FIGURES, draw, draw_scene, figures
from crane.view.path_figure import of_run, of_scene, path_figure
from crane.view.rope_outline import outline
from tautline.results.errors import ResultError

EACH = list(FIGURES)
HISTORIES = ("overview", "tension", "payload", "winch", "sheaves", "energy")
SEA = {"water": {"surface": 0, "density": 1025}, "ground": {"level": -2100, "stiffness": 1.0e7}}


def deep():
    return one_fall(bodies=[LOAD | {"position": [12.4, 0, -2000]}], **SEA)


def lines(plot):
    """Labelled curves of a plot: label -> (x, y)."""
    drawn = [line for line in plot.get_lines() if not line.get_label().startswith("_")]
    return {line.get_label(): (np.asarray(line.get_xdata()), np.asarray(line.get_ydata())) for line in drawn}


def test_long_titles_and_names_leave_the_figures_their_room(tmp_path):
    """matplotlib warns where it finds no room for the plots, and leaves them where they are."""
    long = "the payload of the customer with a very very long name and a serial number 12345-67890-ABCDEF"
    of = one_fall(bodies=[LOAD | {"name": long}], path=[WINCH, TIP, {"end": {"name": "hook", "body": long}}])
    made = result(of)
    made._contents[3]["title"] = "A long title that goes on and on about the lift of a payload with a crane " * 4
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        drawn = draw([made])
        check(drawn, tmp_path, pixels=False)
    assert len(drawn["path"].get_suptitle().splitlines()) == 2
    labels = [line.get_label() for name in ("payload", "spectrum") for plot in drawn[name].axes for line in plot.lines]
    assert any("ABCDEF" in text for text in labels) and not any(long in text for text in labels)


NEAR = {"breaking_load": "60 kN"}
KINDS = [
    (one_fall(rope=NEAR), {"slack": True, "across": 3.0}, EACH),
    (one_fall(), {"frames": 1}, ["overview", "path", "tension", "rainflow", "bending"]),
    (one_fall(), {"bounce": 0.0, "rise": 0.0, "sway": 0.0}, ["overview", "payload", "bending"]),
    (falls(2, mesh={"elements_per_span": 1}), {"frames": 2}, ["path", "sheaves"]),
]
"""Scenes, kinds of results, and which figures differ in them from those of the first: they are laid out."""
MORE_KINDS = [(deep(), {}, ["path"]), (falls(8), {"frames": 21}, ["path", "tension", "bending"])]


@pytest.mark.parametrize(
    ("of", "kind", "other"),
    [*KINDS, *studies(*MORE_KINDS)],
    ids=[f"{of.title}{kind}" for of, kind, _ in KINDS + MORE_KINDS],
)
def test_every_figure_is_drawn_without_a_warning(tmp_path, of, kind, other):
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        drawn = draw([result(of, **kind)])
        swings = kind.get("frames", 201) >= 16 and kind.get("bounce", 1.0) > 0.0
        assert list(drawn) == [name for name in EACH if swings or name != "spectrum"]
        pixels = ("path", "tension", "bending") if kind is KINDS[0][1] else ()
        for name in (name for name in other if name in drawn):
            check({name: drawn[name]}, tmp_path, pixels=name in pixels)


@pytest.mark.parametrize("of", [elevator(), fixed_rope()], ids=lambda of: of.title)
def test_figures_that_a_result_has_nothing_for_are_left_out_unless_asked_for(tmp_path, of):
    run = result(of)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        drawn = draw([run])
        check({name: drawn[name] for name in ("path", "overview")}, tmp_path, pixels=False)
    missing = {"winch"} if of.sheaves else {"winch", "payload", "sheaves", "bending"}
    assert set(EACH) - drawn.keys() == missing
    for name in missing:
        with pytest.raises(ResultError, match="has no"):
            draw([run], [name])


def test_every_axis_says_its_quantity_and_unit():
    for name, figure in draw([result(falls(2))]).items():
        for plot in figure.axes:
            labels = (plot.get_xlabel(), plot.get_ylabel())
            assert any(labels) and all("[" in text for text in labels if text), name


def test_tensions_of_few_ends_are_drawn_one_by_one_and_of_many_as_a_range():
    run = result(one_fall())
    (plot,) = draw([run], ["tension"])["tension"].axes
    curves = lines(plot)
    ends = ["winch", "boom tip, side of winch", "boom tip, side of hook", "hook"]
    assert list(curves) == [*ends, "at the first frame"] and plot.get_ylabel() == "tension [kN]"
    np.testing.assert_allclose(curves["hook"][1], run["tension"][:, 1, 1] / 1e3)
    dotted = [line for line in plot.get_lines() if line.get_linestyle() == ":" and len(line.get_ydata())]
    assert [line.get_ydata()[0] for line in dotted] == list(run["tension"][0].ravel() / 1e3)
    (plot,) = draw([result(falls(16), frames=21)], ["tension"])["tension"].axes
    assert list(lines(plot)) == ["winch", "dead end", "at the first frame"] and plot.collections


def test_tensions_on_both_sides_of_a_sheave_are_both_seen_where_they_are_the_same():
    (plot,) = draw([result(one_fall())], ["tension"])["tension"].axes
    dashed = [line.get_label() for line in plot.get_lines() if line.get_linestyle() == "--"]
    assert dashed == ["boom tip, side of hook"]


def test_the_breaking_load_is_drawn_where_it_is_near():
    near = one_fall(rope={"breaking_load": "60 kN"})
    assert lines(draw([result(near)], ["tension"])["tension"].axes[0])["breaking load"][1][0] == 60.0
    assert "breaking load" not in lines(draw([result(one_fall())], ["tension"])["tension"].axes[0])


def of_rope(breaking_load, title, **kind):
    return result(scene(rope={"breaking_load": breaking_load}, title=title), **kind)


@pytest.mark.parametrize("order", [1, -1])
def test_breaking_loads_of_several_results_are_each_its_own_in_any_order(order):
    runs = [of_rope("400 kN", "strong"), of_rope("60 kN", "weak"), of_rope("70 kN", "worn")][::order]
    (plot,) = draw(runs, ["tension"])["tension"].axes
    drawn = {name: line for name, line in lines(plot).items() if "breaking load" in name}
    assert {name: line[1][0] for name, line in drawn.items()} == {
        "weak, breaking load": 60.0, "worn, breaking load": 70.0,
    }  # fmt: skip
    inks = {line.get_label(): line.get_color() for line in plot.get_lines()}
    assert all(inks[f"{name}, breaking load"] == inks[f"{name}, winch"] for name in ("weak", "worn"))


def test_a_breaking_load_that_several_results_share_is_one_line_with_their_names():
    runs = [of_rope("60 kN", "one"), of_rope("60 kN", "other")]
    shared = {name for name in lines(draw(runs, ["tension"])["tension"].axes[0]) if "breaking" in name}
    assert shared == {"breaking load"}
    runs.append(of_rope("70 kN", "third"))
    named = {name for name in lines(draw(runs, ["tension"])["tension"].axes[0]) if "breaking" in name}
    assert named == {"one, other, breaking load", "third, breaking load"}


def test_slack_of_another_than_the_first_result_is_named():
    (plot,) = draw([of_rope("60 kN", "taut"), of_rope("60 kN", "loose", slack=True)], ["tension"])["tension"].axes
    assert [patch.get_label() for patch in plot.patches] == ["slack"]


def test_slack_and_slip_are_shaded():
    run = result(falls(2), slack=True)
    (plot,) = draw([run], ["tension"])["tension"].axes
    assert "slack" in [patch.get_label() for patch in plot.patches]
    assert "slips: block 1" in [patch.get_label() for patch in draw([run], ["sheaves"])["sheaves"].axes[0].patches]


def test_coordinates_in_which_nothing_moves_are_left_out():
    def drawn(**kind):
        return [plot.get_ylabel() for plot in draw([result(one_fall(), **kind)], ["payload"])["payload"].axes]

    assert drawn() == ["x [m]", "z [m]"] and drawn(across=1.0) == ["x [m]", "y [m]", "z [m]"]
    assert drawn(rise=0.0, sway=0.0) == ["z [m]"]


def test_the_ropes_way_of_a_run_is_that_of_a_taut_rope():
    of = falls(4)
    run = result(of, sway=0.0, rise=0.0)
    course = course_of(run, laid_out(of))
    shot, drawn = of_run(run, course, 0, ""), of_scene(laid_out(of))
    for point in outline(course.layout.path, wheels_of(of)):
        assert distance(point, shot.rope) < 5e-3 and distance(point, drawn.rope) < 5e-3
    assert len(shot.wheels) == 5 and [name for name, _ in shot.ends] == ["dead end"]
    for one, other in zip(shot.wheels, drawn.wheels, strict=True):
        np.testing.assert_allclose(np.r_[one[0], one[1], one[2]], np.r_[other[0], other[1], other[2]], atol=1e-12)


def wheels_of(of):
    from figures.synthetic_crane import _wheel

    return [_wheel(of, laid_out(of), i) for i in range(len(of.path))]


def distance(point, line):
    """From a point to a line of straight pieces, m."""
    begin, end = line[:-1], line[1:]
    along = end - begin
    share = np.clip(((point - begin) * along).sum(axis=1) / np.maximum((along**2).sum(axis=1), 1e-30), 0.0, 1.0)
    return np.linalg.norm(point - begin - share[:, None] * along, axis=1).min()


def test_a_rope_that_leaves_the_plane_is_drawn_in_plan_and_a_deep_one_with_its_crane_apart():
    def views(of, **kind):
        return [plot.get_title(loc="left") for plot in draw([result(of, **kind)], ["path"])["path"].axes]

    assert views(one_fall()) == ["Elevation"]
    assert views(one_fall(), across=3.0) == ["Elevation", "Plan"]
    assert views(deep()) == ["Elevation", "Crane"]
    turned = [WINCH | {"drum": WINCH["drum"] | {"axis": [1, 0, 0]}}]
    turned += [{"sheave": TIP["sheave"] | {"center": [0, 12, 30], "axis": [1, 0, 0]}}, HOOK]
    sideways = one_fall(path=turned, bodies=[LOAD | {"position": [0, 12.4, 5]}])
    assert draw([result(sideways, sway=0.0)], ["path"])["path"].axes[0].get_xlabel() == "y [m]"


def test_bending_is_shared_out_among_the_wheels_metre_by_metre():
    upper, lower = draw([result(one_fall(), sway=0.0)], ["bending"])["bending"].axes
    assert [text.get_text() for text in upper.get_legend().get_texts()] == ["winch", "boom tip"]
    assert max(bar.get_height() for bar in upper.patches) == 1.0
    assert upper.get_title(loc="right") == "smallest D/d 22.2" and "p [m]" in lower.get_xlabel()


def test_rainflow_shows_the_one_range_that_does_as_much():
    figure = draw([result(one_fall(), frequency=1.0)], ["rainflow"])["rainflow"]
    (text,) = (text.get_text() for text in figure.legends[0].get_texts())
    assert "exponent 5" in text and text.startswith("equivalent range 9.")
    still = draw([result(one_fall(), bounce=0.0)], ["rainflow"])["rainflow"]
    assert "nothing varies" in [text.get_text() for text in still.axes[0].texts]


def test_several_results_are_overlaid_and_named_after_their_titles_or_files(tmp_path, monkeypatch):
    one, other = one_fall(), falls(2)
    runs = [result(one, tmp_path / "first.nc", frames=50), result(other, tmp_path / "second.nc", frames=50)]
    assert list(draw(runs)) == ["overview"]
    assert list(lines(draw(runs)["overview"].axes[0])) == ["One fall", "2 falls"]
    assert list(draw(runs, ["winch", "sheaves"])) == ["winch", "sheaves_first", "sheaves_second"]
    leave_out_pixels(monkeypatch)
    names = [file.name for file in figures(runs, tmp_path, (), ("png", "svg"))]
    assert names == ["comparison_overview.png", "comparison_overview.svg"]
    assert [file.name for file in figures(runs[:1], tmp_path, ("path",), ("pdf",), "mine")] == ["mine.pdf"]


@pytest.mark.parametrize(("name", "each"), [("tension", 2), ("payload", 1), ("winch", 1), ("spectrum", 1)])
def test_every_history_of_several_results_has_lines_of_each_in_its_colour(tmp_path, name, each):
    runs = [result(one_fall(), tmp_path / "first.nc"), result(one_fall(), tmp_path / "other.nc", frames=50, bounce=0.2)]
    plot = draw(runs, [name])[name].axes[0]
    found = lines(plot)
    assert len(found) == 2 * each
    for start in ("first", "other"):
        mine = [line for line in plot.get_lines() if line.get_label().startswith(start)]
        assert len(mine) == each and len({line.get_color() for line in mine}) == 1


def test_tensions_of_several_results_are_both_ends_of_each_rope(tmp_path):
    runs = [result(one_fall(), tmp_path / "first.nc"), result(one_fall(), tmp_path / "other.nc", frames=1)]
    curves = lines(draw(runs, ["tension"])["tension"].axes[0])
    np.testing.assert_allclose(curves["first, hook"][1], runs[0]["tension"][:, 1, 1] / 1e3)
    np.testing.assert_allclose(curves["other, winch"][1], runs[1]["tension"][:, 0, 0] / 1e3)


def test_a_spectrum_has_the_line_of_a_swinging_tension_and_none_of_hoisting():
    run = result(one_fall(), frequency=2.0, bounce=0.1)
    # The load's height rises along a straight line: it has no panel.
    (tension,) = draw([run], ["spectrum"])["spectrum"].axes
    ((text, (frequency, size)),) = lines(tension).items()
    # The load of 5 t hangs on one sheave; the tension of the second span is 1 % larger.
    name, _, found = text.partition(": ")
    tallest, unit, _, at, _ = found.split()
    assert name == "boom tip, side of hook" and unit == "kN"
    assert float(tallest) == pytest.approx(0.1 * 5 * 9.81 * 1.01, rel=0.011) and float(at) == pytest.approx(
        2.0, abs=0.03
    )
    assert frequency[size.argmax()] == pytest.approx(float(at), rel=0.01) and size.max() == pytest.approx(
        float(tallest), rel=0.01
    )
    with pytest.raises(ResultError, match="nothing that swings"):
        draw([result(one_fall(), bounce=0.0, rise=0.0)], ["spectrum"])
    with pytest.raises(ResultError, match="3 frames, too few for a spectrum"):
        draw([result(one_fall(), frames=3)], ["spectrum"])


def test_histories_are_drawn_where_the_scenes_files_are_gone():
    run = result(one_fall())
    run.attributes["scene"] = "no scene"
    assert list(draw([run])) == [name for name in EACH if name in (*HISTORIES, "spectrum", "rainflow")]
    assert "winch to boom tip, first" in lines(draw([run], ["tension"])["tension"].axes[0])
    with pytest.raises(ResultError, match="its scene cannot be read"):
        draw([run], ["path"])


def test_an_unknown_figure_is_refused_with_those_there_are():
    with pytest.raises(
        ResultError, match=r"no figure or variable 'torque'; did you mean 'winch_torque'\? known: overview \("
    ):
        draw([result(one_fall(), frames=2)], ["torque"])


def test_a_scene_is_drawn_with_the_names_of_winch_tip_and_load_and_the_water_that_lies_near():
    of = one_fall(water={"surface": 0, "density": 1025})
    figure = path_figure([of_scene(laid_out(of))], of, "")
    plot = figure.axes[0]
    words = [text.get_text() for text in plot.texts]
    assert {WINCH["drum"]["name"], TIP["sheave"]["name"], LOAD["name"], "water"} <= set(words)
    deep_water = one_fall(water={"surface": -500, "density": 1025})
    far = path_figure([of_scene(laid_out(deep_water))], deep_water, "").axes[0]
    assert far.get_ylim()[0] > -50.0 and "water" not in [text.get_text() for text in far.texts]


@pytest.mark.parametrize("ending", ["png", "svg", "pdf"])
def test_a_scene_is_drawn_into_a_file_of_each_format(tmp_path, ending):
    assert draw_scene(deep(), tmp_path / f"scene.{ending}").stat().st_size > 5000


def test_a_scene_cannot_be_drawn_into_an_unknown_format(tmp_path):
    with pytest.raises(ResultError, match="use png, svg or pdf"):
        draw_scene(one_fall(), tmp_path / "scene.docx")


def test_a_summary_needs_nothing_that_draws():
    code = "import sys, crane.results.summary, crane.model.build; assert 'matplotlib' not in sys.modules"
    assert subprocess.run([sys.executable, "-c", code]).returncode == 0
