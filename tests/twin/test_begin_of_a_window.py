"""Whether a window of a twin goes back to where its simulations began, and where free motions begin then."""

import numpy as np
import pytest
from twin.rehearsal import SENSORS, hoist, lines_of, rows_of

from tautline.twin.estimation.estimate import Estimate
from tautline.twin.estimation.log import Log, Logged
from tautline.twin.twin import Twin


@pytest.mark.parametrize(
    "times", [np.arange(0.0, 60.0, 2.0), np.append(np.arange(0.0, 5.0, 0.1), np.arange(14, 30, 0.1))]
)
def test_a_window_reaches_back_to_the_begin_for_its_own_length_only(times):
    """Rows that come slowly, and a gap: the oldest row that is kept is that of the oldest state for a while then."""
    log, alike = Log(10.0), 0
    log.begin(times[0], [])
    for time in times:
        log.rows.append(Logged(time, [], np.zeros(1), np.ones(1, bool)))
        if log.is_due(time):
            log.keep(time, [])
        log.forget(time)
        begin = log.checkpoints[0].time
        assert log.reaches_begin == (begin == times[0])
        alike += log.rows[0].time == begin > times[0]
    assert alike
    log.clear()
    assert not log.reaches_begin


@pytest.mark.parametrize("off", [0.0, 1.0])
def test_free_motions_of_the_first_window_are_a_quarter_of_a_period_apart_wherever_the_machine_begins(off, monkeypatch):
    """Blows fall where the window begins, behind the way to there; else the first one has died away, or is in phase."""
    scene, seen = hoist({"time": [0, 60], "value": [0, 0]}), []
    old = Estimate._samples_of
    monkeypatch.setattr(Estimate, "_samples_of", lambda *given: seen.append(old(*given)) or seen[-1])
    map_of_weight = (
        SENSORS + "estimate:\n  - {parameter: payload.mass, start: 8 t, sd: 4 t}\nahead: 0 s\nwindow: 12 s\n"
    )
    rows = [(t, {**r, "winch_pos": r["winch_pos"] + off}) for t, r in rows_of(scene, 0, 4.0, rate=10.0)]
    twin = Twin(scene, map_of_weight)
    lines_of(twin, rows)
    assert twin.estimate.log.reaches_begin
    found = seen[3]
    size = np.linalg.svd(np.array([one.J[0, -2:] for one in found[len(found) // 3 :]]), compute_uv=False)
    assert size[1] > 0.5 * size[0]
