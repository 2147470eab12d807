"""Letters that the font of figures lacks are told once, in one sentence, and other warnings stay as they are."""

import warnings

import pytest

from tautline.cli.output.console import warnings_said
from tautline.errors import TautlineWarning
from tautline.view.figures import missing_letters
from tautline.view.figures.figure import axes, save, styled

TITLE = "Bohrung Åsgård 測試 🚢"


@styled
def drawn(title):
    figure, _ = axes(width=2.0, height=1.5)
    figure.suptitle(title)
    return figure


@pytest.fixture(autouse=True)
def nothing_told(monkeypatch):
    monkeypatch.setattr(missing_letters, "_told", set())


def heard_while_saving(path, *titles):
    with warnings.catch_warnings(record=True) as heard:
        warnings.simplefilter("always")
        for k, title in enumerate(titles):
            save(drawn(title), path / f"{k}.svg")
            save(drawn(title), path / f"{k}.png")
    return heard


def test_one_warning_names_all_letters_that_the_font_lacks_for_all_figures(tmp_path):
    (one,) = heard_while_saving(tmp_path, TITLE, TITLE)
    assert one.category is TautlineWarning
    text = str(one.message)
    assert all(letter in text for letter in "測試🚢") and "Å" not in text and "DejaVu Sans" in text
    assert "Glyph" not in text and "titles and names" in text
    assert len(list(tmp_path.iterdir())) == 4


def test_letters_that_were_told_are_not_told_again_and_new_ones_are(tmp_path):
    one, other = heard_while_saving(tmp_path, "測", "測試")
    assert "測" in str(one.message) and "測" not in str(other.message) and "試" in str(other.message)


def test_a_title_that_the_font_can_write_says_nothing(tmp_path):
    assert not heard_while_saving(tmp_path, "Bohrung Åsgård µ²")


def test_warnings_of_others_stay_as_they_are():
    with pytest.warns(UserWarning, match="of somebody else"), missing_letters.missing_letters_told():
        warnings.warn("of somebody else", stacklevel=1)


def test_a_command_prints_the_sentence_as_its_own_warning(capsys, tmp_path):
    with warnings_said(), warnings.catch_warnings():
        warnings.simplefilter("always")
        save(drawn(TITLE), tmp_path / "one.svg")
    told = capsys.readouterr().err
    assert told.startswith("warning: the font of figures") and ".py" not in told and told.count("\n") == 1
