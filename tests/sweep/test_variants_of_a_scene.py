"""Cases of one runner share what was prepared of their scene: each is the run of that scene alone, to the bit."""

from collections import ChainMap

import numpy as np
import pytest
from sweep.short_hoist import HOIST, MASS, PERIOD, hoist

import tautline
from crane.assembly.layout import lay_out
from tautline.integrators.time_loop import new_frames
from tautline.kernels.time_function import TimeFunctions
from tautline.results.brief_store import BriefStore
from tautline.results.on_demand import OnDemand, together
from tautline.scene.errors import SceneError
from tautline.sweeps.cases import Runner, job_of
from tautline.sweeps.file import Collected
from tautline.sweeps.sweep import KEPT

DATA = HOIST.parent
PATH = tautline.read(HOIST).document.root["path"]
BESIDE = {"sheave": {"name": "runner", "center": [4, 0, 20], "radius": 0.4, "axis": [0, 1, 0], "wrap": "over"}}
OF_HOIST = (
    {},
    {MASS: 7300.0},
    {PERIOD: 6.5},
    {"rope.axial_stiffness": 6.0e7, "bodies[0].force": [{"constant": 0}, {"constant": 500}, {"constant": 0}]},
    {"mesh.elements_per_span": 3},
    {"path[0].drum.pay_out": {"harmonic": {"amplitude": 0.4, "period": 3}}},
    {"path": [PATH[0], BESIDE, *PATH[1:]]},
    {"vessel.motion.heave.harmonic.period": 9.0, "path[1].sheave.bearing.friction": 0.0},
    {"start": "as drawn"},
)
"""Numbers that reach a few groups or all of them, a law, and other structures: elements, a sheave, friction."""
OF_WELL = ({}, {"mud.density": 1200.0}, {"model.elements": 8}, {"top.rotation": {"constant": "20 rpm"}})
OF_HOSE = ({}, {"water.speed.ramp.to": 20.0}, {"hose.elements": 5}, {"hose.damping": 0.0})


def alone(file, changes, end):
    """Figures of a scene that is read anew, and shares nothing with any other."""
    found = tautline.simulate(tautline.read(file).replace({**changes, "solver.end": end}))
    return {name: one["value"] for name, one in found.headline.items()}


@pytest.mark.parametrize(
    ("file", "end", "variants", "names"),
    [
        ("hoist.yaml", 0.4, OF_HOIST, ("max_tension", "max_sheave_load", "rise", "max_fleet_angle")),
        ("jwell.yaml", 0.2, OF_WELL, ("hook_load_max", "hook_load_min")),
        ("hose.yaml", 0.02, OF_HOSE, ()),
    ],
)
def test_a_case_after_others_is_the_run_of_its_scene_alone_to_the_bit(file, end, variants, names):
    scene = tautline.read(DATA / file).replace({"solver.end": end})
    collected = tuple(Collected(name=name, figure=name) for name in names)
    runner = Runner(job_of(tautline._installed().of(scene), scene, "simulate", {}, collected))
    expected = [alone(DATA / file, changes, end) for changes in variants]
    # Forwards and back again: each comes after one that it shares most with, and after one that it shares less with.
    order = [*range(len(variants)), *reversed(range(len(variants)))]
    for case in order:
        row = runner.run(case, variants[case])[0]
        assert row.status == "done", (variants[case], row.message)
        for name in names or expected[case]:
            assert row.values[name] == expected[case][name], (variants[case], name)


def arrays(functions):
    for part in functions:
        yield from arrays(part) if isinstance(part, tuple) else [part]


def test_models_of_one_scene_share_no_memory_that_a_run_writes():
    scene = hoist(0.2)
    one, other = (tautline._installed().of(scene).build(variant) for variant in (scene, scene.replace({MASS: 4000.0})))
    assert isinstance(one.system.functions, TimeFunctions)
    pairs = zip(arrays(one.system.functions), arrays(other.system.functions), strict=True)
    assert not any(np.shares_memory(a, b) for a, b in pairs)


def test_scenes_of_one_geometry_are_laid_out_once_and_what_a_run_writes_is_not_shared():
    scene = hoist(0.2)
    layouts = [lay_out(variant) for variant in (scene, scene.replace({MASS: 4000.0}), scene.replace({PERIOD: 6.0}))]
    one, other, third = layouts
    assert one.path is other.path and one.known is other.known
    assert other.scene.bodies[0].mass == 4000.0
    assert third.known is not one.known  # the vessel moves otherwise: functions of time are others
    before = one.degrees.value.copy(), list(one.degrees.names), dict(one.degrees.motion), len(one.requests.of)
    other.degrees.value[:] = np.nan
    other.degrees.add("further", 1.0)
    other.degrees.fix(0)
    other.requests.add(other.requests.of[0])
    other.supply[0] = 3
    other.wheels["radius"] = 7.0
    again = lay_out(scene.replace({MASS: 5000.0}))
    for layout in (one, again):
        assert np.array_equal(layout.degrees.value, before[0]) and layout.degrees.names == before[1]
        assert layout.degrees.motion == before[2] and len(layout.requests.of) == before[3] and layout.supply == {}
        assert not (layout.wheels["radius"] == 7.0).any()


@pytest.mark.parametrize(
    "changes",
    [
        {"bodies[0].position": [12.4, 0, 6]},
        {"bodies[0].guide": ["y"]},
        {"rope.diameter": 0.02},
        {"mesh.elements_per_span": 2},
        {"start": "as drawn"},
        {"path[1].sheave.radius": 0.5},
        {"gravity": [0, 0, -9.7]},
    ],
)
def test_a_scene_of_another_geometry_is_laid_out_as_if_it_were_the_first(changes):
    scene = hoist(0.2)
    lay_out(scene)
    found, alone = (lay_out(of.replace(changes)) for of in (scene, hoist(0.2)))
    for name in ("value", "names", "motion", "masters"):
        assert repr(getattr(found.degrees, name)) == repr(getattr(alone.degrees, name))
    assert found.wheels.tobytes() == alone.wheels.tobytes() and found.station == alone.station
    assert found.path.length == alone.path.length


def test_a_load_that_a_variant_makes_float_is_refused_though_its_geometry_is_known():
    water = {"water": {"surface": 50.0, "density": 1025.0}, "rope.diameter": 0.03, "bodies[0].volume": 1.0}
    scene = hoist(0.2).replace(water)
    lay_out(scene)
    with pytest.raises(SceneError, match="does not pull on its rope"):
        lay_out(scene.replace({MASS: 500.0}))


def test_what_is_known_of_a_mapping_is_known_of_the_same_with_more():
    made = []
    parts = OnDemand({"a": lambda: made.append("a") or 1.0, "b": lambda: made.append("b") or 2.0})
    assert parts["a"] == 1.0
    more = parts.also(c=lambda: 3.0)
    assert [more[name] for name in ("a", "b", "c")] == [1.0, 2.0, 3.0] and "c" not in parts
    assert parts["b"] == 2.0 and made == ["a", "b"]


def test_only_what_a_figure_needs_is_made_of_the_frames():
    made = []
    parts = {"time": lambda: np.arange(2.0), "tension": lambda: made.append("tension") or np.ones(2)}
    parts |= together(("load", "angle"), lambda: made.append("wheel") or {"load": np.ones(2), "angle": np.zeros(2)})
    store = BriefStore(None, [])
    store.variables = [type("Named", (), {"name": name}) for name in parts]
    store.append(OnDemand(parts))
    assert made == []
    result = store.result
    assert result["load"].tolist() == [1.0, 1.0] and result["angle"].tolist() == [0.0, 0.0] and made == ["wheel"]
    store.append({"time": np.arange(2.0, 4.0), "tension": np.zeros(2)})
    assert store.result["tension"].tolist() == [1.0, 1.0, 0.0, 0.0] and store.result.time.size == 4


def test_the_frames_of_a_case_are_gone_with_it_without_a_collection_of_garbage():
    import gc
    import weakref

    model = tautline._installed().of(hoist()).build(hoist())
    frames = new_frames(3, model.system.q.size, model.own)
    store = BriefStore(None, model.variables)
    store.append(ChainMap({"time": frames.time}, model.on_demand(frames)))
    assert store.result["drum_tension"].shape == (3, 1)
    gone = weakref.ref(frames.rows)
    gc.disable()
    try:
        del store, frames
        assert gone() is None
    finally:
        gc.enable()


@pytest.mark.parametrize("file", ["hoist.yaml", "sixteen_falls.yaml"])
def test_a_model_and_its_arrays_are_gone_with_the_case_without_a_collection_of_garbage(file):
    import gc
    import weakref

    scene = tautline.read(DATA / file)
    application = tautline._installed().of(scene)
    application.build(scene)
    gc.disable()
    try:
        model = application.build(scene.replace({MASS: 4000.0}))
        gone = [weakref.ref(array) for array in (model.system.q, model.system.groups[0].rows, model.system.scale)]
        assert model.handles().outputs
        del model
        assert all(one() is None for one in gone)
    finally:
        gc.enable()


def test_scenes_of_a_short_sweep_are_made_once_and_of_a_long_one_no_more_are_kept_than_so_many(monkeypatch):
    made = []
    varied = Runner.varied
    monkeypatch.setattr(Runner, "varied", lambda self, changes: made.append(1) or varied(self, changes))
    masses = {MASS: [3000.0, 4000.0, 5000.0, 6000.0]}
    kept = tautline.sweep(hoist(0.05), masses, collect=["max_tension"], jobs=1)
    assert len(made) == 4 + 1  # one is built beforehand
    monkeypatch.setattr("tautline.sweeps.sweep.KEPT", 2 * len(hoist().document.text))
    del made[:]
    again = tautline.sweep(hoist(0.05), masses, collect=["max_tension"], jobs=1)
    assert len(made) == 4 + 1 + 2 and KEPT > 100 * len(hoist().document.text)
    assert again["max_tension"].values.tolist() == kept["max_tension"].values.tolist()
