"""Title lines above the header of a CSV file: the message names the line that was taken, and the one that is meant."""

import pytest

from drillstring.statics.back_calculation import read_measured
from drillstring.well.survey import read_survey
from tautline.scene.errors import SceneError
from tautline.scene.reading.columns import Columns
from tautline.scene.reading.title_lines import header_below

ROWS = "0,0,0\n30,1.5,350\n60,3,10\n"
TITLED = {
    "titles, a date and a blank line": ("Well name: Brage A-12\nDate: 1.2.2024\n\n", "md [m],inc [deg],azi [deg]\n"),
    "a title of as many cells": ("Well,Brage,A-12\n", "md [m],inc [deg],azi [deg]\n"),
    "a title of as many cells, and round brackets": ("Well,Brage,A-12 (b)\n", "md (m),inc (deg),azi (deg)\n"),
    "pairs of names and values": ("Well,Brage\nElevation,32.1,m\n", "md,inc,azi\nm,deg,deg\n"),
    "a title with a comma, and semicolons below": ("Brage, well A-12\n", "md [m];inc [deg];azi [deg]\n"),
}  # fmt: skip


@pytest.mark.parametrize("case", TITLED)
def test_a_survey_below_title_lines_is_refused_with_both_lines_and_reads_once_they_are_remarks(case, tmp_path):
    above, header = TITLED[case]
    rows = ROWS.replace(",", ";") if ";" in header else ROWS
    path = tmp_path / "survey.csv"
    path.write_text(above + header + rows, encoding="utf8")
    line, title = above.count("\n") + 1, header.splitlines()[0]
    with pytest.raises(SceneError) as caught:
        read_survey(path)
    (problem,) = caught.value.problems
    assert (problem.line, problem.value) == (1, above.splitlines()[0])
    assert problem.cause == f"is taken as the header, and line {line} looks like one: {title}"
    assert "begin" in problem.cure and "with #" in problem.cure and "decimal commas" not in str(problem)
    marked = "".join(f"# {one}\n" for one in above.splitlines())
    path.write_text(marked + header + rows, encoding="utf8")
    assert read_survey(path).md.tolist() == [0.0, 30.0, 60.0]


def test_tables_and_measured_loads_below_a_title_are_told_so_too(tmp_path):
    path = tmp_path / "loads.csv"
    path.write_text(
        "Loads of run 7\ndepth [m],pick_up [kN],slack_off [kN]\n100,200,150\n200,300,220\n", encoding="utf8"
    )
    for reads in (read_measured, Columns):
        with pytest.raises(SceneError, match="is taken as the header, and line 2 looks like one"):
            reads(path)


@pytest.mark.parametrize(
    "text",
    [
        "md,inc,azi\nm,deg,deg\n0,0,0\n",  # a row of units
        "md,inc,azi\n[ftKB],[dega],[dega]\n0,0,0\n",
        "md,inc\n0,0,0\n30,1,350\n",  # a header too short
        "md,inc\n0,0,0\nstand,pipe,joint\n30,1,350\n",  # words below numbers
        "md,inc,azi\n0,0,0\n",
        "a title\n0,0,0\n30,1,350\n",
        "depthx,tilt,az\ntie-in,surface,none\n0,0,0\n",  # a remark below the header
        "depthx (m),tilt (deg),az (deg)\ntie-in (gyro),surface (m),none\n0,0,0\n",
    ],
)
def test_what_is_no_header_below_titles_is_not_taken_for_one(text):
    assert header_below(list(enumerate(text.splitlines(), 1))) is None


def test_a_remark_below_a_header_without_the_columns_is_not_taken_for_the_header(tmp_path):
    """Who is told to delete the line above it would delete the header."""
    path = tmp_path / "survey.csv"
    path.write_text("depthx,tilt,az\ntie-in,surface,none\n" + ROWS, encoding="utf8")
    with pytest.raises(SceneError, match="no such column in the header") as caught:
        read_survey(path)
    (problem,) = caught.value.problems
    assert problem.value == "depthx | tilt | az" and "delete" not in problem.cure
