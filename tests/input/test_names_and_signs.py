"""Names that would tear a table apart, and minus signs that come from documents."""

import pytest
from cli.in_process import commands_of

import tautline
from crane.application import Crane
from tautline.scene.errors import Problem, SceneError
from tautline.scene.names import named

LIFT = """
rope: {mass_per_length: 2.2 kg/m, axial_stiffness: 40 MN, damping: 1 ms, breaking_load: 0.4 MN}
bodies:
  - {name: crate, mass: 2 t, position: [8.2, 0, 1]}
path:
  - drum: {name: "WINCH", center: [0, 0, 0], radius: 0.3, axis: [0, 1, 0], wrap: over, pay_out: {constant: SPEED}}
  - sheave: {name: boom tip, center: [8, 0, 6], radius: 0.2, axis: [0, 1, 0], wrap: over}
  - end: {name: hook, body: crate}
solver: {step: 5 ms, end: 1 s}
output: {interval: 20 ms}
"""


def read(winch="winch", speed="0 m/s"):
    return tautline.read(LIFT.replace("WINCH", winch).replace("SPEED", speed))


@pytest.mark.parametrize(
    ("letter", "code"), [(r"\t", "U+0009"), (r"\e[31m", "U+001B"), (r"\n", "U+000A"), (r"\L", "U+2028")]
)
def test_a_name_with_a_character_that_cannot_be_seen_is_refused_by_its_number(letter, code):
    with pytest.raises(SceneError, match=r"name.*cannot be seen") as refused:
        read(winch=f"win{letter}ch")
    assert code in str(refused.value)


@pytest.mark.parametrize("name", ["winch", "Trommel süd", "巻上機", "a\u00a0b", "D-1/a [x]"])
def test_a_name_of_any_alphabet_is_good(name):
    assert named(name) == name
    read(winch=name)


@pytest.mark.parametrize("sign", ["\u2212", "\u2013", "\u2011"])
@pytest.mark.parametrize("number", ["0.5 m/s", "0.5", ".5"])
def test_another_minus_sign_is_named_with_what_to_write(sign, number):
    with pytest.raises(SceneError) as refused:
        read(speed=f"{sign}{number}")
    told = str(refused.value)
    assert f"another minus sign, U+{ord(sign):04X}" in told and f"hyphen of the keyboard: -{number}" in told


def test_a_value_outside_of_what_an_option_takes_is_told_with_value_and_cure(capsys, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    command = commands_of(Crane(), capsys)
    for words, option, value, bound in (
        (("operability", "a.yaml", "--seeds", "0"), "--seeds", "0", "1"),
        (("export", "a.nc", "--every", "-3"), "--every", "-3", "1"),
    ):
        code, _, err = command(*words)
        assert code == 2 and option in err and bound in err and value in err and "Input should be" not in err


def test_another_minus_sign_in_a_cell_of_a_table_is_named_too():
    from tautline.scene.values.habits import other_minus

    assert other_minus("\u22120.25") == (
        "has another minus sign, U+2212", "write it with the hyphen of the keyboard: -0.25"
    )  # fmt: skip
    assert other_minus("-0.25") is None and other_minus("\u2013") is None and other_minus("a\u20130.25") is None


def test_a_table_with_another_minus_sign_says_so_with_line_and_cell(tmp_path):
    (tmp_path / "speed.csv").write_text("time [s],speed [m/s]\n0,0\n1,\u22120.25\n", encoding="utf-8")
    (tmp_path / "lift.yaml").write_text(
        LIFT.replace("WINCH", "winch").replace("{constant: SPEED}", "{table: {file: speed.csv}}"), encoding="utf-8"
    )
    with pytest.raises(SceneError, match=r"speed\.csv:3.*another minus sign, U\+2212.*-0\.25"):
        tautline.read(tmp_path / "lift.yaml")


def test_a_refusal_prints_no_character_that_steers_a_terminal():
    told = str(Problem("a.yaml", 3, "bodies[0].name", "x\x1b[31my", "did you mean bad\x1b[31mname?"))
    assert "\x1b" not in told and told.count("\\x1b[31m") == 2
