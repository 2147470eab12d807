"""The floors and ceilings of packages: a numba outside of what was tested is named, and every package has a floor."""

import importlib.util
from pathlib import Path

import pytest

from tautline.cli.output.numba_version import version_note

ROOT = Path(__file__).parents[2]
ASKED = ["numpy>=1.26", "numba<0.69,>=0.60"]


@pytest.mark.parametrize("installed", ["0.59.1", "0.69.0", "0.70.0rc1", "1.0.0"])
def test_a_numba_outside_of_what_was_tested_is_named_with_a_cure(installed):
    note = version_note(installed, ASKED)
    assert note is not None
    assert f"numba {installed} is not tested" in note
    assert "pip install 'numba>=0.60,<0.69'" in note


@pytest.mark.parametrize("installed", ["0.60.0", "0.68.1", "0.68.2"])
def test_a_numba_that_was_tested_is_not_spoken_of(installed):
    assert version_note(installed, ASKED) is None


def test_the_lowest_version_of_every_package_is_read_from_its_requirement():
    spec = importlib.util.spec_from_file_location("lowest", ROOT / ".ci" / "lowest.py")
    lowest = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(lowest)
    assert lowest.pins(ASKED[:1] + ["numba>=0.60,<0.69"]) == ["numpy==1.26", "numba==0.60"]
    with pytest.raises(SystemExit, match="has no floor"):
        lowest.pins(["rich"])
