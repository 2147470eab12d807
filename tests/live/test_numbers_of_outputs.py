"""One number of an output by its index: ``payload.position[2]``, wherever outputs are named."""

from pathlib import Path

import numpy as np
import pytest

import tautline
from tautline.live.errors import UnknownName

DATA = Path(__file__).parents[2] / "data"
SPEED = "winch.pay_out_speed"


@pytest.fixture(scope="module")
def hoist():
    sim = tautline.Simulation(DATA / "hoist.yaml", keep=False)
    sim.advance_to(0.2)
    return sim


@pytest.mark.parametrize("name", ["payload.position", "payload.velocity", "tension"])
def test_a_number_of_an_output_is_read_by_its_index(hoist, name):
    for at in np.ndindex(hoist[name].shape):
        one = hoist[f"{name}[{','.join(map(str, at))}]"]
        assert isinstance(one, float) and one == hoist[name][at]


def test_a_plant_of_some_numbers_has_the_rows_of_the_plant_of_the_whole(hoist):
    whole = hoist.linearise([SPEED], ["payload.position", "tension"])
    rows = [2, 0, 4]
    names = [whole.outputs[k] for k in rows]
    part = hoist.linearise([SPEED], names)
    assert list(part.outputs) == names and set(names) <= part.units.keys()
    assert np.array_equal(part.C, whole.C[rows]) and np.array_equal(part.D, whole.D[rows])


@pytest.mark.parametrize(
    ("name", "words"),
    [
        ("payload.position[3]", "has 3 of these: count from 0 to 2"),
        ("payload.position[0,0]", "has 1 index"),
        ("winch.tension[0]", "is one number"),
        ("payload.positon[0]", "payload.position"),
        (["payload.position"], "there is no output"),
    ],
)
def test_a_number_that_an_output_does_not_have_is_refused(hoist, name, words):
    with pytest.raises(UnknownName) as refused:
        hoist[name]
    assert words in str(refused.value)


def test_one_direction_can_be_displaced_and_pushed():
    sim = tautline.Simulation(DATA / "hoist.yaml", keep=False)
    before = sim["payload.velocity"]
    sim.displace("payload.velocity[1]", 0.1)
    assert np.array_equal(sim["payload.velocity"], before + [0.0, 0.1, 0.0])
    sim.add_force(lambda t, q, v: [1.0e3], on="payload.position[1]")
    other = sim.copy()
    other.advance_to(0.05)
    assert other["payload.velocity[1]"] == pytest.approx(0.1 + 0.05 * 1.0e3 / 5.0e3, rel=0.02)


def test_an_fmu_may_have_some_numbers_of_an_output(tmp_path):
    pytest.importorskip("pythonfmu", reason="PythonFMU is not installed")
    fmpy = pytest.importorskip("fmpy", reason="FMPy is not installed")
    from tautline.live.fmu.writing import write_fmu

    write_fmu(DATA / "hoist.yaml", tmp_path / "hoist.fmu", [SPEED], ["payload.position[2]"])
    told = fmpy.read_model_description(str(tmp_path / "hoist.fmu"))
    assert [one.name for one in told.modelVariables if one.causality == "output"] == ["payload.position[2]"]


def test_an_output_that_is_read_makes_no_variable_that_nobody_asked_for(hoist, monkeypatch):
    def never(*_):
        raise AssertionError("made, though nobody asked for it")

    hoist.advance_to(hoist.time + 0.01)
    monkeypatch.setattr("crane.results.observe.Observer._sheaves", never)
    assert hoist["tension"].shape and hoist["winch.tension"] > 0.0
    with pytest.raises(AssertionError, match="nobody asked"):
        hoist["sheave_load"]


def test_a_force_reads_outputs_of_one_frame_the_newest_while_it_advances():
    sim = tautline.Simulation(DATA / "hoist.yaml")
    seen = []

    def force(t, q, v):
        # The second is asked for later only: it must not be made of another frame than the first.
        seen.append((t, sim["winch.tension"], sim["max_tension"] if t > 0.25 else None))
        return np.zeros_like(q)

    sim.add_force(force, on="payload.position")
    sim.advance_to(0.5)
    result = sim.result
    drum, most = result["drum_tension"][:, 0], result["tension"].reshape(len(result.time), -1).max(axis=1)
    for _, one, other in seen:
        frames = [np.flatnonzero(np.isclose(drum, one, rtol=1e-12))]
        frames += [np.flatnonzero(np.isclose(most, other, rtol=1e-12))] if other is not None else []
        assert set.intersection(*(set(some.tolist()) for some in frames))
    assert np.isclose(seen[-1][1], drum[-2], rtol=1e-12)
