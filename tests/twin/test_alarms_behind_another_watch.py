"""Alarms of a twin that goes on with another `watch`: what is watched still goes on, and what is not ends with a note.

Readings are written here: a load that hangs still with 49 kN, and 84 kN from 0.5 s to 1.4 s; then its cell is silent.
"""

import json

import numpy as np
import pytest
from twin.rehearsal import STILL

from tautline.twin.storage import load, save
from tautline.twin.twin import Twin

SENSORS = "sensors: [{column: load, unit: kN, output: winch.tension, sd: 0.5 kN}]\nahead: 0 s\n"
OVERLOAD = "{output: winch.tension, above: 80 kN, name: overload}"
LASTING = "{output: winch.tension, above: 80 kN, for: 2 s, name: lasting}"
SAVED, END = 30, 60
"""Rows, 10 Hz, before the twin is saved, and of all."""


def watching(*entries):
    return Twin(STILL, SENSORS + f"watch: [{', '.join(entries)}]\n")


def lines(twin, shown, begin, end):
    """Time of each line, and of its alarms the name and whether it is known."""
    noise = 0.1 * np.sin(37.0 * np.arange(END) ** 2)
    rows = [(0.1 * k, [shown[k] + noise[k]]) for k in range(begin, end)]
    told = [line for row in rows for line in twin.add(*row)]
    return [(line["time"], {one["name"]: one["known"] for one in line["alarms"]}) for line in told]


@pytest.fixture(scope="module", params=["the same", "another"])
def state(request, tmp_path_factory):
    """A state whose overload is active and whose cell is silent; its simulations are as this program's, or others."""
    first, path = watching(OVERLOAD, LASTING), tmp_path_factory.mktemp("states") / "own.npz"
    assert lines(first, [49.0] * 5 + [84.0] * 10 + [np.nan] * 15, 0, SAVED)[-1][1]["overload"] is False
    save(first, path)
    with np.load(path) as file:
        words = json.loads(file["words"].tobytes())
        words |= {"layout": "of another version"} if request.param == "another" else {}
        np.savez(path, **{**file, "words": np.frombuffer(json.dumps(words).encode(), np.uint8)})
    return path


def gone_on(state, *entries, shown=np.nan):
    """The last alarms of a twin that goes on with other entries, and its notes of what is not watched any more."""
    twin = watching(*entries)
    load(twin, state)
    return lines(twin, [shown] * END, SAVED, END)[-1][1], [one for one in twin.notes if "not watched" in one]


@pytest.mark.parametrize(
    "entries",
    [
        [],
        ["{output: winch.tension, below: 10 kN, name: overload}"],
        ["{residual: winch.tension, above: 80 kN, name: overload}"],
    ],
    ids=["taken out", "on the other side", "of the residual"],
)
def test_an_alarm_that_is_not_watched_any_more_ends_and_a_note_tells_it_with_its_text(entries, state):
    alarms, notes = gone_on(state, *entries)
    assert "overload" not in alarms
    (note,) = notes
    assert note.startswith("overload is not watched any more by this map; it was active since 0.5 s: "), note
    assert "kN, above 80 kN" in note


@pytest.mark.parametrize(
    ("entries", "name"),
    [
        ([OVERLOAD], "overload"),
        ([OVERLOAD.replace("80 kN", "83 kN")], "overload"),
        ([OVERLOAD.replace("overload", "too much")], "too much"),
        (["{output: winch.tension, above: 70 kN}"], "winch.tension above 70 kN"),
        ([OVERLOAD.replace("above: 80 kN", "above: 80 kN, below: 1 kN")], "overload"),
    ],
    ids=["the same", "another bound", "another name", "a name by another bound", "a second side"],
)
def test_an_overload_of_a_dead_cell_goes_on_where_its_output_is_watched_still_whatever_its_name_and_bound(
    entries, name, state
):
    alarms, notes = gone_on(state, *entries)
    assert alarms[name] is False and not notes
    alarms, _ = gone_on(state, *entries, shown=49.0)
    assert name not in alarms, "its cell shows less"


def test_the_time_of_a_bound_goes_on_under_another_name(state):
    """84 kN again from 3.5 s on: three seconds behind the first that was beyond the bound, with `for: 2 s`."""
    twin = watching(OVERLOAD, LASTING.replace("lasting", "long"))
    load(twin, state)
    found = lines(twin, [np.nan] * 35 + [84.0] * 25, SAVED, 42)
    assert {"long" in alarms for _, alarms in found} == {True, False}
    assert all(("long" in alarms) == (time > 3.45) for time, alarms in found)


def test_an_alarm_that_another_one_of_its_output_is_left_beside_ends(state):
    alarms, notes = gone_on(state, LASTING)
    assert "overload" not in alarms and len(notes) == 1


def test_alarms_of_a_state_that_does_not_say_what_it_watched_go_on(state, tmp_path):
    with np.load(state) as file:
        words = json.loads(file["words"].tobytes())
        del words["watch"]
        np.savez(tmp_path / "a.npz", **{**file, "words": np.frombuffer(json.dumps(words).encode(), np.uint8)})
    alarms, notes = gone_on(tmp_path / "a.npz")
    assert "overload" in alarms and not notes


def between(bound, name=""):
    return f"{{output: winch.tension, above: {bound} kN{', name: ' + name if name else ''}}}"


@pytest.mark.parametrize(
    ("before", "after", "active"),
    [
        ([(60, "warn"), (80, "overload")], [(60, "high"), (80, "critical")], {"high"}),
        ([(60, ""), (80, "")], [(65, ""), (85, "")], {"winch.tension above 65 kN"}),
        ([(60, "warn")], [(60, "high"), (500, "critical")], {"high"}),
    ],
    ids=["both renamed", "both bounds moved", "one renamed and one added"],
)
def test_an_alarm_goes_on_as_one_alone_and_as_that_whose_bound_is_nearest(before, after, active, tmp_path):
    """70 kN was shown: none of the bounds of 80 kN and more was ever passed, and the cell is dead since."""
    first, path = watching(*(between(*one) for one in before)), tmp_path / "own.npz"
    lines(first, [49.0] * 5 + [70.0] * 10 + [np.nan] * 15, 0, SAVED)
    save(first, path)
    alarms, notes = gone_on(path, *(between(*one) for one in after))
    names = {name for _, name in after}
    watched = {name for name in alarms if name in names or " above " in name}
    assert watched == active and not notes
