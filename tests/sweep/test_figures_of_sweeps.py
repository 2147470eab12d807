"""Figures of a sweep show every curve, every bar and every parameter, or say what they leave out."""

import json
from itertools import pairwise

import numpy as np
import pytest
from cli.in_process import commands_of, leave_out_pixels
from of_the_suite import studies
from sweep.short_hoist import MASS, write_sweep

from crane.application import Crane
from tautline.results.tables.finding import Finding
from tautline.sweeps.cases import Row
from tautline.sweeps.figures import _band, _lines, _map, _scatter, _tornado, not_drawn
from tautline.sweeps.plans import GRID, LATIN, ONE, Parameter, Plan, cases_of
from tautline.sweeps.table import dataset


def number(key, *values, base=np.nan):
    return Parameter(key, "", values, tuple(map(float, values)), None, base)


def word(key, *values):
    return Parameter(key, "", values, (np.nan,) * len(values))


def made(parameters, plan, value_of, names=("tension",)):
    """Cases of a plan, and a table in which each number is a function of the case."""
    cases = cases_of(parameters, plan)
    rows = [Row(k, "done", values={name: float(value_of(k)) for name in names}) for k in range(len(cases))]
    return dataset(cases, {name: Finding(None, "N", name) for name in names}, rows, {"units": "si"}), cases


def laid_out(figure):
    figure.draw_without_rendering()
    return figure


@pytest.mark.parametrize("curves", [3, 9, 45])
def test_every_curve_is_drawn_and_named_in_a_legend_that_lies_beside_them(curves):
    words = [f"law {k}" for k in range(curves)]
    data, cases = made([number("mass", 1, 2, 3), word("path.law", *words)], Plan(GRID), lambda k: 10 * (k % curves) + k)
    figure = laid_out(_lines(data, cases, "tension"))
    (plot,) = figure.axes
    assert [line.get_label() for line in plot.get_lines()] == words
    colours = [(str(line.get_color()), line.get_linestyle()) for line in plot.get_lines()]
    assert len(set(colours)) == curves
    (legend,) = figure.legends
    assert [text.get_text() for text in legend.get_texts()] == words
    box = legend.get_window_extent()
    assert box.x0 >= plot.bbox.x1 and box.x1 <= figure.bbox.x1 and box.y0 >= 0.0
    assert plot.bbox.width > 0.4 * figure.bbox.width


def visible(plot):
    """Bars of some length, as (left, right, bottom, top, colour)."""
    bars = [(*sorted((bar.get_x(), bar.get_x() + bar.get_width())), bar) for bar in plot.patches if bar.get_width()]
    return [(x0, x1, bar.get_y(), bar.get_y() + bar.get_height(), bar.get_facecolor()) for x0, x1, bar in bars]


def test_bars_of_a_tornado_on_one_side_never_cover_one_another():
    values = [10.0, 12.0, 14.0, 13.0, 13.0, 7.0, 13.0, 6.0]
    parameters = [number("same", 1, 2, base=0.5), number("equal", 1, 2, 3, base=0.5), number("both", 1, 3, base=2.0)]
    data, cases = made(parameters, Plan(ONE), lambda k: values[k])
    (plot,) = laid_out(_tornado(data, cases, "tension")).axes
    bars = visible(plot)
    assert len(bars) == 7
    for k, (x0, x1, low, high, _) in enumerate(bars):
        for a0, a1, bottom, top, _ in bars[:k]:
            assert min(x1, a1) <= max(x0, a0) or min(high, top) <= max(low, bottom) + 1e-9


def test_colours_of_a_tornado_tell_smaller_from_larger_than_in_the_scene_and_nothing_of_words():
    from matplotlib.colors import to_rgba

    from tautline.view.figures.figure import COLOURS

    values = [10.0, 12.0, 14.0, 9.0, 7.0]
    data, cases = made([number("mass", 6, 20, base=5.0), word("law", "slip", None)], Plan(ONE), lambda k: values[k])
    (plot,) = laid_out(_tornado(data, cases, "tension")).axes
    of = {round(x1 if x1 > 10.0 else x0, 6): colour for x0, x1, _, _, colour in visible(plot)}
    larger = to_rgba(COLOURS[1])
    assert of[12.0] == of[14.0] == larger
    assert of[9.0] == of[7.0] and of[9.0] not in (larger, to_rgba(COLOURS[0]))
    assert {text.get_text() for text in plot.texts} == {"6", "20", "slip", "null"}
    data, cases = made([word("law", "slip", "stick")], Plan(ONE), lambda k: values[k])
    assert _tornado(data, cases, "tension").axes[0].get_legend() is None


def test_every_bar_of_a_tornado_has_its_value_with_its_unit_at_its_end_where_two_have_one_colour_too():
    values = [10.0, 12.0, 14.0, 9.0, 11.0, 8.0]
    mass = Parameter("mass", "kg", ("6 t", "20 t"), (6000.0, 20000.0), None, 5000.0)
    angle = Parameter("angle", "rad", ("5 deg", "30 deg"), tuple(np.radians([5.0, 30.0])), None, np.radians(10.0))
    data, cases = made([mass, angle, word("law", "slip at a long name")], Plan(ONE), lambda k: values[k])
    (plot,) = laid_out(_tornado(data, cases, "tension")).axes
    ends = {text.get_text(): text.xy[0] for text in plot.texts}
    assert ends == {"6000 kg": 12.0, "20000 kg": 14.0, "5 deg": 9.0, "30 deg": 11.0, "slip at a long name": 8.0}
    assert all(plot.bbox.x0 <= text.get_window_extent().x0 <= plot.bbox.x1 for text in plot.texts)
    assert all(plot.bbox.x0 <= text.get_window_extent().x1 <= plot.bbox.x1 for text in plot.texts)
    told = [text.get_text() for text in plot.get_legend().get_texts()]
    assert told == ["smaller value than in the scene", "larger value than in the scene"]


@pytest.mark.filterwarnings("error")
@pytest.mark.parametrize("dpi", [50, *studies(100), 220])
@pytest.mark.parametrize("key", ["mass", "vessel.motion.heave.harmonic.period", "a.very" + 8 * ".long_key"])
@pytest.mark.parametrize("further", [1e-9, 0.2])
def test_a_tornado_has_room_for_its_bars_and_texts_at_any_fineness_whatever_hardly_moves(dpi, key, further):
    # texts of bars that end at the same place made the axis narrower, and were further out for it: 1.8 % were left
    values = [50.7, 40.9, 60.6, 50.7 * (1.0 + further), 50.7, 50.6]
    mass = Parameter("bodies[0].mass", "kg", ("4 t", "6 t"), (4000.0, 6000.0), None, 5000.0)
    parameters = [mass, number(key, 7, 8, base=8.0), word("law", 26 * "W")]
    data, cases = made(parameters, Plan(ONE), lambda k: values[k])
    figure = _tornado(data, cases, "tension")
    figure.set_dpi(dpi)
    (plot,) = laid_out(figure).axes
    assert plot.bbox.width > 2.0 * dpi and plot.bbox.x1 <= figure.bbox.x1
    legend = plot.get_legend().get_window_extent()
    assert legend.x0 >= 0.0 and legend.x1 <= figure.bbox.x1
    low, high = plot.get_xlim()
    assert high - low < 4.0 * (60.6 - 40.9)
    for text in plot.texts:
        box = text.get_window_extent()
        assert plot.bbox.x0 <= box.x0 and box.x1 <= plot.bbox.x1


def test_points_are_drawn_over_every_parameter_words_among_them():
    parameters = [number(f"key{k}", 1, 2, 3) for k in range(6)] + [word("law", "slip", None)]
    data, cases = made(parameters, Plan(LATIN, 20, 1), lambda k: k)
    figure = laid_out(_scatter(data, cases, "tension"))
    assert [plot.get_xlabel() for plot in figure.axes] == [*(f"key{k}" for k in range(6)), "law"]
    assert [text.get_text() for text in figure.axes[-1].get_xticklabels()] == ["slip", "null"]
    assert not_drawn(data, cases) == []


def test_what_has_no_figure_is_said():
    names = [f"number{k}" for k in range(8)]
    data, cases = made([number("mass", 1, 2)], Plan(GRID), lambda k: k, names)
    (told,) = not_drawn(data, cases)
    assert told.startswith("not drawn: number6, number7.") and "sweep.csv" in told and "first under collect" in told
    data, cases = made([number(key, 1, 2) for key in "abc"], Plan(GRID), lambda k: k)
    (told,) = not_drawn(data, cases)
    assert "a grid in which 3 parameters have several values" in told
    data, cases = made([number(f"key{k}", 1, 2) for k in range(18)], Plan(LATIN, 4, 1), lambda k: k)
    (told,) = not_drawn(data, cases)
    assert "key16, key17" in told and "first under vary" in told


def test_a_sweep_prints_what_it_does_not_draw_and_json_has_it(tmp_path, capsys, monkeypatch):
    monkeypatch.chdir(tmp_path)
    leave_out_pixels(monkeypatch)
    vary = f"{{'{MASS}': [2 t, 4 t], rope.diameter: [30 mm, 36 mm], 'solver.step': [4 ms, 5 ms]}}"
    write_sweep(tmp_path, f"vary: {vary}\ncollect: [max_tension]", "50 ms")
    code, printed, said = commands_of(Crane(), capsys)("sweep", "limits.yaml", "-o", "out", "-j", "1", "--json")
    assert code == 0, said
    (told,) = json.loads(printed)["not_drawn"]
    assert "3 parameters have several values" in told
    assert "note: no figures are drawn of a grid" in said


def spread(size, share):
    """A number of each of nine cases: one of size, and others larger by parts of a share of it."""
    return lambda k: size * (1.0 + share * k / 8.0)


@pytest.mark.parametrize(("size", "share"), [(5.0, 0.0), (5.0, 5e-11), (-3.0e5, 9e-7), (0.0, 0.0)])
def test_numbers_that_differ_by_rounding_have_one_colour_one_height_and_no_bars(size, share):
    pair = [number("mass", 1, 2, 3), number("wind", 1, 2, 3)]
    data, cases = made(pair, Plan(GRID), spread(size, share))
    plot, bar = laid_out(_map(data, cases, "tension")).axes
    low, high = plot.collections[0].get_clim()
    assert (high - low) / (0.5 * abs(low + high) or 1.0) == pytest.approx(0.02, rel=1e-3)
    cells = plot.collections[0].norm(plot.collections[0].get_array())
    assert np.ptp(cells) < 1e-3 and bar.get_xlabel()
    data, cases = made([number("mass", 1, 2, 3), word("law", "a", "b", "c")], Plan(GRID), spread(size, share))
    (plot,) = laid_out(_lines(data, cases, "tension")).axes
    drawn = np.concatenate([line.get_ydata() for line in plot.get_lines()])
    assert np.ptp(drawn) < 1e-3 * np.ptp(plot.get_ylim())
    data, cases = made([number("mass", 1, 2, base=0.5), number("wind", 1, 2, base=0.5)], Plan(ONE), spread(size, share))
    (plot,) = laid_out(_tornado(data, cases, "tension")).axes
    assert all(x1 - x0 < 1e-3 * np.ptp(plot.get_xlim()) for x0, x1, *_ in visible(plot))


@pytest.mark.parametrize(
    ("size", "share"),
    [
        *studies((5.0, 1.5e-6), (123.45, 1.7e-6), (0.5, 1.1e-6), (123.456, 3e-5)),
        (99.9999, 3.3e-6),
        (-5.0, 1e-4),
        (7.0, 0.2),
        (5.0e4, 2e-6),
    ],
)
def test_numbers_of_a_bar_of_colours_and_below_a_tornado_stand_apart_however_long_they_are(size, share):
    figures = []
    data, cases = made([number("mass", 1, 2, 3), number("wind", 1, 2, 3)], Plan(GRID), spread(size, share))
    figures.append(laid_out(_map(data, cases, "tension")))
    assert np.ptp(figures[0].axes[0].collections[0].norm(np.array(figures[0].axes[0].collections[0].get_array()))) == 1
    data, cases = made([number("mass", 1, 2, base=0.5), number("wind", 1, 2, base=0.5)], Plan(ONE), spread(size, share))
    figures.append(laid_out(_tornado(data, cases, "tension")))
    for figure in figures:
        axis = figure.axes[-1].xaxis
        low, high = sorted(axis.get_view_interval())
        texts = [text for text in axis.get_ticklabels() if low <= text.get_position()[0] <= high]
        boxes = sorted((text.get_window_extent().x0, text.get_window_extent().x1) for text in texts)
        assert len(boxes) > 1 and all(end < start for (_, end), (start, _) in pairwise(boxes))


def test_a_logarithmic_map_of_two_values_reaches_half_a_decade_beyond_them_and_has_numbers_at_both():
    pair = [number("stiffness", 8.0, 800.0), number("mass", 3.0, 0.02)]
    data, cases = made(pair, Plan(GRID), float)
    plot, _ = laid_out(_map(data, cases, "tension")).axes
    found = {axis.get_label_text(): axis for axis in (plot.xaxis, plot.yaxis)}
    for name, (low, high) in {"stiffness": (8.0, 800.0), "mass": (0.02, 3.0)}.items():
        axis = found[name]
        assert axis.get_scale() == "log"
        assert axis.get_view_interval() == pytest.approx([low / 10**0.5, high * 10**0.5])
        assert list(axis.get_majorticklocs()) == pytest.approx([low, high])
        assert [text.get_text() for text in axis.get_majorticklabels()] == [f"{low:g}", f"{high:g}"]
        assert not any(text.get_text() for text in axis.get_minorticklabels())


def test_a_logarithmic_map_of_values_close_to_one_another_reaches_half_a_cell_beyond_them():
    data, cases = made([number("stiffness", 1.0, 2.0, 4.0, 8.0, 16.0), number("mass", 1, 2)], Plan(GRID), float)
    plot, _ = laid_out(_map(data, cases, "tension")).axes
    assert plot.get_xscale() == "log" and plot.get_xlim() == pytest.approx((0.5**0.5, 16.0 * 2**0.5))


@pytest.mark.parametrize("along", ["depth", "speed"])
def test_a_band_over_places_in_any_order_goes_one_way(along):
    asked, cases = [2400.0, 500.0, 2500.0, 2300.0], cases_of([number("friction", 1, 2, 3)], Plan(LATIN, samples=3))
    rows = [
        Row(k, "done", values={"load": [k + 0.1 * place for place in asked], along: asked}) for k in range(len(cases))
    ]
    columns = {"load": Finding(None, "N", "load", along), along: Finding(None, "m", along, along)}
    figure = _band(dataset(cases, columns, rows, {"units": "si"}), "load_percentiles")
    (line,) = figure.axes[0].get_lines()
    loads, places = (line.get_xdata(), line.get_ydata()) if along == "depth" else (line.get_ydata(), line.get_xdata())
    assert np.all(np.diff(places) > 0.0)
    # The middle of three cases: each load stays with its place, but for the thousands of the axes.
    assert loads / loads[0] == pytest.approx((1.0 + 0.1 * np.sort(asked)) / 51.0)
