"""Figures of a sweep show which cases have no number, and can be read where values lie far apart."""

import numpy as np
import pytest
from matplotlib.colors import LogNorm
from sweep.test_figures_of_sweeps import laid_out, made, number, word

from tautline.results.tables.finding import Finding
from tautline.sweeps.cases import Row
from tautline.sweeps.figures import _lines, _map, _scatter, _tornado, not_drawn
from tautline.sweeps.plans import GRID, LATIN, ONE, Parameter, Plan, cases_of
from tautline.sweeps.table import dataset


def partly(parameters, plan, value_of, failed=(), not_run=(), title=""):
    """As `made`, where some cases failed and some were not run."""
    cases = cases_of(parameters, plan)
    rows = [
        Row(k, "unstable", "it flew away") if k in failed else Row(k, "done", values={"tension": float(value_of(k))})
        for k in range(len(cases))
        if k not in not_run
    ]
    return dataset(cases, {"tension": Finding(None, "N", "tension")}, rows, {"units": "si", "title": title}), cases


def seconds(*values, base=np.nan):
    return Parameter("period", "s", values, tuple(map(float, values)), None, base)


def crosses(plot):
    return [line for line in plot.get_lines() if line.get_marker() == "x"]


def heading(figure):
    return figure.get_suptitle().splitlines()


def test_a_curve_says_which_cases_failed_marks_them_and_spans_all_values_that_were_asked_for():
    data, cases = partly([seconds(4, 2, 1, 8, 0.5)], Plan(GRID), lambda k: 10 + k, failed=(2, 4))
    figure = laid_out(_lines(data, cases, "tension"))
    (plot,) = figure.axes
    assert heading(figure) == ["tension", "2 of 5 cases failed: 0.5 s, 1 s"]
    (line,) = crosses(plot)
    assert sorted(line.get_xdata()) == [0.5, 1.0]
    low, high = plot.get_xlim()
    assert low <= 0.5 and high >= 8.0
    assert [text.get_text() for text in plot.get_legend().get_texts()] == ["failed"]
    data, cases = partly([seconds(1, 2, 3)], Plan(GRID), lambda k: k)
    figure = _lines(data, cases, "tension")
    assert heading(figure) == ["tension"] and not crosses(figure.axes[0]) and figure.axes[0].get_legend() is None


def test_of_many_failed_cases_the_first_are_named_and_those_that_were_not_run_are_not_called_failed():
    data, cases = partly([seconds(*range(1, 11))], Plan(GRID), lambda k: k, failed=range(2, 10))
    assert heading(_lines(data, cases, "tension"))[1] == "8 of 10 cases failed: 3 s, 4 s, 5 s, 6 s and 4 more"
    data, cases = partly([seconds(1, 2, 3)], Plan(GRID), lambda k: k, not_run=[2])
    figure = _lines(data, cases, "tension")
    assert heading(figure)[1] == "1 of 3 cases was not run: 3 s"
    assert crosses(figure.axes[0])[0].get_label() == "not run"
    data, cases = partly([seconds(1, 2, 3)], Plan(GRID), lambda k: np.nan if k == 1 else k)
    assert heading(_lines(data, cases, "tension"))[1] == "1 of 3 cases has no number: 2 s"


def test_failed_cases_of_several_curves_have_crosses_in_the_colour_of_their_curve():
    data, cases = partly([seconds(1, 2, 3), word("law", "slip", "stick")], Plan(GRID), lambda k: k, failed=(1, 3, 4))
    figure = laid_out(_lines(data, cases, "tension"))
    found = crosses(figure.axes[0])
    curves = {line.get_label(): line.get_color() for line in figure.axes[0].get_lines()}
    assert [(line.get_color(), sorted(line.get_xdata())) for line in found] == [
        (curves["slip"], [3.0]), (curves["stick"], [1.0, 2.0]),
    ]  # fmt: skip
    assert [text.get_text() for text in figure.legends[0].get_texts()] == ["slip", "stick", "failed"]


def test_a_tornado_names_the_values_that_failed_also_of_a_key_of_which_all_failed():
    parameters = [seconds(0.5, 1, 2, 8, base=4.0), number("mass", 3, 4, base=2.0)]
    data, cases = partly(parameters, Plan(ONE), lambda k: 10 + k, failed=(1, 2, 5, 6))
    figure = laid_out(_tornado(data, cases, "tension"))
    assert heading(figure) == ["tension", "4 of 7 cases failed"]
    names = [text.get_text() for text in figure.axes[0].get_yticklabels()]
    assert names == ["mass\nfailed: 3, 4", "period\nfailed: 0.5 s, 1 s"]
    data, cases = partly(parameters[:1], Plan(ONE), lambda k: 10 + k, failed=(1, 2))
    assert heading(_tornado(data, cases, "tension"))[1] == "2 of 5 cases failed: 0.5 s, 1 s"


def test_a_tornado_that_is_not_drawn_is_told_of():
    data, cases = partly([seconds(0.5, 1, base=4.0)], Plan(ONE), lambda k: 10 + k, failed=(0,))
    assert _tornado(data, cases, "tension") is None
    assert not_drawn(data, cases) == ["not drawn: tension. The case with the scene's own values has no number"]
    data, cases = partly([seconds(0.5, 1, base=4.0)], Plan(ONE), lambda k: 10 + k, failed=(1, 2))
    assert _tornado(data, cases, "tension") is None
    assert "Only the case with the scene's own values has a number" in not_drawn(data, cases)[0]


def test_white_cells_of_a_map_have_a_cross_and_a_legend_and_lie_on_its_axes():
    data, cases = partly([seconds(1, 2, 3), number("mass", 1, 2)], Plan(GRID), lambda k: 5 + k, failed=(1, 4, 5))
    figure = laid_out(_map(data, cases, "tension"))
    plot = figure.axes[0]
    (line,) = crosses(plot)
    assert sorted(zip(*line.get_data(), strict=True)) == [(1.0, 2.0), (3.0, 1.0), (3.0, 2.0)]
    assert line.get_label() == "white: failed" and heading(figure)[1] == "3 of 6 cases failed"
    assert plot.get_xlim()[0] < 1.0 and plot.get_xlim()[1] > 3.0


def test_points_of_failed_samples_are_on_the_axis_of_every_plot():
    data, cases = partly([seconds(1, 2, 3), number("mass", 1, 2)], Plan(LATIN, 12, 1), lambda k: k, failed=(3, 7))
    figure = laid_out(_scatter(data, cases, "tension"))
    for plot, key in zip(figure.axes, ("period", "mass"), strict=True):
        assert crosses(plot)[0].get_xdata() == pytest.approx(cases.numbers[key][[3, 7]])
    assert heading(figure)[1] == "2 of 12 cases failed"


@pytest.mark.parametrize(
    ("values", "scale"),
    [
        ((2, 5, 8, 150, 1000), "log"),
        ((150, 2, 1000, 5, 8), "log"),
        ((1, 10, 100), "log"),
        ((8e3, 8e5), "log"),
        ((1, 29), "linear"),
        ((-1, 50), "linear"),
        ((1, 2, 4), "linear"),
        ((1, 50, 99), "linear"),
        ((2, 5, 8, 20), "linear"),
        ((0, 5, 8, 1000), "linear"),
        ((-2, 5, 8, 1000), "linear"),
    ],
)
def test_axes_are_logarithmic_where_uneven_values_lie_more_than_thirty_times_apart(values, scale):
    data, cases = made([seconds(*values), number("mass", 1, 2)], Plan(GRID), lambda k: 5 + k)
    assert laid_out(_map(data, cases, "tension")).axes[0].get_xscale() == scale
    data, cases = made([seconds(*values)], Plan(GRID), lambda k: 5 + k)
    assert laid_out(_lines(data, cases, "tension")).axes[0].get_xscale() == scale


@pytest.mark.parametrize("values", [(8e6, 8e8), (1, 25), (1, 50, 99), (0.1, 5, 6)])
def test_the_axes_of_a_map_do_not_go_below_zero_where_no_value_does(values):
    data, cases = made([seconds(*values), number("mass", *values)], Plan(GRID), lambda k: 5 + k)
    plot = laid_out(_map(data, cases, "tension")).axes[0]
    for low, high in (plot.get_xlim(), plot.get_ylim()):
        assert 0.0 <= low < values[0] and high > values[-1]


def test_colours_are_by_ratio_where_results_lie_more_than_thirty_times_apart_and_all_are_positive():
    def norm(largest, least=1.0):
        values = [least, 2.0, 3.0, largest]
        data, cases = made([seconds(1, 2), number("mass", 1, 2)], Plan(GRID), lambda k: values[k])
        figure = laid_out(_map(data, cases, "tension"))
        colours = figure.axes[0].collections[0].norm
        bar = figure.axes[1].xaxis
        assert bar.get_scale() == ("log" if isinstance(colours, LogNorm) else "linear")
        assert bar.get_view_interval() == pytest.approx([colours.vmin, colours.vmax])
        return type(colours)

    assert norm(160.0) is LogNorm
    assert norm(20.0) is not LogNorm and norm(160.0, 0.0) is not LogNorm and norm(160.0, -1.0) is not LogNorm


def test_words_are_not_joined_by_lines():
    data, cases = made([word("method", "newmark", "alpha", "euler")], Plan(GRID), lambda k: k)
    (line,) = _lines(data, cases, "tension").axes[0].get_lines()
    assert line.get_linestyle() == "None" and line.get_marker() == "o"


def test_a_sweep_of_one_case_says_that_it_has_no_figure():
    data, cases = made([number("mass", 1)], Plan(GRID), lambda k: k)
    (told,) = not_drawn(data, cases)
    assert "no figures are drawn of one case" in told and "give a key two values" in told


def test_a_long_name_of_a_number_stays_beside_its_axis():
    name = "a very long name of a quantity that nobody would choose but which somebody did anyway and that goes on"
    data, cases = made([number("mass", 1, 2, 3)], Plan(GRID), lambda k: k, [name])
    figure = laid_out(_lines(data, cases, name))
    box = figure.axes[0].yaxis.label.get_window_extent()
    assert box.x0 >= 0.0 and box.y0 >= 0.0 and box.y1 <= figure._suptitle.get_window_extent().y0
