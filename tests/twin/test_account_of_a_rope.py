"""The account of a rope: what its batch count finds in a run, over operations, kills and other ropes."""

import copy

import numpy as np
import pytest
import yaml
from twin.rehearsal import HOIST, SENSORS, hoist, lines_of, rows_of

import tautline
from crane.results.course import contacts_of, course_of, laid_out, scene_of
from crane.rope_life.account import CELL, RopeAccount, RopeOf
from crane.rope_life.bending import RESOLUTION, Contact, bending_cycles
from crane.rope_life.passages import Arc, passages, staircase, without_ripple
from crane.twin.operation import CraneOperation
from tautline.results.errors import ResultError
from tautline.twin.storage import load, save
from tautline.twin.twin import Twin

ROPE = RopeOf(0.036, 1.1e6, 6.5, 8e7, life=1e5)
UP_AND_DOWN = {"time": [0, 2, 3, 7, 9, 13, 14, 100], "value": [0, 0, -1.5, -1.5, 1.5, 1.5, 0, 0]}


@pytest.fixture(scope="module")
def run():
    """A load that is hoisted and lowered again in waves: its rope's contacts at frames, and where the rope ends."""
    result = tautline.simulate(hoist(UP_AND_DOWN, heave=1.0, end=30.0))
    layout = laid_out(scene_of(result))
    return result.time, contacts_of(result, course_of(result, layout)), result["material_coordinate"][:, -1]


def fed(account, run, begin=0, end=None):
    time, contacts, ends = run
    for k in range(len(time))[begin:end]:
        now = [
            one._replace(on=one.on[k : k + 1], off=one.off[k : k + 1], tension=one.tension[k : k + 1])
            for one in contacts
        ]
        account.add(float(time[k]), now, float(ends[k]))
    return account


def test_row_by_row_it_counts_what_the_count_of_the_whole_run_finds(run):
    account = fed(RopeAccount(ROPE), run)
    _, contacts, ends = run
    assert np.ptp(ends) < 1e-9
    middles = CELL * (np.arange(account._cycles.size) + 0.5)
    total = np.zeros_like(middles)
    for one in contacts:
        low, high = (without_ripple(x, RESOLUTION * ROPE.diameter) for x in (one.on, one.off))
        bends = (one.on != one.off)[1:]
        stairs = staircase(passages(Arc(low, np.maximum(low, high), one.tension, bends)))
        total += 0.5 * stairs.at(ends[0] - middles)
    assert total.max() >= 2.0
    assert account._cycles == pytest.approx(total, abs=1e-12)
    # By the metre it is what `simulate` tells, but for slivers shorter than a cell.
    edges = ends[0] - np.arange(0.0, 40.0)[::-1]
    batch = bending_cycles(run[0], contacts, edges, ROPE.diameter).cycles[::-1]
    _, cycles, _ = account.by_metre()
    n = min(len(batch), len(cycles))
    assert np.mean(batch[:n] == cycles[:n]) > 0.9 and np.abs(batch[:n] - cycles[:n]).max() <= 0.5
    assert batch[:n].max() == cycles.max()


def test_damage_is_miners_sum_by_the_tension_at_each_passage():
    account = RopeAccount(ROPE)
    tension = 150e3

    def sheave(at):
        return [Contact("sheave", np.array([at]), np.array([at + 0.5]), np.array([tension]), 0.4)]

    for k, at in enumerate([0.0, 2.0, 4.0, 0.0, 4.0]):
        account.add(float(k), sheave(at), 20.0)
    # Three times to and fro, by both ends of the arc: three cycles, and their life at this tension by the S-N curve.
    life = ROPE.life * (0.2 * ROPE.breaking_load / tension) ** 5
    damage, place = account.worst
    assert damage == pytest.approx(3.0 / life, rel=1e-9)
    assert 16.0 < place < 19.5
    assert account.by_metre()[1].max() == 3.0
    nothing = RopeAccount(ROPE)
    nothing.add(0.0, sheave(3.0), 20.0)
    assert nothing.worst[0] == 0.0


def account_of(scene, path, end=20.0):
    """Cycles by the metre, and damage with its place, of a scene that runs live."""
    operation, sim = CraneOperation(scene, path), tautline.Simulation(scene, keep=False)
    operation.built(sim)
    while sim.time < end:
        sim.advance(0.1)
        found = operation.found(sim.time, {}, {}, {}, sim)
    return operation.account.by_metre()[1], found["rope.damage"][0], found["rope.damage_place"][0]


def test_a_path_from_the_load_to_its_drum_wears_the_rope_as_one_from_the_drum_to_the_load(tmp_path):
    scene = hoist(UP_AND_DOWN, heave=1.0, end=30.0)
    turned = copy.deepcopy(scene)
    turned["path"].reverse()
    one = account_of(tautline.read(scene), tmp_path / "one.npz")
    other = account_of(tautline.read(turned), tmp_path / "other.npz")
    assert one[0].max() > 1.0 and one[1] > 0.0 and one[2] > 5.0
    # Room for cells that were never passed is made as it comes.
    cycles, same = np.trim_zeros(one[0], "b"), np.trim_zeros(other[0], "b")
    assert len(cycles) == len(same) and np.mean(cycles == same) > 0.95 and np.abs(cycles - same).max() <= 0.5
    assert other[1] == pytest.approx(one[1], rel=1e-3)
    assert other[2] == pytest.approx(one[2], abs=0.1)


def test_two_operations_add_up_and_one_is_not_counted_twice(run, tmp_path):
    path = tmp_path / "rope.npz"
    once = fed(RopeAccount(ROPE, "first"), run)
    once.save(path)
    again = fed(RopeAccount.load(path, ROPE, "first"), run)
    assert np.array_equal(again._cycles, once._cycles)
    second = fed(RopeAccount.load(path, ROPE, "second"), run)
    assert second.by_metre()[1] == pytest.approx(2.0 * once.by_metre()[1])
    assert [one["name"] for one in second.operations] == ["first", "second"]


def test_an_operation_that_goes_on_behind_another_one_counts_no_row_twice(run, tmp_path):
    path = tmp_path / "rope.npz"
    one = fed(RopeAccount(ROPE, "first"), run, end=100)
    one.save(path)
    other = fed(RopeAccount.load(path, ROPE, "second"), run, end=50)
    other.save(path)
    again = fed(RopeAccount.load(path, ROPE, "first"), run, begin=60, end=100)
    assert np.array_equal(again._cycles, other._cycles) and again.worst == other.worst


def test_stopped_on_the_way_and_gone_on_with_it_is_the_same(run, tmp_path):
    path = tmp_path / "rope.npz"
    whole = fed(RopeAccount(ROPE, "a"), run)
    for cut in (3, 77, 140):
        fed(RopeAccount(ROPE, "a"), run, end=cut).save(path)
        # The state of the twin is older than the account.
        on = fed(RopeAccount.load(path, ROPE, "a"), run, begin=max(0, cut - 40))
        assert np.array_equal(on._cycles, whole._cycles) and on.worst == whole.worst


def test_a_kill_while_it_is_written_leaves_the_account_before(run, tmp_path, monkeypatch):
    path = tmp_path / "rope.npz"
    account = fed(RopeAccount(ROPE), run, end=100)
    account.save(path)
    before = path.read_bytes()

    def killed(*_):
        raise KeyboardInterrupt

    monkeypatch.setattr("crane.rope_life.account.os.replace", killed)
    with pytest.raises(KeyboardInterrupt):
        fed(account, run, begin=100).save(path)
    assert path.read_bytes() == before
    RopeAccount.load(path, ROPE)


@pytest.mark.parametrize(("name", "value"), [("diameter", 0.038), ("breaking_load", 1.2e6), ("mass_per_length", 7.0)])
def test_the_account_of_another_rope_is_refused(name, value, tmp_path):
    RopeAccount(ROPE).save(tmp_path / "rope.npz")
    other = RopeOf(**{**ROPE.__dict__, name: value})
    with pytest.raises(tautline.TautlineError, match=f"another rope: its {name.replace('_', ' ')}"):
        RopeAccount.load(tmp_path / "rope.npz", other)


@pytest.mark.parametrize("content", [b"", b"not a file of ours", b"PK\x03\x04 cut off"])
def test_what_is_no_account_is_refused(content, tmp_path):
    (tmp_path / "rope.npz").write_bytes(content)
    with pytest.raises(tautline.TautlineError, match="is no account of a rope"):
        RopeAccount.load(tmp_path / "rope.npz")


# -- in a twin ---------------------------------------------------------------------------------------------------------

MAP = SENSORS + "keep: [rope.damage, boom tip.force]\nahead: 0 s\n"


def scene_with(life=1e5, **rope):
    root = copy.deepcopy(hoist(UP_AND_DOWN, heave=1.0, end=30.0))
    root["rope"] |= {"bending_life": life, **rope}
    return root


def test_a_twin_keeps_the_account_of_its_rope_over_operations_and_kills(tmp_path):
    path, scene = tmp_path / "rope.npz", scene_with()
    rows = rows_of(scene, end=15.0, rate=10.0)
    twin = Twin(scene, MAP, account=path)
    lines = lines_of(twin, rows)
    twin.operation.save()
    first = lines[-1]["estimates"]["rope.damage"]["value"]
    # The frames of a run, ten a second as the rows are, tell the same.
    result = tautline.simulate(tautline.read(scene).replace({"output.interval": 0.1, "solver.end": 15.0}))
    layout = laid_out(scene_of(result))
    run = result.time, contacts_of(result, course_of(result, layout)), result["material_coordinate"][:, -1]
    right = fed(RopeAccount(ROPE), run)
    assert twin.operation.account._cycles.sum() == pytest.approx(right._cycles.sum(), rel=0.02)
    # The rope's tension bounces by some per cent, and damage goes with its fifth power.
    assert first == pytest.approx(right.worst[0], rel=0.3)
    # Another operation, killed half-way and gone on with.
    twin = Twin(scene, MAP, account=path)
    for stamp, readings in rows[:80]:
        twin.add(stamp, readings)
    save(twin, tmp_path / "state")
    for stamp, readings in rows[80:100]:
        twin.add(stamp, readings)
    twin.operation.save()
    again = Twin(scene, MAP, account=path)
    load(again, tmp_path / "state")
    lines = lines_of(again, rows[78:])
    assert lines[-1]["estimates"]["rope.damage"]["value"] == pytest.approx(2.0 * first, rel=1e-3)


def test_a_rope_that_has_done_what_it_lasts_raises_an_alarm(tmp_path):
    scene = scene_with(life=1e-4)
    lines = lines_of(Twin(scene, MAP, account=tmp_path / "rope.npz"), rows_of(scene, end=8.0))
    alarm = next(one for one in lines[-1]["alarms"] if one["name"] == "rope worn")
    assert "m from the load" in alarm["text"]


def test_a_rope_without_a_breaking_load_is_refused_with_the_cure(tmp_path):
    root = yaml.safe_load(open(HOIST))
    root["rope"].pop("breaking_load")
    root["rope"]["axial_stiffness"], root["rope"]["damping"] = 8e7, 1e-4
    with pytest.raises(tautline.TautlineError, match="give breaking_load"):
        Twin(root, MAP, account=tmp_path / "rope.npz")
    with pytest.raises(tautline.TautlineError, match="a drill string keeps none"):
        Twin("data/jwell.yaml", "sensors: [{column: a, unit: m, input: top.block}]", account=tmp_path / "rope.npz")


def test_places_of_a_rope_that_ends_at_an_anchor_are_said_to_count_from_there(tmp_path):
    scene = tautline.read("data/hookblock.yaml").replace({"rope.bending_life": 1e5, "rope.breaking_load": 1.1e6})
    (name, _, text, _) = next(CraneOperation(scene, tmp_path / "rope.npz").alarms())
    assert name == "rope worn" and f"m from {scene.path[-1].name} has had" in text


ANCHORED = {
    "rope": {"mass_per_length": 6.5, "axial_stiffness": 8e7, "damping": 1e-4, "diameter": "36 mm",
             "breaking_load": "1.1 MN"},
    "bodies": [{"name": "payload", "mass": "5 t", "position": [0, 0, -20]}],
    "path": [{"end": {"name": "hook", "body": "payload"}}, {"anchor": {"name": "top", "position": [0, 0, 0]}}],
    "mesh": {"elements_per_span": 1}, "solver": {"end": 1.0, "step": 0.01},
    "output": {"interval": 0.1},
}  # fmt: skip


def anchored(turned=False, hook="hook"):
    root = copy.deepcopy(ANCHORED)
    root["path"][0]["end"]["name"] = hook
    root["path"] = root["path"][::-1] if turned else root["path"]
    return tautline.read(root)


def test_places_count_from_a_load_rather_than_from_an_anchor(tmp_path):
    (_, _, text, _) = next(CraneOperation(anchored(), tmp_path / "rope.npz").alarms())
    assert "m from the load" in text


def test_an_account_that_does_not_say_its_end_is_read_only_where_it_counts_from_the_same_one(tmp_path):
    """Files of versions before counted a path from a load to an anchor from its last item: the anchor."""
    path = tmp_path / "rope.npz"
    old = RopeAccount(RopeOf(0.036, 1.1e6, 6.5, 8e7))
    old._pass(1.0, 5.0, 5e4)
    old.save(path)
    before = path.read_bytes()
    with pytest.raises(
        ResultError, match=r"from the anchor top, and this version counts .* from the end hook.* new acc"
    ):
        CraneOperation(anchored(), path)
    assert path.read_bytes() == before
    # Drawn from the anchor to the load it was the load, and so it is for any crane with a drum.
    taken = CraneOperation(anchored(turned=True), path)
    assert taken.account.worst == old.worst
    assert CraneOperation(tautline.read(scene_with()), path).account.worst[1] == old.worst[1]
    # From then on the file says it: either way of drawing is the same.
    taken.save()
    assert CraneOperation(anchored(), path).account.worst == old.worst


def test_an_account_from_another_end_is_refused_by_a_crane_and_by_one_that_goes_on(tmp_path):
    path = tmp_path / "rope.npz"
    operation = CraneOperation(anchored(), path)
    operation.save()
    with pytest.raises(ResultError, match="from the end hook, and those of the scene from the end ring"):
        CraneOperation(anchored(hook="ring"), path)
    other = CraneOperation(anchored(hook="ring"), tmp_path / "other.npz")
    other.path = path
    with pytest.raises(ResultError, match="from the end hook"):
        other.recall(operation.memory())
    # One that only looks takes any, and keeps what it says.
    looked = RopeAccount.load(path)
    looked.save(path)
    CraneOperation(anchored(), path)


def test_a_map_that_keeps_the_damage_of_its_rope_is_refused_without_an_account_with_the_cure():
    with pytest.raises(tautline.SceneError) as caught:
        Twin(scene_with(), MAP)
    (problem,) = caught.value.problems
    assert (problem.key, problem.value) == ("keep[0]", "rope.damage") and "--account FILE" in problem.cure


def test_a_rehearsal_is_recorded_by_the_map_of_the_operation_though_it_keeps_the_damage():
    rows = rows_of(scene_with(), map=MAP, end=0.5, rate=10.0)
    assert len(rows) == 6
