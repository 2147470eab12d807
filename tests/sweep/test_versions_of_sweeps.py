"""One table is of one program: no worker of another version runs a case, and no other version goes on with a sweep."""

import json
import pickle

import pytest
from sweep.short_hoist import MASS, hoist

import tautline
from tautline.results.errors import ResultError
from tautline.scene.errors import SceneError
from tautline.sweeps import cases
from tautline.sweeps.journal import NAME
from tautline.sweeps.workers import _lost, _of_any_worker
from tautline.version import __version__

VARY = {MASS: [2000.0, 4000.0]}


def job():
    scene = hoist(0.05)
    return pickle.dumps(cases.job_of(tautline._installed().of(scene), scene, "simulate", {}, ()))


@pytest.mark.parametrize(
    ("of_sweep", "said"),
    [
        (("9.9.9", cases.program()[1]), f"a worker has Tautline {__version__}, and the sweep is run with 9.9.9"),
        ((__version__, "0" * 16), f"a worker has Tautline {__version__} of other sources"),
    ],
)
def test_a_worker_of_another_version_or_of_other_sources_runs_no_case_and_the_sweep_names_both(of_sweep, said):
    with pytest.raises(cases.OtherProgram, match=said) as found:
        cases.run_piece(of_sweep, job(), [(0, {})])
    error = pickle.loads(pickle.dumps(found.value))
    with pytest.raises(SceneError, match=rf"--dask tcp://a:1: .*{said}.*install the same version of Tautline"):
        list(_lost(error, [0], "tcp://a:1"))


def test_a_worker_of_the_same_program_runs_its_cases():
    ((row, _),) = cases.run_piece(cases.program(), job(), [(0, {})])
    assert row.status == "done"


def test_a_worker_of_an_older_version_that_lacks_what_runs_a_piece_says_so_and_does_not_end(monkeypatch):
    pickled = pytest.importorskip("distributed.protocol.pickle")
    run = pickled.loads(pickled.dumps(_of_any_worker()))
    ((row, _),) = run(cases.program(), job(), [(0, {})])
    assert row.status == "done"
    monkeypatch.delattr(cases, "run_piece")
    # It is taken to workers whole: to look for it by its name would end them.
    run = pickled.loads(pickled.dumps(_of_any_worker()))
    with pytest.raises(ImportError, match=f"older Tautline, {__version__}, and the sweep is run with {__version__}"):
        run(cases.program(), b"", [])


def test_the_hash_of_all_sources_tells_a_change_in_any_file_and_no_line_ends(tmp_path, monkeypatch):
    from tautline import entry_points
    from tautline.kernels.machine import sources

    package = tmp_path / "ropework"
    package.mkdir()
    (package / "__init__.py").write_bytes(b"a = 1\n")
    monkeypatch.syspath_prepend(tmp_path)
    monkeypatch.setattr(entry_points, "packages_of_ours", lambda: frozenset({"ropework"}))

    def of(text):
        (package / "__init__.py").write_bytes(text)
        return sources.hash_of_all_sources.__wrapped__()

    assert of(b"a = 1\n") == of(b"a = 1\r\n") != of(b"a = 2\n")


def with_head(folder, **changes):
    """Change the head of a journal; None removes a key."""
    first, *others = (folder / NAME).read_text(encoding="utf8").splitlines(keepends=True)
    head = {key: value for key, value in (json.loads(first) | changes).items() if value is not None}
    (folder / NAME).write_text(json.dumps(head) + "\n" + "".join(others), encoding="utf8")


@pytest.mark.parametrize(
    ("version", "said"),
    [
        (
            "0.0.9",
            rf"begun with Tautline 0\.0\.9, and this is .* {__version__}.*run with Tautline 0\.0\.9, or",
        ),
        (None, "begun with an older Tautline that did not note its version.*name another folder"),
    ],
)
def test_a_sweep_that_another_version_began_is_not_gone_on_with(tmp_path, version, said):
    out = tmp_path / "out"
    tautline.sweep(hoist(0.05), VARY, collect=["rise"], jobs=1, folder=out)
    assert json.loads((out / NAME).read_text(encoding="utf8").splitlines()[0])["version"] == __version__
    with_head(out, version=version)
    before = (out / NAME).read_bytes()
    with pytest.raises(ResultError, match=said):
        tautline.sweep(hoist(0.05), VARY, collect=["rise"], jobs=1, folder=out, resume=True)
    assert (out / NAME).read_bytes() == before


def test_a_sweep_that_was_begun_before_the_sources_changed_is_not_gone_on_with_under_the_same_number(
    tmp_path, monkeypatch
):
    from tautline.sweeps import journal

    out = tmp_path / "out"
    tautline.sweep(hoist(0.05), VARY, collect=["rise"], jobs=1, folder=out)
    before = (out / NAME).read_bytes()
    tautline.sweep(hoist(0.05), VARY, collect=["rise"], jobs=1, folder=out, resume=True)
    monkeypatch.setattr(journal, "program", lambda: (__version__, "0" * 16), raising=False)
    with pytest.raises(ResultError, match=r"of other sources than those that are here now.*run with the sources that"):
        tautline.sweep(hoist(0.05), VARY, collect=["rise"], jobs=1, folder=out, resume=True)
    assert (out / NAME).read_bytes() == before


def test_the_hash_of_all_sources_costs_no_more_than_twenty_milliseconds_of_the_processor():
    from time import process_time

    from tautline.kernels.machine import sources

    def taken():
        began = process_time()
        sources.hash_of_all_sources.__wrapped__()
        return process_time() - began

    assert min(taken() for _ in range(10)) < 0.02
