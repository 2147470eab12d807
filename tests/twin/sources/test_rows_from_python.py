"""Rows that a Python program gives a twin itself, and sensors that measure one number of an array."""

import numpy as np
import pytest
from twin.rehearsal import CALM, SENSORS, WEIGHT, calm_rows, hoist, rows_of, weight_twin

import tautline
from tautline.scene.errors import SceneError
from tautline.twin.twin import Twin

HEIGHT = SENSORS + "  - {column: height, unit: m, output: 'payload.position[2]', sd: 5 mm}\n"


def last_mass(rows):
    twin = weight_twin(start="5 t")
    lines = [line for stamp, row in rows for line in twin.add(stamp, row)] + twin.finish()
    return lines[-1]["estimates"]["payload.mass"]["value"]


def test_a_row_is_a_dict_a_list_or_an_array_in_the_order_of_the_map_and_none_is_a_missing_reading():
    rows = [(t, {**r, "another": "text"}) for t, r in calm_rows(3.0)]
    rows[4][1]["rope_tension"] = None
    order = weight_twin().columns
    assert order == ["winch_pos", "heave", "rope_tension"]
    lists = [(t, [r[name] for name in order]) for t, r in rows]
    arrays = [(t, np.array(r, float)) for t, r in lists]
    found = [last_mass(given) for given in (rows, lists, arrays)]
    assert found[0] == found[1] == found[2]
    assert np.isfinite(found[0])


@pytest.mark.parametrize(
    ("row", "words"),
    [([1.0, 2.0], "a row has 2 readings. The map has 3: winch_pos, heave, rope_tension"),
     ({"heave": "high"}, "the reading of heave is 'high', and that is no number")],
)  # fmt: skip
def test_a_row_that_cannot_be_is_refused_in_words(row, words):
    with pytest.raises(tautline.TautlineError, match=words.replace(".", r"\.")):
        weight_twin().add(0.0, row)


def test_one_number_of_an_array_is_read_by_its_place():
    sim = tautline.Simulation("data/hoist.yaml", keep=False)
    sim.advance_to(0.1)
    assert sim["payload.position[2]"] == sim["payload.position"][2]
    assert sim["boom tip.force[0]"] == sim["boom tip.force"][0]
    with pytest.raises(tautline.TautlineError, match="there is no output"):
        sim["payload.position[3]"]


def test_a_sensor_measures_one_number_of_an_array_and_it_is_watched_and_kept():
    more = "watch: [{output: 'payload.position[2]', above: 2 m, name: high}]\nkeep: ['boom tip.force[0]']\nahead: 0 s\n"
    scene = tautline.read(hoist(CALM))
    rows = rows_of(scene, 0, 4.0, HEIGHT, noise=0.0)
    twin = Twin(scene, HEIGHT + more)
    lines = [line for stamp, row in rows for line in twin.add(stamp, row)] + twin.finish()
    for line in lines:
        assert abs(line["residuals"]["payload.position[2]"]) < 0.03
        assert np.isfinite(line["outputs"]["boom tip.force[0]"])
    assert "high" in {one["name"] for one in lines[-1]["alarms"]}
    assert twin.units["payload.position[2]"] == "m"


def test_a_sensor_of_a_whole_array_is_refused_with_the_name_of_one_of_its_numbers():
    with pytest.raises(SceneError, match=r"name one of its numbers: payload\.position\[0\]"):
        Twin(hoist(CALM), WEIGHT.replace("START", "5 t").replace("winch.tension, sd", "payload.position, sd"))
