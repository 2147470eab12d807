"""Figures of hoses come out whole for every kind of result, and show what was stored."""

import re
import subprocess
import sys
import warnings

import numpy as np
import pytest
from figures.pages import check, lay_out, leave_out_pixels
from figures.synthetic_hose import LENGTH, result
from of_the_suite import studies
from PIL import Image

from gardenhose.motion.curves import name_of, plane_of, shape_of, snapped, spread
from gardenhose.motion.limit_cycle import limit_cycle
from gardenhose.view.figures import FIGURES, draw, figures, flutter_figure, static_figure
from tautline.results.errors import ResultError
from tautline.view.figures.figure import save

EACH = [name for name in FIGURES if name not in ("overview", "ramp")]
RAMP = {"frames": 1201, "ramp": 6.0, "speed": 40.0, "swing": 0.6}


def lines(plot):
    """Labelled curves of a plot: label -> (x, y)."""
    drawn = [line for line in plot.get_lines() if not line.get_label().startswith("_")]
    return {line.get_label(): (np.asarray(line.get_xdata()), np.asarray(line.get_ydata())) for line in drawn}


KINDS = [
    ({}, EACH),
    ({"frames": 1}, [name for name in EACH if name != "waterfall"]),
    ({"frames": 2}, ["phase", "spectrum", "waterfall"]),
    ({"elements": 1, "tilt": 0.6}, ["tip", "shape", "waterfall"]),
    ({"swing": 0.0, "sag": 0.0}, ["phase", "shape", "spectrum"]),
    (RAMP, ["tip", "ramp"]),
]
"""Kinds of results, and which figures have something else in them than those of others; the rest are studies."""
MORE_KINDS = [(kind, [name for name in EACH if name not in names]) for kind, names in KINDS if kind.get("frames") != 1]
MORE_KINDS = [(kind, names) for kind, names in MORE_KINDS if names]
MORE_KINDS += [({"frames": 3}, EACH), ({"frames": 30}, EACH), ({"swing": 0.0}, EACH), ({"speed": 0.0}, EACH)]
MORE_KINDS += [({"swing": 0.0, "start": 1.0, "growth": 9.0}, EACH), ({"speed": -20.0}, EACH)]


@pytest.mark.parametrize(
    ("kind", "names"), [*KINDS, *studies(*MORE_KINDS)], ids=[str(k) for k, _ in KINDS + MORE_KINDS]
)
def test_every_figure_is_drawn_without_a_warning(tmp_path, kind, names):
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        drawn = draw([result(**({"frames": 301} | kind))], names)
        assert list(drawn) == names
        for name in names:
            # Lines, filled shapes and an image: the others have no more than these.
            pixels = name in (("tip", "shape", "waterfall") if not kind else ("ramp",))
            check({name: drawn[name]}, tmp_path, pixels)


def test_every_axis_says_its_quantity_and_unit():
    for figure in draw([result()], EACH).values():
        for plot in figure.axes:
            labels = (plot.get_xlabel(), plot.get_ylabel())
            assert any(labels) and all("[" in text for text in labels if text)


def test_the_overview_is_tip_phase_and_shape_and_the_ramp_where_there_is_one():
    assert list(draw([result()])) == ["tip", "phase", "shape"]
    assert list(draw([result(**RAMP)])) == ["tip", "phase", "shape", "ramp"]
    assert list(draw([result()], ["spectrum", "overview", "tip"])) == ["spectrum", "tip", "phase", "shape"]


def test_the_tip_is_drawn_through_its_frames_with_the_flow_above_and_still_axes_left_out():
    run = result()
    plots = draw([run], ["tip"])["tip"].axes
    assert [plot.get_ylabel() for plot in plots] == ["flow speed\n[m/s]", "tip x [m]", "tip z [m]"]
    np.testing.assert_array_equal(plots[0].get_lines()[0].get_ydata(), run["flow_speed"])
    drawn = plots[2].get_lines()[0]
    np.testing.assert_allclose(np.interp(run.time, drawn.get_xdata(), drawn.get_ydata()), run["tip"][:, 2], atol=1e-12)
    assert "periodic, 6.3 Hz" in plots[0].get_title(loc="left")
    assert len(draw([result(tilt=0.6)], ["tip"])["tip"].axes) == 4
    assert len(draw([result(speed=0.0)], ["tip"])["tip"].axes) == 2


def test_the_phase_portrait_emphasises_the_last_cycles_of_one_result():
    run = result()
    portrait, path = draw([run], ["phase"])["phase"].axes
    cycle = limit_cycle(run.time, run["tip"], run["tip_velocity"], LENGTH)
    curves = lines(portrait)
    assert list(curves) == ["whole run", f"last {cycle.cycles} cycles"]
    place, speed = curves[f"last {cycle.cycles} cycles"]
    assert 0.5 * np.ptp(place) == pytest.approx(cycle.axis_amplitude[2], rel=2e-3)
    assert np.abs(speed).max() == pytest.approx(np.abs(run["tip_velocity"][-100:, 2]).max(), rel=0.02)
    assert portrait.get_xlabel() == "tip z [m]" and portrait.get_ylabel() == "tip velocity z [m/s]"
    assert path.get_xlabel() == "x [m]" and path.get_aspect() == 1.0


def test_phase_portraits_of_several_results_stand_in_one_plot():
    runs = [result(speed=speed, swing=swing) for speed, swing in ((15.0, 0.4), (25.0, 0.7), (35.0, 1.0))]
    portrait, _ = draw(runs, ["phase"])["phase"].axes
    assert list(lines(portrait)) == ["Garden hose, 15 m/s", "Garden hose, 25 m/s", "Garden hose, 35 m/s"]
    sizes = [np.ptp(place) for place, _ in lines(portrait).values()]
    assert sizes == sorted(sizes)


def test_shapes_are_those_of_the_last_cycle_and_end_in_the_tip():
    run = result()
    plot = draw([run], ["shape"])["shape"].axes[0]
    cycle = limit_cycle(run.time, run["tip"], run["tip_velocity"], LENGTH)
    inside = (run.time >= cycle.crossings[-2]) & (run.time <= cycle.crossings[-1])
    ends = [(line.get_xdata()[-1], line.get_ydata()[-1]) for line in plot.get_lines()[:-2]]
    assert 15 < len(ends) <= 24
    for end in ends:
        assert np.abs(run["tip"][inside][:, [0, 2]] - end).sum(axis=1).min() < 1e-12
    assert plot.get_aspect() == 1.0 and (plot.get_xlabel(), plot.get_ylabel()) == ("x [m]", "z [m]")


def test_shapes_of_several_results_have_one_scale():
    plots = draw([result(swing=0.4, speed=15.0), result()], ["shape"])["shape"].axes[:2]
    assert plots[0].get_ylim() == plots[1].get_ylim() and plots[0].get_title(loc="left") == "Garden hose, 15 m/s"


def test_a_spectrum_has_its_line_at_the_frequency():
    plot = draw([result()], ["spectrum"])["spectrum"].axes[0]
    ((text, (frequency, amplitude)),) = lines(plot).items()
    assert text == "6.3 Hz, amplitude 0.208 m" and plot.get_yscale() == "log"
    assert frequency[amplitude.argmax()] == pytest.approx(6.3, abs=0.1)
    assert amplitude.max() == pytest.approx(0.208, rel=0.02)
    time = result().time
    heading = plot.get_title(loc="left")
    assert heading.startswith("spectrum of ") and heading.endswith(f" to {time[-1]:.4g} s")


def test_a_waterfall_is_over_the_length_from_the_root():
    run = result()
    plot, bar = draw([run], ["waterfall"])["waterfall"].axes
    np.testing.assert_allclose(plot.images[0].get_array(), run["axial_force"].T)
    assert plot.get_ylim() == (0.0, LENGTH) and bar.get_ylabel() == "axial_force [N]"


def test_a_ramp_shows_extremes_amplitude_and_where_they_begin():
    run = result(**RAMP)
    place, size = draw([run], ["ramp"])["ramp"].axes
    flow, values = lines(place)["extremes"]
    late = flow > 14.0
    assert 40 < late.sum() < 60 and np.all(np.diff(np.sign(values[late] - values[late].mean())) != 0.0)
    (dots,) = (line for line in size.get_lines() if line.get_marker() == "o")
    flow, amplitude = np.asarray(dots.get_xdata()), np.asarray(dots.get_ydata())
    assert amplitude[flow < 10.0].max(initial=0.0) < 1e-3
    (onset,) = (text for text in lines(size) if "length" in text)
    assert onset.startswith("1 % of the length at 1") and 11.0 < float(onset.split()[-2]) < 13.0
    assert size.get_xlabel() == "flow speed [m/s]" and place.get_ylabel() == "tip z [m]"


def test_a_ramp_of_one_flow_speed_is_refused_and_not_drawn_as_a_column_of_dots():
    with pytest.raises(ResultError, match="one flow speed all the time"):
        draw([result(ramp=0.0)], ["ramp"])
    with pytest.raises(ResultError, match="one flow speed all the time"):
        draw([result(speed=0.0)], ["ramp"])
    assert draw([result(ramp=0.0), result(ramp=0.0, speed=30.0)], ["ramp"])


def test_a_motion_that_is_slim_beside_the_hose_is_drawn_larger_across_and_the_label_says_how_many_times():
    run, slim = result(sag=0.0), result(sag=0.0)
    slim._contents[1]["position"][..., 2] *= 1e-3
    slim._contents[1]["tip"][:, 2] *= 1e-3
    slim._contents[1]["tip_velocity"][:, 2] *= 1e-3
    slim._contents[1]["slope"][..., 2] *= 1e-3
    whole = draw([run], ["shape"])["shape"].axes[0]
    plot = draw([slim], ["shape"])["shape"].axes[0]
    said = re.fullmatch(r"z, drawn (\d+) times larger than x \[m\]", plot.get_ylabel())
    assert whole.get_aspect() == 1.0 and plot.get_aspect() == float(said[1])
    (left, right), (low, high) = plot.get_xlim(), plot.get_ylim()
    assert 1.0 < (right - left) / (float(said[1]) * (high - low)) < 3.0
    assert plot.get_xlabel() == "x [m]"


def scaled(along=1.0, across=1.0):
    """A hose whose motion across, z, and whose places along, x, are so many times those of the usual one."""
    run = result(sag=0.0)
    for axis, factor in ((0, along), (2, across)):
        run._contents[1]["position"][..., axis] *= factor
        run._contents[1]["slope"][..., axis] *= factor
        for name in ("tip", "tip_velocity"):
            run._contents[1][name][:, axis] *= factor
    return run


def test_a_hose_that_is_slim_only_beside_a_longer_one_is_not_drawn_larger_across():
    long = scaled(along=100.0)
    plots = draw([long, result(sag=0.0)], ["shape"])["shape"].axes[:2]
    assert [plot.get_aspect() for plot in plots] == [1.0, 1.0]
    assert draw([long], ["shape"])["shape"].axes[0].get_aspect() > 1.0
    both = draw([long, scaled(across=1e-2)], ["shape"])["shape"].axes[:2]
    assert both[0].get_aspect() == both[1].get_aspect() > 1.0


@pytest.mark.parametrize(("across", "larger"), [(1e-4, True), (1e-6, False)])
def test_a_motion_below_1e_5_of_the_length_is_not_drawn_larger(across, larger):
    """The tip of the usual hose swings by some 0.4 of its length to both sides."""
    assert (draw([scaled(across=across)], ["shape"])["shape"].axes[0].get_aspect() > 1.0) == larger


def test_a_speed_that_rises_and_falls_is_told_apart():
    run = result(**RAMP)
    run._contents[1]["flow_speed"][:] = 40.0 * np.sin(np.pi * run.time / run.time[-1])
    plots = draw([run], ["ramp"])["ramp"].axes
    assert {"extremes, speed rising", "extremes, speed falling"} <= lines(plots[0]).keys()


def test_a_ramp_up_and_down_tells_where_the_motion_ends_and_takes_a_drift_for_no_swing():
    run = result(frames=2401, ramp=12.0, speed=40.0, swing=0.6)
    run._contents[1]["flow_speed"][:] = 40.0 * np.sin(np.pi * run.time / run.time[-1])
    fading = np.clip((run["flow_speed"] - 12.0) / 28.0, 0.0, 1.0) ** 2
    sway = np.sin(2 * np.pi * 6.3 * run.time)
    run._contents[1]["tip"][:] = [0.4, 0.0, 0.0]
    # It rises with the speed, and swings beyond 12 m/s.
    run._contents[1]["tip"][:, 2] += 0.2 * run["flow_speed"] / 40.0 + 0.2 * fading * sway
    run._contents[1]["tip_velocity"][:] = np.gradient(run["tip"], run.time, axis=0)
    place, size = draw([run], ["ramp"])["ramp"].axes
    begins, ends = (text for text in lines(size) if "length" in text)
    assert begins.startswith("1 % of the length at 1") and ends.startswith("1 % of the length last at 1")
    assert place.get_ylabel() == "tip z [m]"
    for dots in (line for line in size.get_lines() if line.get_marker() == "o"):
        flow, amplitude = (np.asarray(values) for values in (dots.get_xdata(), dots.get_ydata()))
        assert amplitude[flow < 11.0].max(initial=0.0) < 5e-3


def test_files_are_named_after_the_result_and_the_figure(tmp_path, monkeypatch):
    leave_out_pixels(monkeypatch)
    one, other = result(tmp_path / "hose.nc", frames=200), result(tmp_path / "second.nc", frames=200)
    names = [file.name for file in figures([one], tmp_path, (), ("png", "svg"))]
    assert names == [f"hose_{name}.{ending}" for name in ("tip", "phase", "shape") for ending in ("png", "svg")]
    assert [file.name for file in figures([one], tmp_path, ("phase",), ("pdf",), "mine")] == ["mine.pdf"]
    assert [file.name for file in figures([one, other], tmp_path, ("tip",))] == ["comparison_tip.png"]


def test_results_of_one_title_are_named_after_their_files(tmp_path):
    runs = [result(tmp_path / "first.nc", frames=50), result(tmp_path / "second.nc", frames=50)]
    assert list(lines(draw(runs, ["tip"])["tip"].axes[0])) == ["first", "second"]


def test_an_unknown_figure_is_refused_with_those_there_are():
    with pytest.raises(
        ResultError, match=r"no figure or variable 'torque'; known: overview \(tip, phase, shape\); tip \("
    ):
        draw([result(frames=2)], ["torque"])


def modes():
    """Two modes in the plane, one of which begins to grow at 9 m/s with 3 Hz, and their likes out of it."""
    speed = np.linspace(0.0, 12.0, 61)
    first = -0.3 * speed + 1j * 2 * np.pi * (1.0 + 0.02 * speed)
    second = 0.4 * (speed - 9.0) + 1j * 2 * np.pi * (4.8 - 0.2 * speed)
    both = np.stack([second, first], axis=1)
    return speed, np.concatenate([both, both.conj() * 1.01], axis=1), np.array([False, False, True, True])


def test_an_argand_diagram_is_that_of_the_literature(tmp_path):
    speed, values, outside = modes()
    figure = flutter_figure(speed, values, np.broadcast_to(outside, values.shape), [(9.0, 3.0)], "Hose")
    argand, growth = figure.axes
    curves = [line for line in argand.get_lines() if len(line.get_xdata()) == len(speed)]
    assert [line.get_linestyle() for line in curves] == ["-", "-", "--", "--"]
    np.testing.assert_allclose(curves[0].get_xdata(), values[:, 0].imag)
    np.testing.assert_allclose(curves[0].get_ydata(), -values[:, 0].real)
    np.testing.assert_allclose(curves[3].get_xdata(), -values[:, 3].imag)  # of a conjugate pair either will do
    assert curves[0].get_color() == curves[2].get_color() != curves[1].get_color() == curves[3].get_color()
    assert "critical: 9 m/s, 3 Hz" in [text.get_text() for text in figure.legends[0].get_texts()]
    rates = [line for line in growth.get_lines() if len(line.get_xdata()) == len(speed)]
    np.testing.assert_allclose(rates[0].get_ydata(), values[:, 0].real)
    assert {"2", "4", "10"} <= {text.get_text() for text in argand.texts}
    assert (argand.get_xlabel(), argand.get_ylabel()) == ("Re ω, frequency [rad/s]", "Im ω, damping [1/s]")
    check({"flutter": figure}, tmp_path, pixels=True)


def test_the_critical_speed_of_each_way_of_flow_is_marked():
    speed, values, outside = modes()
    figure = flutter_figure(speed, values, np.broadcast_to(outside, values.shape), [(9.0, 3.0), (-2.0, 0.5)])
    told = [text.get_text() for text in figure.legends[0].get_texts() if text.get_text().startswith("critical")]
    assert told == ["critical: 9 m/s, 3 Hz", "critical: -2 m/s, 0.5 Hz"]
    marks = [line for line in figure.axes[1].get_lines() if line.get_marker() in ("o", "s") and line.get_ls() == "None"]
    assert [(line.get_marker(), *line.get_xdata()) for line in marks] == [("o", 9.0), ("s", -2.0)]


def test_windows_of_instability_are_shaded_however_narrow(tmp_path):
    speed, values, outside = modes()
    share = np.broadcast_to(outside, values.shape)
    figure = flutter_figure(speed, values, share, windows=[(3.0, 3.0), (9.0, None)])
    growth = figure.axes[1]
    assert [(one.get_x(), one.get_x() + one.get_width()) for one in growth.patches] == [(3.0, 3.0), (9.0, 12.0)]
    assert [text.get_text() for text in figure.legends[0].get_texts()].count("unstable") == 1
    lay_out(figure)
    at = growth.transData.transform((3.0, 0.5 * growth.get_ylim()[1])).astype(int)
    figure.savefig(tmp_path / "flutter.png", dpi=figure.dpi)
    pixels = np.asarray(Image.open(tmp_path / "flutter.png").convert("L"))
    assert (pixels[pixels.shape[0] - at[1], at[0] - 3 : at[0] + 4] < 250).any()
    check({"flutter": figure}, tmp_path, pixels=False)


def dots_and_words(figure):
    argand = figure.axes[0]
    dots = [line for line in argand.get_lines() if line.get_marker() == "o" and line.get_markersize() == 3]
    places = [(float(dot.get_xdata()[0]), float(dot.get_ydata()[0])) for dot in dots]
    return places, {text.get_text() for text in argand.texts}


def test_dots_of_an_argand_diagram_are_at_speeds_that_were_computed():
    speed, values, outside = modes()
    share = np.broadcast_to(outside, values.shape)
    computed = {(abs(v.imag), -v.real) for v in values[::17].ravel()}
    coarse = flutter_figure(speed[::17], values[::17], share[::17])
    dots, words = dots_and_words(coarse)
    assert dots and set(dots) <= computed, "0, 3.4, 6.8 and 10.2 m/s"
    assert words <= {"unstable", "0", "3.4", "6.8", "10.2"}
    dots, words = dots_and_words(flutter_figure(speed, values, share, marks=[3.0, 9.0]))
    assert len(dots) == 2 * values.shape[1] and words == {"unstable", "3", "9"}


def test_an_argand_diagram_of_one_speed_writes_that_speed():
    speed, values, outside = modes()
    for at in (0, 25):
        figure = flutter_figure(speed[at : at + 1], values[at : at + 1], outside[None])
        assert dots_and_words(figure)[1] == {"unstable", f"{speed[at]:g}"}


def test_a_mode_has_one_number_in_and_out_of_the_plane_and_what_has_no_like_its_own():
    # at first, a real one that decays stands before all others by frequency; one along the hose is in the plane alone
    speed, values, outside = modes()
    real = np.linspace(-300.0, -310.0, speed.size) + 0j
    along = -0.1 + 1j * np.linspace(80.0, 70.0, speed.size)
    values = np.column_stack([values, real, along])
    figure = flutter_figure(speed, values, np.broadcast_to([*outside, True, False], values.shape))
    curves = [line for line in figure.axes[0].get_lines() if len(line.get_xdata()) == len(speed)]
    colours = [line.get_color() for line in curves]
    assert colours[0] == colours[2] != colours[1] == colours[3]
    assert len(set(colours)) == 4
    assert sum(text.get_text().startswith("mode ") for text in figure.legends[0].get_texts()) == 4


@pytest.mark.parametrize("count", [8, *studies(14)])
def test_modes_beyond_the_colours_have_a_look_and_a_name_of_their_own_as_the_legend_has_it(tmp_path, count):
    speed = np.linspace(0.0, 5.0, 11)
    values = -0.1 - 0.1 * speed[:, None] + 10j * np.arange(1.0, count + 1.0)
    figure = flutter_figure(speed, values, np.zeros(values.shape))
    named = [line for line in figure.legends[0].get_lines() if line.get_label().startswith("mode ")]
    assert [line.get_label() for line in named] == [f"mode {i + 1}" for i in range(count)]
    for plot in figure.axes:
        curves = [line for line in plot.get_lines() if len(line.get_xdata()) == len(speed)]
        drawn, told = ([(line.get_color(), line.get_linewidth()) for line in some] for some in (curves, named))
        assert drawn == told and len(set(told)) == count
    check({"flutter": figure}, tmp_path, pixels=True)


def test_of_very_many_modes_a_bar_tells_the_number(tmp_path):
    speed = np.linspace(0.0, 5.0, 11)
    values = -0.1 - 0.1 * speed[:, None] + 10j * np.arange(1.0, 31.0)
    figure = flutter_figure(speed, values, np.zeros(values.shape))
    curves = [line for line in figure.axes[0].get_lines() if len(line.get_xdata()) == len(speed)]
    assert len({line.get_color() for line in curves}) == 30
    assert figure.axes[-1].get_xlabel() == "mode" and figure.axes[-1].get_xlim() == (1.0, 30.0)
    assert not figure.legends or not any("mode " in text.get_text() for text in figure.legends[0].get_texts())
    check({"flutter": figure}, tmp_path, pixels=False)


def test_dots_of_one_speed_are_hollow_out_of_the_plane_as_the_legend_has_it():
    speed, values, outside = modes()
    figure = flutter_figure(speed[:1], values[:1], outside[None])
    (legend,) = figure.legends
    told = {line.get_label(): line.get_fillstyle() for line in legend.get_lines() if "plane" in line.get_label()}
    assert told == {"in the plane": "full", "out of the plane": "none"}
    for plot in figure.axes:
        dots = [line for line in plot.get_lines() if line.get_marker() == "o" and line.get_linestyle() != "None"]
        assert [line.get_fillstyle() for line in dots] == ["full", "full", "none", "none"]


def test_a_curve_has_a_gap_where_it_is_not_sure_what_it_goes_on_as():
    speed, values, outside = modes()
    sure = np.full((speed.size - 1, 4), True)
    sure[30, 1] = False
    figure = flutter_figure(speed, values, np.broadcast_to(outside, values.shape), sure=sure)
    curves = [line for line in figure.axes[1].get_lines() if len(line.get_xdata()) == len(speed) + 1]
    broken = [np.isnan(line.get_ydata()) for line in curves]
    assert [gaps.sum() for gaps in broken] == [0, 1, 0, 0]
    assert broken[1][31]


def test_a_flutter_figure_is_drawn_of_little_too():
    speed, values, outside = modes()
    values[20:30, 0] = np.nan
    share = np.where(outside, 0.9, 0.1) * np.ones(values.shape)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        for figure in (
            flutter_figure(speed, values, share),
            flutter_figure(speed[:1], values[:1], share[:1]),
            flutter_figure(speed, values[:, :1] - 10.0, share[:, :1], ()),
            flutter_figure(speed, values[:, :1].real + 0j, share[:, :1], [(9.0, 0.0)]),
        ):
            lay_out(figure)
            assert all(plot.get_lines() for plot in figure.axes)


@pytest.mark.parametrize("count", [1, 13, *studies(5)])
def test_static_shapes_are_drawn_with_their_tips(tmp_path, count):
    speed = np.linspace(0.0, 12.0, count)
    x = np.linspace(0.0, 0.5, 30)
    shapes = [np.stack([x, 0 * x, -(0.9 - 0.05 * value) * x**2], axis=1) for value in speed]
    tips = np.array([shape[-1] for shape in shapes])
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        figure = static_figure(speed, shapes, tips, "Static")
        check({"static": figure}, tmp_path, pixels=True)
    left, right = figure.axes[:2]
    np.testing.assert_allclose(left.get_lines()[0].get_ydata(), shapes[0][:, 2])
    np.testing.assert_allclose(lines(right)["z"][1], tips[:, 2])
    assert (left.get_xlabel(), left.get_ylabel()) == ("x [m]", "z [m]")
    assert ("0 m/s" in lines(left)) == (count <= 8)


def test_a_stability_boundary_stands_beside_the_published_one(tmp_path):
    from benchmarks.hose.figures import boundary_figure

    beta, u = np.array([0.1, 0.2, 0.3]), np.array([4.9, 5.6, 8.6])
    figure = boundary_figure(beta, u, (np.linspace(0, 0.8, 9), np.linspace(4.2, 12, 9)), "Gregory & Païdoussis")
    assert list(lines(figure.axes[0])) == ["Gregory & Païdoussis", "computed"]
    np.testing.assert_array_equal(lines(figure.axes[0])["computed"][1], u)
    assert list(lines(boundary_figure(beta, u).axes[0])) == ["computed"]
    assert save(figure, tmp_path / "boundary.svg").stat().st_size > 5000


def test_a_hose_is_the_cubic_of_its_elements():
    arc = np.array([0.0, 0.2, 0.5])
    cubic = np.polynomial.Polynomial([0.0, 1.0, -0.5, 0.7])
    position = np.stack([arc, 0 * arc, cubic(arc)], axis=1)
    slope = np.stack([1 + 0 * arc, 0 * arc, cubic.deriv()(arc)], axis=1)
    curve = shape_of(position, slope, arc, points=5)
    assert curve.shape == (11, 3)
    np.testing.assert_allclose(curve[:, 2], cubic(curve[:, 0]), atol=1e-15)
    assert shape_of(np.stack([position] * 4), np.stack([slope] * 4), arc, 5).shape == (4, 11, 3)


def test_planes_stand_upright_and_point_from_root_to_tip():
    x, z = np.random.default_rng(0).uniform(-1, 1, (2, 50))
    for towards, across in (([1.0, 0, 0], "x"), ([-1.0, 0, 0], "−x")):
        plane = plane_of(np.stack([x, 1e-4 * z, z], axis=1), np.array(towards))
        assert (name_of(plane.across), name_of(plane.up)) == (across, "z")
    flat = plane_of(np.stack([x, z, 0 * x], axis=1), np.array([1.0, 0.2, 0.0]))
    assert (name_of(flat.across), name_of(flat.up)) == ("x", "y")
    inclined = plane_of(np.stack([0.6 * x, 0.8 * x, z], axis=1), np.array([0.6, 0.8, -0.3]))
    np.testing.assert_allclose(inclined.across, [0.6, 0.8, 0.0], atol=1e-12)
    line = plane_of(np.outer(x, [0.0, 1.0, 0.0]))
    assert name_of(line.up) == "z" and np.abs(line.across[1]) == 1.0
    hanging = plane_of(np.outer(x, [0.0, 0.0, 1.0]))
    assert name_of(hanging.up) == "z"
    assert np.isfinite(np.array(plane_of(np.zeros((3, 3))))).all()


def test_directions_have_short_names():
    assert name_of(snapped(np.array([0.001, 0.0, 0.9999]))) == "z"
    assert name_of(np.array([0.6, 0.0, -0.8])) == "along (0.6, 0, -0.8)"


def test_frames_are_chosen_evenly():
    time = np.linspace(0.0, 1.0, 101)
    assert list(spread(time, 0.2, 0.3, 6)) == [20, 22, 24, 26, 28, 30]
    assert list(spread(time, 0.201, 0.209, 6)) == [21]


def test_the_numbers_of_a_run_need_nothing_that_draws():
    code = "import sys, gardenhose.motion.limit_cycle; assert 'matplotlib' not in sys.modules"
    assert subprocess.run([sys.executable, "-c", code]).returncode == 0
