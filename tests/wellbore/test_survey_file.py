"""Survey files: what is read, and what is refused by its line."""

import math
import re

import numpy as np
import pytest

from drillstring.model.prepared import prepared
from drillstring.scene.scene import read
from drillstring.well.survey import LARGEST_FILE, read_survey
from tautline.scene.errors import SceneError

DEG = math.pi / 180.0
MD, INC, AZI = [0.0, 30.0, 60.0], np.array([0.0, 1.5, 3.0]) * DEG, np.array([0.0, 350.0, 10.0]) * DEG
ROWS = ["0,0,0", "30,1.5,350", "60,3,10"]
OTHER_UNITS = [f"{m / 0.3048},{i / DEG / 0.9},{a}" for m, i, a in zip(MD, INC, AZI, strict=True)]
HEAD = "md [m],inc [deg],azi [deg]"
BOM = b"\xef\xbb\xbf"


def write(folder, text, name="survey.csv"):
    path = folder / name
    path.write_bytes(text if isinstance(text, bytes) else text.encode())
    return path


def lines(*text):
    return "\n".join(text) + "\n"


GOOD = {
    "units in square brackets": lines("md [m],inc [deg],azi [deg]", *ROWS),
    "units in round brackets": lines("MD (m),Incl. (deg),Azim (°)", *ROWS),
    "units after an underscore": lines("md_m,inc_deg,azi_deg", *ROWS),
    "units in camel case": lines("MD [m],IncDeg,AziDeg", *ROWS),
    "long names": lines("Measured Depth [m], Inclination [deg], Azimuth [deg]", *ROWS),
    "a quoted header with a comma": lines('"Depth, m","inc, deg","azi, deg"', *ROWS),
    "a second row of units": lines("md,inc,azi", "[m],deg,deg", *ROWS),
    "semicolons": lines("md [m];inc [deg];azi [deg]", *(row.replace(",", ";") for row in ROWS)),
    "semicolons and decimal commas": lines("md [m];inc [deg];azi [deg]", "0;0,0;0", "30,0;1,5;350", "60;3;1,0e1"),
    "tabs": lines("md [m]\tinc [deg]\tazi [deg]", *(row.replace(",", "\t") for row in ROWS)),
    "comments and blank lines": lines("# a well", "", "md [m],inc [deg],azi [deg]", "  # top", *ROWS, ",,", ""),
    "further columns": lines("name,azi [deg],tvd [m],inc [deg],md [m]", "a,0,0,0,0", "b,350,x,1.5,30", "c,10,,3,60"),
    "carriage returns and a byte order mark": BOM + lines(HEAD, *ROWS).replace("\n", "\r\n").encode(),
    "a degree sign in Windows-1252": lines("md [m],inc [°],azi [°]", *ROWS).encode("cp1252"),
    "UTF-16": lines(HEAD, *ROWS).encode("utf-16"),
    "other units": lines("md [ft],inc [gon],azi [rad]", *OTHER_UNITS),
    "headers as software exports them": lines("MD (m),Inc (deg),Azi (deg),TVD (ft)", *(r + ",1" for r in ROWS)),
    "an azimuth from grid north": lines("MD (m),Incl (°),Azi Grid (°)", *ROWS),
    "an azimuth from true north": lines("MD (m),Incl (dega),AziTrue (dega)", *ROWS),
    "azimuth's other name": lines("MD (mKB),Incl (°),Azm (TN) (°)", *ROWS),
    "azimuths a turn off": lines("md [m],inc [deg],azi [deg]", "0,0,720", "30,1.5,-10", "60,3,370"),
}  # fmt: skip


@pytest.mark.parametrize("case", GOOD)
def test_a_survey_is_read_with(case, tmp_path):
    survey = read_survey(write(tmp_path, GOOD[case]))
    assert np.allclose(survey.md, MD, atol=1e-12) and np.allclose(survey.inc, INC, atol=1e-15)
    assert np.allclose(np.exp(1j * survey.azi), np.exp(1j * AZI), atol=1e-12)
    assert np.all((survey.azi >= 0.0) & (survey.azi < 2 * math.pi))


@pytest.mark.parametrize(
    ("unit", "foot"), [("ft", 0.3048), ("ftKB", 0.3048), ("usft", 1200 / 3937), ("US ft", 1200 / 3937)]
)
def test_feet_are_read_as_the_header_names_them_and_a_depth_column_in_other_units_is_passed_over(unit, foot, tmp_path):
    text = lines(f"MD ({unit}),Inc (deg),Azi (deg),TVD (m)", "0,0,0,0", "1000,2,3,304.5", "2000,4,3,608")
    survey = read_survey(write(tmp_path, text))
    assert np.allclose(survey.md, [0.0, 1000.0 * foot, 2000.0 * foot], rtol=1e-15)


@pytest.mark.parametrize(
    ("head", "units", "words"),
    [
        (
            "MD (ft),Inc,Azi (deg)",
            {},
            "one another; write inc [deg] in the header",
        ),
        (
            "MD (kip),Inc (deg),Azi (deg)",
            {},
            "1: md: 'kip' is not a unit like m; write the unit that the numbers are in",
        ),
        (
            "MD (ft),Inc (deg),Azi (deg)",
            {"md": "m"},
            "1: md: two units: the header says ft, and the scene says m",
        ),
        ("MD (ft),Inc (deg),Azi Grid (deg),Azi True (deg)", {}, "the header has two such columns"),
    ],
)
def test_missing_and_contradicting_units_are_refused_by_column(head, units, words, tmp_path):
    path = write(tmp_path, lines(head, *(row + ",0" * (head.count(",") - 2) for row in ROWS)))
    with pytest.raises(SceneError) as caught:
        read_survey(path, units=units)
    assert words in str(caught.value)


def test_units_may_come_from_the_scene(tmp_path):
    path = write(tmp_path, lines("md,inc,azi", "0,0,0", "100,2,3"))
    survey = read_survey(path, units={"md": "ft", "inc": "deg", "azi": "deg"})
    assert survey.md[1] == 30.48 and survey.inc[1] == 2 * DEG
    assert list(survey.lines) == [2, 3]


# case: (text, line or None, key, words of the message)
BROKEN = {
    "unsorted depths": (lines(HEAD, "0,0,0", "60,1,0", "30,1,0", "90,1,0"), 4, "md", "above the station of line 3"),
    "one depth twice": (lines(HEAD, "0,0,0", "30,1,0", "30,2,0"), 4, "md", "same depth as line 3"),
    "one row twice": (lines(HEAD, "0,0,0", "30,1,0", "30,1,0", "60,1,0"), 4, "md", "keep one of lines 3 and 4"),
    "a row far back again": (lines(HEAD, "0,0,0", "30,1,0", "60,1,0", "30,1,0"), 5, "md", "same row as line 3"),
    "letters": (lines(HEAD, "0,0,0", "30,one,0", "60,1,0"), 3, "inc", "inc = one: is not a number"),
    "NaN": (lines(HEAD, "0,0,0", "30,NaN,0", "60,1,0"), 3, "inc", "not a finite number"),
    "infinity": (lines(HEAD, "0,0,0", "30,1,-inf", "60,1,0"), 3, "azi", "not a finite number"),
    "a number too large": (lines(HEAD, "0,0,0", "1e999,1,0"), 3, "md", "not a finite number"),
    "Python's own numbers": (lines(HEAD, "0,0,0", "1_000,1,0"), 3, "md", "not a number"),
    "a missing cell": (lines(HEAD, "0,0,0", "30,,0", "60,1,0"), 3, "inc", "the cell is empty"),
    "a short row": (lines(HEAD, "0,0,0", "30,1", "60,1,0"), 3, "azi", "where the hole is vertical"),
    "a long row": (lines(HEAD, "0,0,0", "30,5,1,5,0", "60,1,0"), 3, "row", "semicolons"),
    "inclination above 180 deg": (lines(HEAD, "0,0,0", "30,181,0"), 3, "inc", "outside 0 to 180 deg"),
    "negative inclination": (lines(HEAD, "0,0,0", "30,-1,0"), 3, "inc", "outside 0 to 180 deg"),
    "azimuth above 720 deg": (lines(HEAD, "0,0,0", "30,1,721"), 3, "azi", "outside -360 to 720 deg"),
    "azimuth below -360 deg": (lines(HEAD, "0,0,0", "30,1,-361"), 3, "azi", "outside -360 to 720 deg"),
    "negative depth": (lines(HEAD, "-5,0,0", "30,1,0"), 2, "md", "negative"),
    "a gap": (lines(HEAD, "0,0,0", "30,1,0", "630,2,0"), 4, "md", "raise max_gap"),
    "a gap above the first station": (lines(HEAD, "900,2,0", "930,2,0"), 2, "md", "no station in the 900 m above"),
    "an absurd dogleg": (lines(HEAD, "0,0,0", "30,1,0", "30.2,9,0"), 4, "inc, azi", "8 deg in 0.2 m below line 3"),
    "a hole that turns back": (lines(HEAD, "0,90,0", "400,90,180"), 3, "inc, azi", "its plane is not known"),
    "one station": (lines(HEAD, "0,0,0"), None, "", "two stations at least"),
    "no stations": (lines(HEAD), 1, "", "a header and no rows"),
    "an empty file": ("", None, "", "is empty"),
    "blank lines only": ("\n\n  \n", None, "", "is empty"),
    "comments only": ("# md,inc,azi\n# 0,0,0\n", None, "", "only comments"),
    "a picture": (b"\x89PNG\r\n\x1a\n\0\0\0\rIHDR", 1, "", "binary"),
    "no header": (lines(*ROWS), 1, "", "numbers where the names should be"),
    "a column missing": (lines("md [m],inc [deg]", "0,0", "30,1"), 1, "azi", "no such column"),
    "a column twice": (lines("md [m],depth [m],inc [deg],azi [deg]", "0,0,0,0"), 1, "md", "two such columns"),
    "no unit": (lines("md [m],inc,azi [deg]", *ROWS), 1, "inc", "write inc [deg] in the header"),
    "a unit that is none": (lines("md [span],inc [deg],azi [deg]", *ROWS), 1, "md", "unknown unit 'span'"),
    "a unit of the wrong kind": (lines("md [deg],inc [deg],azi [deg]", *ROWS), 1, "md", "'deg' is not a unit like m"),
    "header and units row at odds": (lines(HEAD, "ft,deg,deg", *ROWS), 1, "md", "two units"),
    "an open quote": (lines(HEAD, "0,0,0", '"30,1,0', "60,1,0"), 3, "md", "not a number"),
    "a thousands' mark": (lines(HEAD.replace(",", ";"), "0;0;0", "1.030,5;1;0"), 3, "md", "thousands' marks"),
}


@pytest.mark.parametrize("case", BROKEN)
def test_a_survey_is_refused_at_its_line_with_a_cure_for(case, tmp_path):
    text, line, key, says = BROKEN[case]
    path = write(tmp_path, text)
    with pytest.raises(SceneError) as caught:
        read_survey(path)
    first = caught.value.problems[0]
    assert (first.file, first.line, first.key) == (str(path), line, key)
    assert says in str(first) and first.cure


@pytest.mark.parametrize("head", ["md,inc [deg],azi [deg]", "md [m],inc,azi", "md,inc,azi"])
def test_the_cure_of_a_survey_without_units_is_taken_by_the_scene(head, tmp_path):
    given, right = write(tmp_path, lines(head, *ROWS)), tmp_path / "right.csv"
    right.write_text(lines(HEAD, *ROWS), encoding="utf8")
    scene = "well: {survey: SURVEY, diameter: 8.5 in, wall: none}\n"
    scene += "string: [{name: pipe, length: rest, od: 5 in, id: 4.276 in}]\n"
    scene += "material: {youngs_modulus: 200 GPa, shear_modulus: 79 GPa, density: 7850}\n"
    scene += "model: {kind: lumped, elements: 4}\nsolver: {step: 5 ms, end: 50 ms}\noutput: {interval: 50 ms}\n"
    path = tmp_path / "scene.yaml"
    path.write_text(scene.replace("SURVEY", given.name), encoding="utf8")
    with pytest.raises(SceneError) as caught:
        prepared(read(path))
    cures = {re.search("`survey: (.*)` in the scene", problem.cure)[1] for problem in caught.value.problems}
    assert len(cures) == 1, "all units that lack stand in one cure"
    path.write_text(scene.replace("SURVEY", cures.pop()), encoding="utf8")
    found = prepared(read(path)).well.position(np.array([50.0]))
    path.write_text(scene.replace("SURVEY", right.name), encoding="utf8")
    assert np.array_equal(found, prepared(read(path)).well.position(np.array([50.0])))


@pytest.mark.parametrize("mark", [",", "."])
def test_depths_with_marks_of_thousands_are_asked_about_where_they_fall_or_the_hole_turns_too_sharply(mark, tmp_path):
    """Whole feet, sorted, on a gentle build: with the marks out the survey is read."""
    falls = ["0;0;0", "500;0;0", "900;9;10", f"1{mark}000;9;10", f"1{mark}100;9;10"]
    turns = ["0;0;0", f"1{mark}640;0;350", f"2{mark}625;20;350", f"3{mark}609;40;10"]
    name = {",": "comma", ".": "point"}[mark]
    for rows, meant in ((falls, {5: "1000", 6: "1100"}), (turns, {4: "2625", 5: "3609"})):
        text = lines("md [ft];inc [deg];azi [deg]", *rows)
        with pytest.raises(SceneError) as caught:
            read_survey(write(tmp_path, text))
        for problem in caught.value.problems:
            assert problem.key == "md"
            assert problem.cure.endswith(
                f"or is the {name} a mark of thousands? Then write {meant[problem.line]} without it"
            )
        assert {problem.line for problem in caught.value.problems} == set(meant)
        right = read_survey(write(tmp_path, text.replace(mark, "")))
        assert right.md[-1] == pytest.approx(0.3048 * float(list(meant.values())[-1]))


@pytest.mark.parametrize("depth", ["10,25", "0,500"])
def test_depths_with_decimal_commas_are_not_asked_about_thousands_where_the_hole_turns_too_sharply(depth, tmp_path):
    text = lines("md [m];inc [deg];azi [deg]", "0;0;0", f"{depth};0;0", "11,125;50;0")
    with pytest.raises(SceneError) as caught:
        read_survey(write(tmp_path, text), max_dogleg_severity=math.radians(1.0))
    (problem,) = caught.value.problems
    assert problem.key == "inc, azi" and "thousands" not in str(problem) and "depths" in problem.cure


@pytest.mark.parametrize(
    "rows",
    [
        ["0;0;0", "98.425;0;0", "100.125;45;0", "400.000;45;0"],  # 1700 ft is a page of the survey
        ["0;0;0", "98.425;1;0", "196.850;2;0", "197.350;45;0"],  # 500 ft may be, and 98 425 ft are no interval
    ],
)
def test_depths_of_three_decimals_are_not_asked_about_thousands_that_would_leave_no_stations(rows, tmp_path):
    """The inclination is wrong, and it is named."""
    with pytest.raises(SceneError) as caught:
        read_survey(write(tmp_path, lines("md [ft];inc [deg];azi [deg]", *rows)))
    (problem,) = caught.value.problems
    assert problem.key == "inc, azi" and "45 deg" in problem.value and "thousands" not in problem.cure


def test_every_bad_row_is_named_in_the_order_of_the_file(tmp_path):
    rows = ["0,0,0", "x,0,0", "30,200,0", "60,1,", "60,1,0", "20,1,0", "90,1,0"]
    with pytest.raises(SceneError) as caught:
        read_survey(write(tmp_path, lines(HEAD, *rows)))
    assert [(p.line, p.key) for p in caught.value.problems] == [(3, "md"), (4, "inc"), (5, "azi"), (7, "md")]


def test_a_contradiction_between_scene_and_header_is_refused(tmp_path):
    path = write(tmp_path, lines(HEAD, *ROWS))
    with pytest.raises(SceneError, match="the header says m, and the scene says ft"):
        read_survey(path, units={"md": "ft"})
    assert len(read_survey(path, units={"md": "metres", "inc": "°"}).md) == 3  # the same unit by another name


def test_units_of_an_unknown_column_are_refused(tmp_path):
    with pytest.raises(SceneError, match="tvd"):
        read_survey(write(tmp_path, lines(HEAD, *ROWS)), units={"tvd": "m"})


@pytest.mark.parametrize("rows", [("0,60,30", "600,60,30"), ("900,0,0", "930,1,0"), ("0,60,359.99", "600,60,0.01")])
def test_a_long_interval_in_which_the_hole_does_not_turn_is_no_gap(tmp_path, rows):
    assert len(read_survey(write(tmp_path, lines(HEAD, *rows))).md) == 2


def test_a_gap_and_a_sharp_dogleg_pass_when_the_scene_allows_them(tmp_path):
    gap = write(tmp_path, lines(HEAD, "0,0,0", "2200,1,0", "2230,1,0"))
    assert len(read_survey(gap, max_gap=2200.0).md) == 3
    sharp = write(tmp_path, lines(HEAD, "0,0,0", "1,30,0"), "sharp.csv")
    with pytest.raises(SceneError):
        read_survey(sharp)
    assert len(read_survey(sharp, max_dogleg_severity=math.radians(31)).md) == 2


def test_a_file_that_is_not_there_or_a_folder_is_refused(tmp_path):
    for path in (tmp_path / "nowhere.csv", tmp_path):
        with pytest.raises(SceneError) as caught:
            read_survey(path)
        assert caught.value.problems[0].cure.startswith("check the path")


def test_a_file_of_more_than_ten_megabytes_is_refused_unread(tmp_path):
    path = tmp_path / "large.csv"
    with path.open("wb") as file:
        file.truncate(LARGEST_FILE + 1)
    with pytest.raises(SceneError, match="10 MB are the most"):
        read_survey(path)


def test_a_file_of_ten_thousand_bad_rows_stops_at_a_thousand_problems(tmp_path):
    with pytest.raises(SceneError) as caught:
        read_survey(write(tmp_path, lines(HEAD, *["x,0,0"] * 10_000)))
    assert len(caught.value.problems) == 1000 and str(caught.value).count("\n") <= 20


@pytest.mark.parametrize(
    "title",
    [
        "Azi Magnetic (deg)",
        "Azimuth, mag [deg]",
        "Azi_Mag (deg)",
        "Magnetic Azimuth (deg)",
        "Azi (deg mag)",
        "Azimuth (Magnetic) [deg]",
        "Azi [deg, magnetic]",
        "azi (mag)",
    ],
)
def test_azimuths_from_magnetic_north_are_refused_and_told_to_be_corrected(title, tmp_path):
    with pytest.raises(SceneError) as caught:
        read_survey(write(tmp_path, lines(f"MD [m];Inc [deg];{title}", "0;0;0", "30;1.5;350")))
    (problem,) = caught.value.problems
    assert problem.line == 1 and problem.key == "azi" and problem.value == title
    assert "magnetic north" in problem.cause and "declination" in problem.cure


@pytest.mark.parametrize(
    ("head", "key", "words"),
    [
        ("MD [m];Inc [deg];Azi (deg from south)", "azi", ("from south", "add 180 deg")),
        ("MD [m];Inc [deg];South azimuth [deg]", "azi", ("from south", "add 180 deg")),
        ("MD [m];Inc [deg];Azi (south) [deg]", "azi", ("from south", "add 180 deg")),
        ("Depth (m TVD);Inc [deg];Azi [deg]", "md", ("vertical depths", "measured depths")),
        ("Vertical Depth [m];Inc [deg];Azi [deg]", "md", ("vertical depths", "measured depths")),
        ("MD;Inc;Azi\nm;deg;deg mag", "azi", ("magnetic north", "declination")),
    ],
)
def test_columns_that_are_like_those_of_a_survey_are_refused_as_what_they_are(head, key, words, tmp_path):
    with pytest.raises(SceneError) as caught:
        read_survey(write(tmp_path, lines(head, "0;0;0", "30;1.5;350")))
    (problem,) = caught.value.problems
    assert problem.key == key and words[0] in problem.cause and words[1] in problem.cure
    assert "unit" not in problem.cause


@pytest.mark.parametrize(
    ("head", "key", "title"),
    [
        ("Hole depth MD [m];TVD [m];inc [deg];azi [deg]", "md", "Hole depth MD [m]"),
        ("depth MD [m];depth TVD [m];inc [deg];azi [deg]", "md", "depth MD [m]"),
        ("Measured depth (driller's; not TVD) [m];inc [deg];azi [deg]", "md", "Measured depth (driller's"),
        ("md [m];inc [deg];azi mag [deg];azi, corrected [deg]", "azi", "azi, corrected [deg]"),
        ("md [m];tvd [m];inc [deg];Azi true south island grid [deg]", "azi", "Azi true south island grid [deg]"),
    ],
)
def test_a_title_that_is_not_known_is_told_and_none_that_is_like_a_column_is_blamed(head, key, title, tmp_path):
    with pytest.raises(SceneError) as caught:
        read_survey(write(tmp_path, lines(head, "0;0;0;0", "30;30;1.5;350")))
    (problem,) = caught.value.problems
    assert problem.key == key and title in problem.value and problem.cause == "no such column in the header"


@pytest.mark.parametrize("azimuth", ["Azi [deg (mag. corr.)]", "Azi [deg south zone]", "azi grid (south zone) [deg]"])
def test_azimuths_that_are_corrected_or_of_a_field_in_the_south_are_not_told_to_be_changed(azimuth, tmp_path):
    with pytest.raises(SceneError) as caught:
        read_survey(write(tmp_path, lines(f"MD [m];Inc [deg];{azimuth}", "0;0;0", "30;1.5;350")))
    (problem,) = caught.value.problems
    assert problem.key == "azi" and "unit" in problem.cause
    assert "180" not in problem.cure and "declination" not in problem.cure


@pytest.mark.parametrize("title", ["Azi (deg mag)", "Azi [deg] (from south)"])
def test_a_survey_is_read_beside_columns_that_are_like_its_own(title, tmp_path):
    head = f"MD (m),Incl (°),{title},Azi True (°),TVD (m),Depth (m TVD)"
    survey = read_survey(write(tmp_path, lines(head, "0,0,0,0,0,0", "30,1.5,348,350,30,30", "60,3,8,10,60,60")))
    assert np.allclose(survey.azi, AZI, atol=1e-15) and np.allclose(survey.md, MD, atol=1e-12)


def test_azimuths_from_true_north_are_read_beside_magnetic_ones(tmp_path):
    head = "MD (m),Incl (°),Azi Magnetic (°),Azi True (°)"
    survey = read_survey(write(tmp_path, lines(head, "0,0,0,0", "30,1.5,348,350", "60,3,8,10")))
    assert np.allclose(survey.azi, AZI, atol=1e-15)


def test_faults_of_a_survey_in_feet_quote_its_cells_as_they_stand(tmp_path):
    rows = ["0,0,0", "3000,0,0", "6000,30,10", "6001,45,10", "7000,50,10"]
    with pytest.raises(SceneError) as caught:
        read_survey(write(tmp_path, lines("MD (ft),Inc (deg),Azi (deg)", *rows)))
    gap, turn = caught.value.problems[:2]
    assert (gap.line, gap.value) == (4, "6000 ft") and "no station in the 3000 ft above it" in gap.cause
    assert (turn.line, turn.value) == (5, "45 deg, 10 deg") and "15 deg in 1 ft below line 4" in turn.cause
