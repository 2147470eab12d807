"""Figures of a drill string come out whole for every kind of result."""

import json
import resource
import subprocess
import sys
import warnings

import numpy as np
import pytest
from figures.pages import check, leave_out_pixels
from figures.synthetic_hose import result as hose
from figures.synthetic_string import result
from of_the_suite import studies

from drillstring.view.figures import FIGURES, draw, figures
from tautline.results.errors import ResultError, WriteError
from tautline.view.figures.figure import LONGEST_NAME, axes, flatten_rounding, label, save, scale, shortened
from tautline.view.figures.spectrum import full_spectra

BIT = ("drilling", "phase")
"""Figures of a bit on the bottom."""


EACH = tuple(FIGURES)
KINDS = [
    ({}, EACH),
    ({"turning": True, "frames": 200}, ("overview", "forces", "orbit", "whirl")),
    ({"frames": 1}, EACH),
    ({"vertical": True}, ("path",)),
    ({"drilling": True}, BIT),
]
"""Kinds of results, and which figures differ in them from those of the first: they are laid out."""
MORE_KINDS = [(kind, tuple(name for name in EACH if name not in names)) for kind, names in KINDS if names is not EACH]
MORE_KINDS += [({"turning": True}, EACH), ({"frames": 2}, EACH), ({"bodies": 1}, EACH)]
MORE_KINDS += [({"frames": 1, "bodies": 1}, EACH), ({"drilling": True, "frames": 1}, EACH)]


@pytest.mark.parametrize(
    ("kind", "other"), [*KINDS, *studies(*MORE_KINDS)], ids=[str(k) for k, _ in KINDS + MORE_KINDS]
)
def test_every_figure_is_drawn_without_a_warning(tmp_path, kind, other):
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        drawn = draw([result(None, **({"frames": 100} | kind))])
        absent = {"waterfall", "loop", "orbit", "phase"} if kind.get("frames") == 1 else set()
        absent |= set() if "drilling" in kind else set(BIT)
        # Lumps go around in 8 s: in 100 frames, of 5 s, none does.
        absent |= set() if kind.get("turning") and kind.get("frames") == 200 else {"whirl"}
        assert drawn.keys() == FIGURES.keys() - absent
        for name in (name for name in other if name in drawn):
            # Lines, shades, an image and circles: the others have no more than these.
            pixels = name in (("overview", "waterfall", "orbit") if not kind else ("whirl", *BIT))
            check({name: drawn[name]}, tmp_path, pixels)


@pytest.mark.parametrize(
    ("name", "why"),
    [
        ("waterfall", "one frame"),
        ("loop", "block that rests"),
        ("orbit", "no motion across the hole"),
        ("whirl", "no history of motion"),
    ],
)
def test_a_figure_that_a_result_has_nothing_for_says_why(name, why):
    with pytest.raises(ResultError, match=why):
        draw([result(None, frames=1)], [name])


def test_every_axis_says_its_quantity_and_unit():
    for figure in draw([result(None, turning=True, drilling=True)]).values():
        for plot in figure.axes:
            labels = (plot.get_xlabel(), plot.get_ylabel())
            assert any(labels) and all("[" in text for text in labels if text)


def test_torque_is_left_out_where_there_is_none():
    assert len(draw([result(None)], ["overview"])["overview"].axes) == 3
    assert len(draw([result(None, turning=True)], ["overview"])["overview"].axes) == 4


def test_where_the_bit_rests_along_the_hole_is_shaded():
    plot = draw([result(None)], ["overview"])["overview"].axes[0]
    assert "bit at rest along the hole" in plot.get_legend_handles_labels()[1]
    assert len(plot.patches) == 5


def test_two_figures_of_one_run_call_a_bit_that_does_not_move_along_the_hole_and_one_that_does_not_turn_by_two_names():
    drawn = draw([result(None, drilling=True)], ["overview", "drilling"])
    words = [set(figure.axes[0].get_legend_handles_labels()[1]) for figure in drawn.values()]
    assert words == [{"block", "bit", "bit at rest along the hole"}, {"drive", "bit", "bit stuck"}]


def test_a_drilling_bit_is_drawn_beside_its_drive_and_shaded_where_it_stands():
    figure = draw([result(None, drilling=True)], ["drilling"])["drilling"]
    speed, *_, rate = figure.axes
    assert set(speed.get_legend_handles_labels()[1]) == {"drive", "bit", "bit stuck"}
    assert len(speed.patches) == 8, "once in five seconds of forty"
    assert rate.lines[0].get_ydata().max() == pytest.approx(3600.0 * 5e-4 * 32.0, rel=1e-2)
    both = draw([result(None, drilling=True), result(None, drilling=True, frames=200)], ["phase"])["phase"]
    assert all("severity" in text for text in both.axes[0].get_legend_handles_labels()[1] if text != "end")


def test_several_results_are_overlaid_under_their_names_in_one_overview(tmp_path):
    both = [result(tmp_path / "first.nc"), result(tmp_path / "second.nc", lag=0.3)]
    (figure,) = draw(both).values()
    assert figure.axes[0].get_legend_handles_labels()[1] == ["block", "first", "second"]


def test_files_are_named_after_the_result_and_the_figure(tmp_path, monkeypatch):
    leave_out_pixels(monkeypatch)
    one = result(tmp_path / "well.nc", frames=20)
    other = result(tmp_path / "second.nc", frames=20)
    names = [file.name for file in figures([one], tmp_path, (), ("png", "svg"))]
    drawn = [name for name in FIGURES if name not in {*BIT, "whirl"}]
    assert names == [f"well_{name}.{ending}" for name in drawn for ending in ("png", "svg")]
    assert [file.name for file in figures([one], tmp_path, ("path",), ("pdf",), "mine")] == ["mine.pdf"]
    assert figures([one], tmp_path, ("waterfall:torque",))[0].name == "well_waterfall_torque.png"
    assert (
        figures([one], tmp_path, ("hook_load",), vs="block_position")[0].name == "well_hook_load_vs_block_position.png"
    )
    names = [file.name for file in figures([one, other, one], tmp_path, ("overview", "path"))]
    assert names[0] == "comparison_overview.png" and len(set(names)) == len(names) == 4


def test_an_unknown_figure_is_refused_with_those_there_are():
    with pytest.raises(
        ResultError, match=r"no figure or variable 'overvew'; did you mean 'overview'\? known: overview \("
    ):
        draw([result(None, frames=2)], ["overvew"])


def test_a_result_without_energies_says_so():
    with pytest.raises(ResultError, match="has no energies"):
        draw([result(None, frames=2, energies=False)], ["energy"])


def test_a_figure_that_cannot_be_written_is_a_named_error(tmp_path):
    figure = draw([result(None, frames=2)], ["path"])["path"]
    with pytest.raises(ResultError, match="cannot be written"):
        save(figure, tmp_path / "missing" / "a.png")
    with pytest.raises(ResultError, match="use png, svg or pdf"):
        save(figure, tmp_path / "a.nonsense")


def test_a_waterfall_is_the_tension_over_time_and_depth_with_its_corners_in_place():
    run = result(None, frames=100)
    plot, bar = draw([run], ["waterfall"])["waterfall"].axes
    (image,) = plot.images
    tension = run["tension"] / 1e3
    np.testing.assert_allclose(image.get_array(), tension.T)
    left, right = plot.get_xlim()
    low, high = plot.get_ylim()
    assert (left, right) == (run.time[0], run.time[-1]) and high == 0.0
    assert low == pytest.approx(run["measured_depth"][:, -1].mean())
    assert bar.get_ylabel() == "tension [kN]" and plot.get_ylabel() == "measured depth [m]"
    assert image.get_clim() == (pytest.approx(tension.min()), pytest.approx(tension.max()))
    # A reader who looks for a depth and a time finds the cell of the element that is there.
    edges = np.r_[0.0, run["measured_depth"].mean(axis=0)]
    np.testing.assert_allclose(image._Ay, edges)


def test_colours_of_a_waterfall_are_white_at_zero_where_both_signs_are_there():
    run = result(None, frames=100)
    image = draw([run], ["waterfall"])["waterfall"].axes[0].images[0]
    assert image.get_clim()[0] < 0.0 < image.get_clim()[1]
    white = np.array(image.cmap(image.norm(0.0)))[:3]
    assert white.min() > 0.93 and np.ptp(white) < 0.03
    force = draw([run], ["waterfall:contact_force"])["waterfall_contact_force"].axes[0].images[0]
    assert force.get_clim()[0] == 0.0 and np.array(force.cmap(0.0))[:3].max() < 0.4


def test_a_blow_of_one_frame_does_not_darken_a_waterfall():
    run = result(None, frames=400)
    run._contents[1]["contact_force"][17, -1] = 5e6
    figure = draw([run], ["waterfall:contact_force"])["waterfall_contact_force"]
    assert figure.axes[0].images[0].get_clim()[1] < 60.0
    assert figure.axes[1].get_ylabel() == "contact force, at most 5 MN [kN]"


def test_what_does_not_run_down_the_string_has_no_waterfall():
    with pytest.raises(ResultError, match="does not run down the string"):
        draw([result(None, frames=5)], ["waterfall:hook_load"])


def test_orbits_are_those_of_the_lumps_that_move_most_inside_the_clearance_of_the_hole():
    run = result(None, frames=200)
    plots = draw([run], ["orbit"])["orbit"].axes
    assert [plot.get_title() or plot.get_title(loc="left") for plot in plots] == [
        f"lump {k}, {run['measured_depth'][:, k].mean():.0f} m" for k in (8, 9, 10, 11)
    ] + [f"bit, {run['measured_depth'][:, 12].mean():.0f} m"]
    wall, way, *_ = plots[0].get_lines()
    np.testing.assert_allclose(np.hypot(*wall.get_data()), 25.0)  # half of 200 mm less 150 mm
    np.testing.assert_allclose(way.get_xdata(), 1e3 * run["lateral_displacement"][:, 8, 1])
    np.testing.assert_allclose(way.get_ydata(), 1e3 * run["lateral_displacement"][:, 8, 0])
    assert plots[0].get_aspect() == 1.0


def test_orbits_of_lumps_that_are_named_tell_how_they_whirl():
    # A turn of the pipe takes 5.3 s; a fifth of the run is 6 s, and the short one lasts for less than a turn.
    run, short = (result(None, frames=frames, turning=True) for frames in (600, 90))
    plots = draw([run], ["orbit:3,bit"])["orbit_3_bit"].axes
    assert [plot.get_title(loc="left").split(", ")[::2] for plot in plots] == [
        ["lump 3", "whirl ratio +0.67"],
        ["bit", "whirl ratio +0.67"],
    ]
    with pytest.raises(ResultError, match=r"there is no lump '99'.*from 0 to 12, or bit"):
        draw([run], ["orbit:99"])
    (plot,) = draw([short], ["orbit:3"])["orbit_3"].axes
    assert plot.get_title(loc="left").startswith("lump 3, ") and "ratio" not in plot.get_title(loc="left")


def test_the_bar_of_spectra_says_what_is_white():
    plots = draw([result(None, frames=800, turning=True)], ["whirl"])["whirl"].axes
    assert "amplitude; white: below\n0.004 of the largest [mm]" in [plot.get_ylabel() for plot in plots]


def test_a_long_name_keeps_its_front_and_more_of_its_end():
    name = "main hoisting winch of the starboard pedestal crane no. 2"
    assert shortened(name) == "main hoisting…board pedestal crane no. 2" and len(shortened(name)) == LONGEST_NAME
    assert shortened(name[:LONGEST_NAME]) == name[:LONGEST_NAME]


def test_whirl_of_a_lump_that_does_not_go_around_is_drawn_where_it_is_named():
    run = result(None, turning=True, frames=100)
    with pytest.raises(ResultError, match="does not go around the hole") as refused:
        draw([run], ["whirl"])
    assert "whirl:12" in refused.value.cure
    assert draw([run], ["whirl:12"])["whirl_12"].axes


def test_the_figure_of_whirl_shows_rate_offset_and_spectra_of_the_lump_that_moves_most():
    run = result(None, frames=800, turning=True)
    plots = draw([run], ["whirl"])["whirl"].axes
    orbit, rate, offset, spectra = plots[0], plots[1], plots[2], plots[3]
    np.testing.assert_allclose(rate.get_lines()[0].get_ydata(), 1.0 / 8.0, rtol=1e-3)
    np.testing.assert_allclose(rate.get_lines()[1].get_ydata(), 1.5 / 8.0)
    assert "+0.67" in rate.get_title(loc="left")
    np.testing.assert_allclose(offset.get_lines()[0].get_ydata(), 20.0, rtol=1e-6)
    low, high = spectra.get_ylim()
    assert low == -high and orbit.get_aspect() == 1.0
    other = draw([run], ["whirl:6"])["whirl_6"].axes
    assert other[2].get_lines()[0].get_ydata().max() < 20.0


def test_a_circle_shows_in_full_spectra_with_its_radius_on_the_side_to_which_it_goes_around():
    time = 0.01 * np.arange(2000)
    for turn in (3.0, -3.0):
        middle, frequency, amplitude = full_spectra(time, 0.02 * np.exp(2j * np.pi * turn * time))
        assert time[0] < middle[0] < middle[-1] < time[-1]
        place = amplitude.argmax(axis=0)
        np.testing.assert_allclose(frequency[place], turn, atol=0.5 * (frequency[1] - frequency[0]))
        np.testing.assert_allclose(amplitude.max(axis=0), 0.02, rtol=0.05)
    assert full_spectra(time[:20], np.ones(20))[0].size == 0


def test_an_orbit_has_no_circle_where_the_result_knows_no_hole():
    run = result(None, frames=50)
    del run._contents[2]["clearance"]
    run.__dict__.pop("variables", None)
    assert "wall" not in draw([run], ["orbit"])["orbit"].axes[0].get_legend_handles_labels()[1]


def test_bit_and_hook_load_go_around_over_the_block():
    run = result(None, frames=300)
    bit, load = draw([run], ["loop"])["loop"].axes
    block = run["block_position"] - run["block_position"][0]
    curve = bit.get_lines()[0]
    np.testing.assert_allclose(curve.get_xdata(), block)
    np.testing.assert_allclose(curve.get_ydata(), run["measured_depth"][:, -1] - run["measured_depth"][0, -1])
    np.testing.assert_allclose(load.get_lines()[0].get_ydata(), run["hook_load"] / 1e3)


@pytest.mark.parametrize("name", ["forces", "loop", "energy"])
def test_figures_of_several_results_have_a_line_of_each(tmp_path, name):
    runs = [result(tmp_path / f"{k}.nc", frames=frames, lag=k) for k, frames in enumerate((60, 90, 1), 1)][
        : 3 - (name == "loop")
    ]
    figure = draw(runs, [name])[name]
    texts = [text for plot in figure.axes for text in plot.get_legend_handles_labels()[1]]
    texts += [text.get_text() for plot in figure.axes if plot.get_legend() for text in plot.get_legend().get_texts()]
    assert all(any(text.startswith(run.path.stem) for text in texts) for run in runs)


def test_results_of_several_applications_are_refused_together():
    with pytest.raises(ResultError, match=r"is a result of gardenhose, and .* one of drillstring"):
        draw([result(None, frames=5), hose(frames=5)])


def test_units_get_a_prefix_that_keeps_labels_short():
    array = result(None, frames=2)["hook_load"]
    assert scale([array], "N") == (1e3, "kN")
    assert scale([array], "m") == (1.0, "m")
    assert scale([1e-9 * array], "N") == (1e-3, "mN") and scale([1e-6 * array], "J") == (1.0, "J")
    assert scale([0.0 * array], "N") == (1.0, "N")


@pytest.mark.parametrize("unit", ["kft-lbf", "N m", "lbf-s/ft"])
def test_a_unit_stands_in_one_line_of_a_label_wherever_the_line_must_break(unit):
    for letters in range(12, 40):
        lines = label("torque percentiles", unit, letters).split("\n")
        assert sum(f"[{unit}]" in line for line in lines) == 1 and max(map(len, lines)) <= letters
        assert " ".join(lines) == f"torque percentiles [{unit}]"


def test_a_label_breaks_at_commas_so_that_names_and_their_units_stay_together():
    assert label("tension, winch to boom tip", "kN", 30) == "tension,\nwinch to boom tip [kN]"
    assert label("velocity along the hole, body 3", "m/s", 30) == "velocity along the hole,\nbody 3 [m/s]"
    assert label("position of a body, x", "m", 30) == "position of a body, x [m]"
    assert label("a first of many words, b, c", "m", 12) == "a first of\nmany words,\nb, c [m]"


@pytest.mark.parametrize(
    ("values", "limits"),
    [
        ([np.nan, np.nan], None),
        ([], None),
        ([np.nan, 5.0, 5.0 + 1e-9], (4.95, 5.05)),
        ([np.inf, -np.inf, 1.0], (0.99, 1.01)),
    ],
)
def test_an_axis_is_kept_from_blowing_up_rounding_and_left_alone_without_a_number(values, limits):
    _, plots = axes()
    before = plots[0, 0].get_ylim()
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        flatten_rounding(plots[0, 0], np.array(values))
    assert plots[0, 0].get_ylim() == pytest.approx(limits or before)


ANEW = """
import json, sys
import matplotlib
before = dict(matplotlib.rcParams)
import crane.view.figures, drillstring.view.figures, gardenhose.view.figures
after = dict(matplotlib.rcParams)
from tautline.view.figures.figure import axes
figure, _ = axes(title="x")
data = figure._repr_png_()
png = data.startswith(b"\\x89PNG\\r\\n\\x1a\\n") and len(data) > 2000
found = {"style": before == after == dict(matplotlib.rcParams), "png": png}
print(json.dumps(found | {"pyplot": "matplotlib.pyplot" in sys.modules}))
"""


@pytest.fixture(scope="module")
def anew():
    """What a new process finds, in which nothing was drawn before: its start takes longer than all else."""
    done = subprocess.run([sys.executable, "-c", ANEW], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    return json.loads(done.stdout)


def test_a_figure_shows_itself_in_a_notebook_without_pyplot(anew):
    assert anew["png"] and not anew["pyplot"]


def test_drawing_leaves_the_users_own_style_alone(anew):
    assert anew["style"]


@pytest.mark.parametrize("bodies", [12, 200])
def test_what_is_on_the_wall_is_told_from_what_is_off_it_and_stands_before_it(bodies):
    section = draw([result(None, frames=3, bodies=bodies)], ["path"])["path"].axes[0]
    dots = {line.get_label().split()[-3]: line for line in section.get_lines() if line.get_marker() == "o"}
    on, off = dots["on"], dots["off"]
    assert on.get_markeredgecolor() != off.get_markeredgecolor() and on.get_zorder() > off.get_zorder()
    assert (on.get_markersize() < 5) == (bodies == 200)


def test_a_figure_on_a_full_disk_is_a_failed_writing_as_a_table_is_and_leaves_the_earlier_one(tmp_path):
    """A limit on the size of files stands in for the disk."""
    earlier = "<svg>earlier</svg>"
    (tmp_path / "a.svg").write_text(earlier)
    figure, _ = axes(1, 1, 3.0, 3.0, "full")
    limit = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (1000, limit[1]))
    try:
        with pytest.raises(WriteError, match="cannot be written: File too large; name another with -o, or make room"):
            save(figure, tmp_path / "a.svg")
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, limit)
    assert [(file.name, file.read_text()) for file in tmp_path.iterdir()] == [("a.svg", earlier)]


def test_a_figure_in_a_folder_that_is_not_there_is_bad_input(tmp_path):
    figure, _ = axes(1, 1, 3.0, 3.0, "nowhere")
    with pytest.raises(ResultError, match="cannot be written") as refused:
        save(figure, tmp_path / "none" / "a.svg")
    assert not isinstance(refused.value, WriteError)
