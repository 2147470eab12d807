"""A model that is run twice gives the same result twice: what its groups remember is brought back."""

from pathlib import Path

import numpy as np
import pytest

from tautline.application.installed import Installed
from tautline.simulation import simulate
from tautline.system.memory import Beginning

DATA = Path(__file__).parents[2] / "data"


def model_of(name, **keys):
    application, scene = Installed().read(DATA / name)
    return application.build(scene.replace(keys))


@pytest.mark.parametrize("name", ["jwell.yaml", "hoist.yaml", "tripping.yaml"])
def test_the_second_run_of_a_model_is_the_first_to_rounding(name):
    # Measured 7e-15; 2e-4 for the hoist, and 2.5 % for tripping, where the groups begin as the first run left them.
    model = model_of(name, **{"solver.end": 0.5, "output.interval": 0.1})
    first, second = simulate(model), simulate(model)
    for variable in first.variables:
        if first[variable].dtype.kind != "f":
            assert np.array_equal(first[variable], second[variable])
            continue
        size = np.nanmax(np.abs(first[variable]))
        np.testing.assert_allclose(second[variable], first[variable], rtol=0.0, atol=1e-9 * size, err_msg=variable)


def test_what_is_set_between_two_runs_stays_set():
    keys = {"solver.end": 0.5, "output.interval": 0.1}
    model, mass = model_of("hoist.yaml", **keys), 7000.0
    simulate(model)
    model.handles().parameters["payload.mass"].set(mass)
    again = simulate(model)
    alone = model_of("hoist.yaml", **keys)
    alone.handles().parameters["payload.mass"].set(mass)
    assert again["tension"] == pytest.approx(simulate(alone)["tension"], rel=1e-9)


def test_what_a_run_and_then_somebody_has_changed_is_what_somebody_has_set():
    numbers, records = np.array([1.0, 2.0, np.nan]), np.zeros(2, [("worn", float), ("count", np.int64)])
    beginning = Beginning((numbers, records))
    numbers[:], records["worn"], records["count"] = [2.0, 3.0, 0.0], 0.02, 7
    beginning.has_ended((numbers, records))
    numbers[0], records["worn"][1] = 3.0, 0.03
    beginning.bring_back((numbers, records))
    np.testing.assert_array_equal(numbers, [3.0, 2.0, np.nan])
    assert records["worn"].tolist() == [0.0, 0.03] and records["count"].tolist() == [0, 0]
