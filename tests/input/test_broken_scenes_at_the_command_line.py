"""The same table through `drillstring simulate`: exit code 2, one line a fault, no traceback, nothing written."""

import os
import re

import pytest
from test_broken_scenes import EDITS, TEXT, WHOLE_FILES

from drillstring.application import Drillstring
from tautline.cli.run import run
from tautline.cli.verbs import make_app

SURVEY = "md [m],inc [deg],azi [deg]\n0,0,0\n500,0,0\n{}\n2000,60,10\n2400,60,10\n"

# what only the builder can tell: what is replaced, by what, the line, the key, words of the message
BUILT = {
    "a string longer than its hole": ("length: rest", "length: 5 km", 14, "string[0].length", "5240 m"),
    "no room left for the rest": ("length: 240 m", "length: 4 km", 14, "string[0].length = rest", "no room"),
    "a build to another azimuth when inclined": (
        "- {build: {radius: 1000 m, to: 90 deg, azimuth: 0 deg}}",
        "- {build: {radius: 1000 m, to: 45 deg, azimuth: 0 deg}}\n"
        "    - {build: {radius: 1000 m, to: 90 deg, azimuth: 80 deg}}",
        7,
        "well.sections[2]",
        "turn",
    ),
    "a turn of a vertical hole": (
        "- {build: {radius: 1000 m, to: 90 deg, azimuth: 0 deg}}",
        "- {turn: {radius: 1000 m, to: 90 deg}}",
        6,
        "well.sections[1]",
        "turn",
    ),
}
SURVEYS = {
    "a survey with a gap": ("1500,60,10\n", "md", "gap"),
    "a survey that goes back": ("400,10,10", "md", "400"),
    "a survey with a station twice": ("500,0,0", "md", "500"),
    "a survey with a word": ("1000,steep,10", "inc", "steep"),
    "a survey with a hole in it": ("1000,,10", "inc", ""),
    "a survey with an inclination of 200": ("1000,200,10", "inc", "200"),
    "a survey that turns round": ("503,170,10", "inc", "170"),
}


def outcome(folder, capsys, text, *options):
    """Exit code, what was printed, and what was written, of a scene."""
    path = folder / "scene.yaml"
    path.write_bytes(text if isinstance(text, bytes) else text.encode())
    before = sorted(os.listdir(folder))
    with pytest.raises(SystemExit) as left:
        run(make_app(Drillstring(), ["simulate"]), ["simulate", str(path), "-o", str(folder / "result.nc"), *options])
    printed = "".join(capsys.readouterr())
    return left.value.code, printed, sorted(set(os.listdir(folder)) - set(before))


def test_the_tables_hold_more_than_forty_broken_scenes():
    assert len(EDITS) + len(WHOLE_FILES) + len(BUILT) + len(SURVEYS) > 40


@pytest.mark.parametrize("name", [*EDITS, *BUILT])
def test_a_broken_scene_exits_2_with_line_key_and_cure_and_writes_nothing(name, tmp_path, capsys):
    old, new, line, key, words = (EDITS | BUILT)[name]
    assert old in TEXT
    code, printed, written = outcome(tmp_path, capsys, TEXT.replace(old, new, 1))
    assert code == 2 and written == [] and "Traceback" not in printed
    flat = re.sub(r"\s+", " ", printed)
    assert (f"scene.yaml:{line}: " in flat or line is None) and words in flat
    assert key in flat or "duplicate" in name


@pytest.mark.parametrize("name", WHOLE_FILES)
def test_a_file_that_is_no_scene_exits_2_and_writes_nothing(name, tmp_path, capsys):
    content = WHOLE_FILES[name][0] if isinstance(WHOLE_FILES[name], tuple) else WHOLE_FILES[name]
    code, printed, written = outcome(tmp_path, capsys, content)
    assert code == 2 and written == [] and "Traceback" not in printed and "scene.yaml" in printed


@pytest.mark.parametrize("name", SURVEYS)
def test_a_broken_survey_exits_2_with_its_row(name, tmp_path, capsys):
    row, column, words = SURVEYS[name]
    (tmp_path / "survey.csv").write_text(SURVEY.format(row))
    start, end = TEXT.index("  sections:"), TEXT.index("  # survey:")
    code, printed, written = outcome(tmp_path, capsys, TEXT[:start] + "  survey: survey.csv\n" + TEXT[end:])
    assert code == 2 and written == [] and "Traceback" not in printed
    assert re.search(r"survey\.csv:\d+: ", printed) and column in printed and words in printed


@pytest.mark.parametrize(
    ("option", "value"), [("--method", "rk5"), ("--step", "0"), ("--step", "-1"), ("--end", "nan"), ("--rho-inf", "2")]
)
def test_a_bad_option_exits_2_and_is_named(option, value, tmp_path, capsys):
    code, printed, written = outcome(tmp_path, capsys, TEXT, option, value)
    assert code == 2 and written == [] and option in printed and "Traceback" not in printed
