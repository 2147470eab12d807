"""The twin and the model beside records that others made; benchmarks/records/comparison.py writes all of it."""

from math import pi

import numpy as np
import pytest

import tautline
from benchmarks.records import comparison, torsional_start_up, ufrj_rig
from tautline.twin.sources.opening import open_source

SHAFT, DISC = (2.4, 0.005), (0.05, 0.3)
"""Length and diameter, m, of a made-up rig."""
SHEAR, DENSITY = 79e9, 7850.0


def rig_scene():
    pieces = [
        {"name": name, "length": length, "od": d, "id": 1e-4}
        for name, (length, d) in (("shaft", SHAFT), ("disc", DISC))
    ]
    return {
        "title": "A rig", "well": {"sections": [{"hold": 3.0}], "diameter": 0.5, "wall": "none"}, "string": pieces,
        "material": {"youngs_modulus": 206e9, "shear_modulus": SHEAR, "density": DENSITY},
        "top": {"block": 0.0, "rotation": 8.0}, "model": {"kind": "lumped", "elements": 4},
        "solver": {"method": "generalized-alpha", "step": 1e-3, "end": 1.0}, "output": {"interval": 0.1},
    }  # fmt: skip


def recorded(path, severity=0.9, mean=8.0, noise=0.0, duration=59.0):
    """A MATLAB file with the variables of the UFRJ record and two of the top.

    The disc swings on the shaft held at constant speed. The torque at the top is the shaft's stiffness times its twist,
    which is the time integral of the difference of the speeds.
    """
    from scipy.io import savemat

    stiffness = SHEAR * pi / 32.0 * SHAFT[1] ** 4 / SHAFT[0]
    inertia = DENSITY * pi / 32.0 * DISC[1] ** 4 * DISC[0]
    omega = 0.95 * (stiffness / inertia) ** 0.5
    time = np.arange(0.0, duration, 1e-3)
    random = np.random.default_rng(3)
    bit = mean * (1.0 + severity * np.cos(omega * time))
    torque = 1.0 - stiffness * mean * severity * np.sin(omega * time) / omega
    values = {
        "Time_Sample_175_complete": time, "Bit_Speed_Sample_175_complete": bit * 30.0 / pi,
        "Bit_Torque_Sample_175_complete": torque, "WOB_Sample_175_complete": np.full(time.size, 200.0),
        "Top_Torque": torque + noise * random.normal(size=time.size), "Top_Speed": np.full(time.size, mean * 30.0 / pi),
    }  # fmt: skip
    savemat(path, {name: column[:, None] for name, column in values.items()})
    return path, time, bit


def test_a_record_in_the_format_of_the_rig_of_ufrj_becomes_a_csv_that_the_twin_reads_to_its_last_row(tmp_path):
    file, time, bit = recorded(tmp_path / "rig.mat", duration=9.0)
    rows = ufrj_rig.convert(file, tmp_path / "rig.csv")
    source = open_source(str(tmp_path / "rig.csv"), ["bit_speed"])
    read = []
    while not source.ended:
        record = source.poll(0.0)
        if record is not None:
            read.append((record.time, record.values["bit_speed"]))
    source.close()
    assert rows == len(read) == 9000
    assert np.array(read) == pytest.approx(np.stack([time, bit], axis=1), abs=1e-6)


def test_severity_from_the_top_of_a_record_in_that_format_is_the_measured_one_of_the_disc(tmp_path):
    # Reference: the disc's own speed. 0.03: a tenth of the damping's deviation, and sampling of the extremes.
    file, _, _ = recorded(tmp_path / "rig.mat", noise=0.05)
    found = comparison.rig(file, rig_scene(), ("Top_Torque", "Top_Speed"), tmp_path / "rig.csv")
    assert len(found) >= 3
    for one in found:
        assert one.measured == pytest.approx(0.9, abs=0.01)
        assert one.told == pytest.approx(one.measured, abs=max(0.03, 2.0 * one.sd))


def test_a_file_that_lacks_a_variable_of_the_record_is_refused_with_those_it_has(tmp_path):
    from scipy.io import savemat

    savemat(tmp_path / "other.mat", {"Bit_Speed_Sample_175_complete": np.ones(3)})
    with pytest.raises(ufrj_rig.NoRecord, match=r"no variable Time_Sample_175_complete.*it has Bit_Speed_Sample"):
        ufrj_rig.convert(tmp_path / "other.mat", tmp_path / "other.csv")


@pytest.fixture(scope="module")
def started():
    scene = torsional_start_up.scene(elements=40, step=4e-3, law=comparison.WEAKENING)
    return comparison.compared(tautline.simulate(tautline.read(scene)), "reduced", *comparison.published())


# Published: Aarsnes and Shor 2018, stored output of their program (data/records), times to 0.03 s. 40 lumps and 4 ms
# are off 120 lumps and 2 ms by 0.4 kN m at the least torque and by less elsewhere.
def test_a_published_start_up_off_bottom_begins_as_published(started):
    assert started.first.value == pytest.approx(11.667, rel=0.03)
    assert started.first.time == pytest.approx(0.21, abs=0.03)
    assert started.low.value == pytest.approx(6.304, rel=0.03)
    assert started.rms[0] < 0.4


def test_a_published_start_up_springs_back_after_break_off_as_published(started):
    assert started.least.value == pytest.approx(7.348, rel=0.08)
    assert started.least.time == pytest.approx(12.61, abs=0.2)
    assert started.rms[3] < 1.8


def test_a_published_start_up_breaks_off_near_its_closed_forms_and_below_the_published_peak(started):
    # Closed forms printed there: all static friction is 19.531 kN m, the twist by it 27.433 rad; inertia adds to both.
    # The published peak of 22.49 kN m is not reached: docs/records.md says why.
    assert comparison.BREAK_OFF == pytest.approx(19.531, abs=1e-3)
    assert started.peak.value == pytest.approx(19.531, rel=0.08)
    assert started.twist == pytest.approx(27.433, rel=0.08)
    assert 0.90 < started.peak.value / 22.49 < 0.94


def test_all_static_friction_of_the_scene_is_the_published_break_off_torque():
    # Each stretch: mass times g sin(60 deg) times radius times the sine of the angle whose tangent is the factor.
    scene = torsional_start_up.scene()
    climbed = np.sin(np.arctan(scene["well"]["wall"]["friction"]["static"]))
    pressing = sum(piece["mass_per_length"] * piece["length"] * piece["od"] / 2.0 for piece in scene["string"])
    torque = 9.81 * np.sin(pi / 3.0) * pressing * climbed
    # The top 500 m have a mass of 1 kg/m where the published friction is nought: 0.5 %.
    assert torque / 1e3 == pytest.approx(19.531, rel=0.01)
