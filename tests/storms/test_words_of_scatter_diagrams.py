"""A scatter diagram is refused that says of itself to be another one, or that was cut off."""

import re

import numpy as np
import pytest

from crane.operability.scatter import read_scatter
from tautline.scene.errors import SceneError


def refused(place, text, cause):
    place.write_text(text)
    with pytest.raises(SceneError, match=cause) as error:
        read_scatter(place)
    return error.value.problems[0]


@pytest.fixture
def place(tmp_path):
    return tmp_path / "scatter.csv"


@pytest.mark.parametrize(
    "head",
    ["Hs [m] / Tz [s]", "Hs\\T02", "Hs/Tm02 (s)", "H_{m0}; T_{z}", "Hs Te", "Hs [m] / T1 [s]", "Hs/Tm01", "Hs/Tm-10",
     "Hs and mean period", "Hs (m), zero-crossing period (s)", "Hs [m] / Tz [s] (not Tp)", "Hs/Te (from Tp)",
     "Hs / Tzero", "Hs/T(z)", "Hs / period (zero crossing)", "Hs / wave period (mean)", "Hm0 / T-1,0", "Hm0 / Tm-1,0",
     "H1/3 / TH1/3", "Hs / T1/3", "Hs/Tc", "Hs / Tz, peak enhancement 3.3", "Hs [m] / Tz = Tp/1.286 [s]",
     "Hs_m / Tz_s", "Hs/Tavg", "Hs, average period"],
)  # fmt: skip
def test_a_diagram_by_another_period_is_refused(place, head):
    """Tz was read as Tp: lives came out up to twice too short, and at other headings too long."""
    problem = refused(place, f'"{head}",5,6\n1.0,1,1\n', "is not the peak period Tp")
    assert problem.line == 1 and "convert the periods" in problem.cure


def test_the_ratios_that_the_refusal_names_are_those_of_the_spectrum(place):
    w = np.linspace(0.05, 60.0, 600_001)
    width = np.where(w <= 1.0, 0.07, 0.09)
    density = w**-5 * np.exp(-1.25 * w**-4) * 3.3 ** np.exp(-0.5 * ((w - 1.0) / width) ** 2)
    before, m0, m1, m2 = (np.trapezoid(density * w**k, w) for k in (-1, 0, 1, 2))
    wanted = {"Tz": (m2 / m0) ** 0.5, "Tm01": m1 / m0, "Te": m0 / before}
    cure = refused(place, "Hs/Tz,5,6\n1.0,1,1\n", "peak period").cure
    named = {name: float(ratio) for ratio, name in re.findall(r"(\d\.\d{3}) (T\w+)", cure)}
    assert named == pytest.approx(wanted, abs=1e-3)


@pytest.mark.parametrize(
    "head",
    ["Tp [s] / Hs [m]", "Tpeak vs Hs", "peak period / height", "T_p \\ H_s", "T [s] / Hs [m]", "Tp / H",
     "Tp (rows) / Hs (columns)",
     "Tp ↓ / Hs →", "Tp / Hs (columns)", "Hs (columns) / Tp (rows)", "Hs across; Tp down"],
)  # fmt: skip
def test_a_diagram_that_names_periods_before_heights_is_refused(place, head):
    problem = refused(place, f"{head},5,6\n1.0,1,1\n", "heights stand in the first column")
    assert problem.line == 1 and "exchange rows and columns" in problem.cure


@pytest.mark.parametrize(
    "head",
    ["Hs (return period, mean)", "Hs / period (mean of bin) Tp", "Hs / Tpeak", "Hs(m)/T(s)", "Hs / T(p)",
     "H1/3 [m] / Tp [s]", "Hs (significant) / Tp",
     "Tp in first row / Hs in first column", "Hs / Tp at site T1", "Hs (rows) / Tp (columns)",
     "Hs", "Hs [m]", "Hs / Tp", "H_s [m] \\ T_p [s]", "Hm0 and Tp", "significant wave height [m], peak period [s]",
     "", "sea states of 1991, bin means", "Hs [m] (mean of the bin)",
     "H [m] / Tp [s]", "Hmo [m] / Tp [s]", "H [ft] / Tp [s]", "Sig. wave ht (m) / peak period (s)", "Wellenhöhe / Tp",
     "Sea state / Tp", "Tp [s]", "Tp [s], storms of 3 h", "Hs [m] / Tp [s] at site T1", "Hs/Tp 1.2*Tm",
     "period of record 1979-2010; Hs / Tp", "Tp (columns) / Hs (rows)", "Tp → / Hs ↓", "Tp / Hs (rows)",
     "columns Tp, rows Hs", "VHM0 / VTPK"],
)  # fmt: skip
def test_a_first_cell_of_heights_and_peak_periods_is_taken_and_so_is_any_other_word(place, head):
    place.write_text(f'"{head}",5,6\n1.0,1,1\n')
    assert read_scatter(place).periods.tolist() == [5.0, 6.0]


def test_a_row_that_was_cut_off_is_refused_and_an_empty_cell_is_none(place):
    """The shares of time of all other sea states had become larger without a word."""
    problem = refused(place, "Hs [m],6,8\n0.5,30\n1.0,20,80\n", "has 2 cells, and the head 3")
    assert problem.line == 2 and "0 or empty" in problem.cure
    place.write_text("Hs [m],6,8\n0.5,30,\n1.0,20,50\n")
    assert read_scatter(place).share.tolist() == [[0.3, 0.0], [0.2, 0.5]]
