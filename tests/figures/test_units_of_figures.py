"""Figures of a scene with `units: field`: labels and the numbers drawn are the oilfield's, and mean what SI's did."""

import matplotlib.pyplot as plt
import numpy as np
import pytest
from figures.synthetic_string import result

from drillstring.view.figures import draw
from tautline.view.figures.orbit import bar_beside, draw_amplitudes
from tautline.view.figures.unit_axes import UnitLocator, converted, in_words, use_units

FOOT, KIP, POUND_FOOT = 0.3048, 4448.2216152605, 1.3558179483


def field(**changes):
    run = result(None, **({"frames": 100} | changes))
    run.attributes["printed_in"] = "field"
    return run


def ticks(axis):
    """Places and numbers of the ticks that are seen."""
    axis.get_figure().canvas.draw()
    low, high = sorted(axis.get_view_interval())
    shown = [
        (tick, label.get_text()) for tick, label in zip(axis.get_majorticklocs(), axis.get_ticklabels(), strict=True)
    ]
    kept = [
        (place, float(text.replace("\N{MINUS SIGN}", "-"))) for place, text in shown if low <= place <= high and text
    ]
    return np.array(kept).T


SI = {"m", "mm", "m/s", *(prefix + unit for prefix in ("", "k", "M") for unit in ("N", "N m", "J"))}


def test_every_axis_of_every_figure_is_in_oilfield_units_or_in_none():
    for name, figure in draw([field(turning=True)]).items():
        every = [axis for plot in figure.axes for axis in (plot.xaxis, plot.yaxis)]
        texts = [axis.get_label_text() for axis in every]
        units = {text[text.rindex("[") + 1 : -1] for text in texts if "[" in text}
        assert not units & SI, name
        assert units & {"ft", "in", "kip", "ft/s", "kft-lbf"}, name


@pytest.mark.parametrize(
    ("figure", "number", "which", "text", "unit"),
    [
        ("overview", 0, "yaxis", "displacement\ndown the hole [ft]", FOOT),
        ("overview", 2, "yaxis", "bit speed [ft/s]", FOOT),
        ("forces", 0, "yaxis", "measured depth [ft]", FOOT),
        ("path", 0, "yaxis", "true vertical depth [ft]", FOOT),
        ("orbit", 0, "xaxis", "offset along m2 [in]", 25.4),
    ],
)
def test_numbers_at_the_ticks_are_the_places_in_feet_or_inches(figure, number, which, text, unit):
    axis = getattr(draw([field()], [figure])[figure].axes[number], which)
    assert axis.get_label_text() == text
    places, numbers = ticks(axis)
    assert numbers.size >= 3 and numbers == pytest.approx(places / unit, rel=1e-6, abs=1e-9)
    steps = np.diff(numbers)
    assert steps == pytest.approx(steps[0]), "round numbers, evenly"
    mantissa = abs(steps[0]) / 10.0 ** np.floor(np.log10(abs(steps[0])) + 1e-9)
    assert min(abs(mantissa - one) for one in (1.0, 1.5, 2.0, 2.5, 3.0, 4.0, 5.0, 6.0, 8.0)) < 1e-6


def test_forces_are_in_kip_and_the_curves_are_those_of_si():
    si, own = (draw([run], ["overview"])["overview"] for run in (result(None, frames=100), field()))
    plain, load = si.axes[1], own.axes[1]
    assert load.get_ylabel() == "hook load [kip]" and plain.get_ylabel().endswith("N]")
    assert np.array_equal(plain.lines[0].get_ydata(), load.lines[0].get_ydata())
    places, numbers = ticks(load.yaxis)
    prefix = {"k": 1e3, "M": 1e6}[plain.get_ylabel()[-3]]
    assert numbers == pytest.approx(places * prefix / KIP, rel=1e-6)


def test_colour_bar_of_a_waterfall_and_any_variable_are_converted():
    bar = draw([field()], ["waterfall"])["waterfall"].axes[-1].yaxis
    assert bar.get_label_text().endswith("[kip]")
    places, numbers = ticks(bar)
    assert numbers.size >= 3 and numbers == pytest.approx(1e3 / KIP * places, rel=1e-6)
    (figure,) = draw([field()], ["hook_load"]).values()
    assert figure.axes[0].get_ylabel().endswith("[kip]")


def test_panels_without_a_label_have_the_unit_of_their_row_and_headings_are_converted():
    figure = draw([field()], ["orbit"])["orbit"]
    for plot in figure.axes:
        for axis in (plot.xaxis, plot.yaxis):
            assert isinstance(axis.get_major_locator(), UnitLocator)
        assert plot.get_title(loc="left").endswith(" ft")


def test_a_scene_in_si_is_drawn_as_before():
    figure = draw([result(None, frames=100)], ["overview"])["overview"]
    assert figure.axes[0].get_ylabel().endswith("[m]")
    assert not isinstance(figure.axes[0].yaxis.get_major_locator(), UnitLocator)


def test_what_is_in_oilfield_units_is_left_alone():
    figure, (one, two) = plt.subplots(1, 2)
    one.set_xlabel("hook load [kip]")
    two.set_xlabel("time [s]")
    one.plot([0, 10], [0, 1])
    use_units(use_units(figure, "field"), "field")
    assert one.get_xlabel() == "hook load [kip]" and two.get_xlabel() == "time [s]"
    plt.close(figure)


def test_a_logarithmic_axis_has_powers_of_ten_of_the_oilfields_unit():
    figure, plot = plt.subplots()
    plot.plot([0.0, 1.0], [1e-4, 3.0])
    plot.set_yscale("log")
    plot.set_ylabel("distance from the rod [m]")
    use_units(figure, "field")
    figure.canvas.draw()
    assert plot.get_ylabel() == "distance from the rod [ft]"
    places = plot.yaxis.get_majorticklocs() / FOOT
    texts = [label.get_text() for label in plot.yaxis.get_ticklabels()]
    written = [float(10.0 ** int(text.split("{")[-1].split("}")[0])) for text in texts if text]
    assert len(written) >= 4 and places[: len(written)] == pytest.approx(written, rel=1e-9)
    plt.close(figure)


def test_a_bar_of_colours_that_lifts_what_is_weak_is_in_inches():
    figure, plot = plt.subplots()
    bar_beside(figure, plot, draw_amplitudes(plot, np.arange(3.0), np.arange(2.0), np.full((2, 3), 25.4)), "way [mm]")
    use_units(figure, "field")
    axis = figure.axes[1].yaxis
    places, numbers = ticks(axis)
    assert axis.get_label_text() == "way [in]" and numbers == pytest.approx(places / 25.4, abs=1e-9)
    plt.close(figure)


def test_figures_in_legends_and_beside_curves_are_converted_like_the_axis_below_them():
    figure, plot = plt.subplots()
    plot.plot([0.0, 80.0], [0.0, 1.0], label="equivalent range 44.48 kN, 12 cycles")
    plot.plot([0.0, 80.0], [0.0, 1.0], label="bob: 0.0254 m at 2.74 Hz")
    plot.text(0.5, 0.5, "breaks at 3.048 m/s")
    plot.set_xlabel("range of tension [kN]")
    plot.legend(title="of 30.48 m of rope")
    figure.legend(loc="outside lower center")
    use_units(figure, "field")
    said = ["equivalent range 10 kip, 12 cycles", "bob: 1 in at 2.74 Hz"]
    for legend in (plot.get_legend(), figure.legends[0]):
        assert [text.get_text() for text in legend.get_texts()] == said
    assert plot.get_legend().get_title().get_text() == "of 100 ft of rope"
    assert plot.texts[0].get_text() == "breaks at 10 ft/s" and plot.get_xlabel() == "range of tension [kip]"
    plt.close(figure)


def test_figures_in_headings_are_converted_with_their_prefixes_and_other_words_are_kept():
    assert in_words("lump 3, 1240 m", "field") == "lump 3, 4068 ft"
    assert in_words("bit, 3773 m", "field") == "bit, 12379 ft"
    assert in_words("tension, at most 1.5 MN", "field") == "tension, at most 337.2 kip"
    assert (
        in_words("side force, at most 3.2 kN/m of 40 mesh lumps", "field")
        == "side force, at most 219.3 lbf/ft of 40 mesh lumps"
    )
    assert in_words("after 12 s, at 30 deg, in 5 mud", "field") == "after 12 s, at 30 deg, in 5 mud"
    assert converted(25.4, "mm", "field") == (pytest.approx(1.0), "in")
    assert converted(2.0, "kN m", "field") == (pytest.approx(2000.0 / POUND_FOOT / 1000.0), "kft-lbf")
    assert converted(30.48, "m/h", "field") == (pytest.approx(100.0), "ft/h")
    assert converted(2.0, "Hz", "field") == (2.0, "Hz")
