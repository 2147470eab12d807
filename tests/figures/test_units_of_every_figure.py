"""What a label says of an axis holds for its ticks: in every figure of every application, in oilfield units.

The reference is what each unit is worth in SI, written out here, against the figure of the same run in SI.
"""

import functools
import re

import numpy as np
import pytest
from figures import synthetic_crane, synthetic_hose, synthetic_string, test_cable_figures

import crane.view.figures
import drillstring.view.figures
import gardenhose.view.figures
import tautline.cable.view.figures

INCH, POUND = 0.0254, 4.4482216152605
FOOT = 12.0 * INCH
FIELD = {
    "ft": FOOT, "in": INCH, "ft/s": FOOT, "ft/h": FOOT / 3600.0, "lbf": POUND, "kip": 1e3 * POUND,
    "ft-lbf": FOOT * POUND, "kft-lbf": 1e3 * FOOT * POUND, "lbf/ft": POUND / FOOT, "kip/ft": 1e3 * POUND / FOOT,
    "deg": np.pi / 180.0, "rpm": np.pi / 30.0, "hp": 550.0 * FOOT * POUND, "deg/100 ft": np.pi / 180.0 / (100.0 * FOOT),
    "psi": POUND / INCH**2, "ksi": 1e3 * POUND / INCH**2, "gal/min": 231.0 * INCH**3 / 60.0,
}  # fmt: skip
SI = {"m": 1.0, "mm": 1e-3, "m/s": 1.0, "m/h": 1.0 / 3600.0, "rad": 1.0, "rad/s": 1.0, "1/m": 1.0, "m^3/s": 1.0} | {
    prefix + unit: size
    for prefix, size in (("", 1.0), ("m", 1e-3), ("k", 1e3), ("M", 1e6))
    for unit in ("N", "N m", "J", "W", "Pa", "N/m")
}
"""What units of labels are worth in SI: those of the oilfield, and those in whose place they are."""


RUNS = {
    "crane": (crane.view.figures.draw, lambda: synthetic_crane.result(synthetic_crane.one_fall())),
    "falls": (crane.view.figures.draw, lambda: synthetic_crane.result(synthetic_crane.falls(4), bounce=0.3)),
    "string": (drillstring.view.figures.draw, lambda: synthetic_string.result(frames=200, turning=True)),
    "drilling": (drillstring.view.figures.draw, lambda: synthetic_string.result(drilling=True)),
    "hose": (gardenhose.view.figures.draw, synthetic_hose.result),
    "cable": (tautline.cable.view.figures.draw, test_cable_figures.result),
}


def in_field(run):
    run.attributes["printed_in"] = "field"
    return run


@functools.cache
def drawn_twice(kind):
    """Axes of each figure in SI beside the same in oilfield units, as (name, axis, axis)."""
    draw, make = RUNS[kind]
    in_si, own = draw([make()]), draw([in_field(make())])
    assert in_si.keys() == own.keys() and own
    return [
        (f"{name}, {which}", getattr(one, which), getattr(other, which))
        for name, figure in own.items()
        for one, other in zip(in_si[name].axes, figure.axes, strict=True)
        for which in ("xaxis", "yaxis")
    ]


def unit_of(axis):
    found = re.search(r"\[([^\[\]]+)\]$", axis.get_label_text())
    return found and found[1]


def numbers_at(axis):
    """Places of the ticks that have numbers, and the numbers."""
    axis.get_figure().canvas.draw()
    low, high = sorted(axis.get_view_interval())
    places = np.array([place for place in axis.get_majorticklocs() if low <= place <= high])
    axis.get_major_formatter().set_locs(places)
    texts = [axis.get_major_formatter()(place, k).replace("\N{MINUS SIGN}", "-") for k, place in enumerate(places)]
    kept = [(place, number(text)) for place, text in zip(places, texts, strict=True) if text]
    return np.array(kept).reshape(-1, 2).T


def number(text):
    power = re.fullmatch(r"\$\\mathdefault\{10\^\{(.*)\}\}\$", text)
    return 10.0 ** float(power[1]) if power else float(text.strip("$").removeprefix(r"\mathdefault{").rstrip("}"))


@pytest.mark.parametrize("kind", RUNS)
def test_the_numbers_of_every_axis_have_the_unit_that_its_label_says(kind):
    looked_at = 0
    for name, plain, axis in drawn_twice(kind):
        unit, own = unit_of(plain), unit_of(axis)
        assert own not in SI, name
        if unit is not None:
            places, numbers = numbers_at(axis)
            factor = 1.0 if own == unit else SI[unit] / FIELD[own]
            assert numbers == pytest.approx(places * factor, rel=1e-6, abs=1e-9), (name, unit, own)
            looked_at += unit != own
    assert looked_at >= 3


@pytest.mark.parametrize("kind", RUNS)
def test_an_axis_without_ticks_such_as_that_across_a_bar_of_colours_gets_none(kind):
    bare = [(name, axis) for name, plain, axis in drawn_twice(kind) if not len(plain.get_majorticklocs())]
    assert [name for name, axis in bare if len(axis.get_majorticklocs())] == []
    assert bare or kind != "hose"
