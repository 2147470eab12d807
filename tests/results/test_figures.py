"""Figures of a drill string come out whole for every kind of result."""

import subprocess
import sys
import warnings

import pytest
from pages import check, leave_out_pixels
from synthetic_string import result

from drillstring.figures import FIGURES, draw, figures
from tautline.results.errors import ResultError
from tautline.view.figure import save, scale


@pytest.mark.parametrize(
    "kind",
    [
        {},
        {"turning": True},
        {"frames": 1},
        {"frames": 2},
        {"bodies": 1},
        {"vertical": True},
        {"frames": 1, "bodies": 1},
    ],
    ids=str,
)
def test_every_figure_is_drawn_without_a_warning(tmp_path, kind):
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        drawn = draw([result(None, **({"frames": 100} | kind))])
        assert drawn.keys() == FIGURES.keys()
        check(drawn, tmp_path, pixels=not kind)


def test_every_axis_says_its_quantity_and_unit():
    for figure in draw([result(None, turning=True)]).values():
        for plot in figure.axes:
            labels = (plot.get_xlabel(), plot.get_ylabel())
            assert any(labels) and all("[" in text for text in labels if text)


def test_torque_is_left_out_where_there_is_none():
    assert len(draw([result(None)], ["overview"])["overview"].axes) == 3
    assert len(draw([result(None, turning=True)], ["overview"])["overview"].axes) == 4


def test_stuck_phases_of_the_bit_are_shaded():
    plot = draw([result(None)], ["overview"])["overview"].axes[0]
    assert "bit stuck" in plot.get_legend_handles_labels()[1]
    assert len(plot.patches) == 5


def test_several_results_are_overlaid_under_their_names_in_one_overview(tmp_path):
    both = [result(tmp_path / "first.nc"), result(tmp_path / "second.nc", lag=0.3)]
    (figure,) = draw(both).values()
    assert figure.axes[0].get_legend_handles_labels()[1] == ["block", "first", "second"]


def test_files_are_named_after_the_result_and_the_figure(tmp_path, monkeypatch):
    leave_out_pixels(monkeypatch)
    one = result(tmp_path / "well.nc", frames=20)
    other = result(tmp_path / "second.nc", frames=20)
    names = [file.name for file in figures([one], tmp_path, (), ("png", "svg"))]
    assert names == [f"well_{name}.{ending}" for name in FIGURES for ending in ("png", "svg")]
    assert [file.name for file in figures([one], tmp_path, ("path",), ("pdf",), "mine")] == ["mine.pdf"]
    names = [file.name for file in figures([one, other, one], tmp_path, ("overview", "path"))]
    assert names[0] == "comparison_overview.png" and len(set(names)) == len(names) == 4


def test_an_unknown_figure_is_refused_with_those_there_are():
    with pytest.raises(ResultError, match=r"no figure 'torque'; known: overview \("):
        draw([result(None, frames=2)], ["torque"])


def test_a_result_without_energies_says_so():
    with pytest.raises(ResultError, match="has no energies"):
        draw([result(None, frames=2, energies=False)], ["energy"])


def test_a_figure_that_cannot_be_written_is_a_named_error(tmp_path):
    figure = draw([result(None, frames=2)], ["path"])["path"]
    with pytest.raises(ResultError, match="cannot be written"):
        save(figure, tmp_path / "missing" / "a.png")
    with pytest.raises(ResultError, match="use png, svg or pdf"):
        save(figure, tmp_path / "a.nonsense")


def test_units_get_a_prefix_that_keeps_labels_short():
    array = result(None, frames=2)["hook_load"]
    assert scale([array], "N") == (1e3, "kN")
    assert scale([array], "m") == (1.0, "m")


def test_drawing_leaves_the_users_own_style_alone():
    code = "import matplotlib; before = dict(matplotlib.rcParams); "
    code += "import crane.figures, drillstring.figures, gardenhose.figures; "
    code += "after = dict(matplotlib.rcParams); assert before == after"
    assert subprocess.run([sys.executable, "-c", code]).returncode == 0
