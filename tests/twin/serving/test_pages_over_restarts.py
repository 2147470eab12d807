"""A page that stays open while its twin ends and begins again: it finds it again, and shows no other's."""

import asyncio
import json
import socket
import threading
import time
import urllib.request
from contextlib import contextmanager
from unittest.mock import Mock

import pytest
from cli.in_process import commands_of
from twin.serving.lookers import UNITS, events, line, opened

from crane.application import Crane
from tautline.integrators.status import Status, StoppedEarly
from tautline.twin.loss import SceneEnded

pytest.importorskip("uvicorn", reason="the page needs the extra `live`")
MASS = '#estimates .card[data-name="payload.mass"]'
OVERLOAD = {"name": "overload", "since": 12.5, "text": "61.2 kN, above 60 kN", "known": True}
CLOCK = """window.later = [];
window.setTimeout = (what, after) => { later.push([what, after]); };
window.pass = () => later.splice(0).map(([what, after]) => { what(); return after; });
const every = window.setInterval, now = performance.now.bind(performance);
window.setInterval = (what, after) => every(what, after / 20);
window.ahead = 0;
performance.now = () => now() + ahead;"""
"""The time of a page in the hands of a test: `pass` does what was put off, and gives for how long that was."""


@pytest.fixture
def serve():
    """A function that serves a page; all are closed after the test."""
    from tautline.twin.page.server import Page

    made = []

    def one(port=0, mark=""):
        made.append(Page(port, "a hoist", UNITS, Crane(), mark=mark))
        return made[-1]

    yield one
    for page in made:
        page.close()


@pytest.fixture
def tab(browser):
    """A function that opens a page in a tab whose time the test has in its hands."""
    return lambda page: opened(browser, page, CLOCK)[0]


def grey(tab, text):
    tab.wait_for_selector(f'body.old #health[data-health=none]:text-is("{text}")', timeout=10_000)


def well(tab, at):
    tab.wait_for_selector(f'body:not(.old) #time[data-value="{at:g}"]', timeout=10_000)
    tab.wait_for_selector("#health[data-health=good]", timeout=10_000)


def until(tab, what):
    """Wait for an expression of a page to hold."""
    patience = time.monotonic() + 10.0
    while not tab.evaluate(what):
        assert time.monotonic() < patience, what
        tab.wait_for_timeout(20)


def tries(tab):
    """Let a page try again, and after how many ms it would have done so."""
    until(tab, "later.length")
    return tab.evaluate("pass()")


@contextmanager
def failing(port):
    """What a proxy answers while nobody is behind it: 502 to each request."""
    listener = socket.create_server(("127.0.0.1", port))

    def answer():
        while True:
            try:
                one, _ = listener.accept()
            except OSError:
                return
            one.recv(4096)
            asked.set()
            one.sendall(b"HTTP/1.1 502 Bad Gateway\r\nContent-Length: 0\r\nConnection: close\r\n\r\n")
            one.close()

    asked, thread = threading.Event(), threading.Thread(target=answer, daemon=True)
    thread.start()
    yield asked
    listener.shutdown(socket.SHUT_RDWR)
    listener.close()
    thread.join(2.0)


# -- in a browser ------------------------------------------------------------------------------------------------------


def test_a_page_says_that_its_twin_was_stopped_and_finds_it_again_though_a_proxy_answered_502(serve, tab):
    former = serve(mark="a")
    former.publish(line(3.0))
    seen = tab(former)
    well(seen, 3.0)
    former.close()
    grey(seen, "the twin was stopped")
    with failing(former.port) as asked:
        assert tries(seen) == [10_000] and asked.wait(10.0)
        until(seen, "later.length")
    grey(seen, "the twin was stopped")
    serve(former.port, "a").publish(line(4.0))
    assert tries(seen) == [10_000]
    well(seen, 4.0)
    assert seen.evaluate("lines.map((one) => one.time)") == [3.0, 4.0], "the trace of a twin that goes on goes on"


def test_a_page_shows_nothing_of_an_earlier_twin_under_a_new_one(serve, tab):
    former = serve(mark="a")
    former.publish(line(13.0, alarms=[OVERLOAD], causes=["a"], not_observable=["b: not shown"],
                        restrict=[{"text": "slower", "restrict": True}]))  # fmt: skip
    seen = tab(former)
    seen.wait_for_selector("#alarms li")
    seen.evaluate("shape = { number: 1 }; picture = { number: 1 }; first = {}; draw = () => {}")
    former.close("the data have ended")
    grey(seen, "the data have ended")
    assert seen.locator(MASS).count() == 1, "what came last stays, grey"
    later = serve(former.port, "b")
    tries(seen)
    grey(seen, "no data yet")
    seen.wait_for_selector(MASS, state="detached")
    assert seen.locator(".card, #alarms li, #why li, #unseen li, #limits li, #others tr").count() == 0
    assert seen.locator("#time").inner_text() == seen.locator("#lag").inner_text() == "–"
    assert seen.evaluate("[shape, picture, first, lines.length]") == [None, None, None, 0]
    later.publish(line(1.0))
    well(seen, 1.0)


def test_a_page_is_loaded_again_once_for_another_program(serve, browser):
    page = serve()
    page.publish(line(1.0))
    seen, asked, _ = opened(browser, page, CLOCK)
    well(seen, 1.0)
    page._about = json.dumps(json.loads(page._about) | {"program": "another"})
    page._loop.call_soon_threadsafe(lambda: [one.transport.abort() for one in page._server.server_state.connections])
    grey(seen, "no connection to the twin")
    assert tries(seen) == [3000]
    well(seen, 1.0)
    assert seen.evaluate("program") == "another"
    assert asked.count(f"{page.address}/") == 2


def test_a_page_is_grey_while_the_computer_of_its_twin_does_not_answer(serve, tab, monkeypatch):
    """A connection may stand though nobody is at its other end: a cable that was pulled, a process that was halted."""
    from tautline.twin.page import server

    monkeypatch.setattr(server, "ALIVE_EVERY", 0.05)
    page = serve()
    page.publish(line(1.0))
    seen = tab(page)
    well(seen, 1.0)
    for _ in range(2):
        seen.evaluate("ahead += 9000")
        seen.wait_for_timeout(150)
    assert not seen.evaluate("trouble"), "a word now and then is enough"
    monkeypatch.setattr(server, "ALIVE_EVERY", 60.0)
    seen.wait_for_timeout(150)
    seen.evaluate("ahead += 10000")
    grey(seen, "the twin does not answer")


def test_a_turn_is_taken_back_where_the_finger_scrolls_the_page(serve, browser):
    seen, _, wrong = opened(browser, serve())
    found = seen.evaluate(
        """() => { const canvas = document.querySelector("#picture canvas");
        canvas.setPointerCapture = () => {};
        first = { around: 1, up: 0.5, zoom: 1 };
        as_first();
        const send = (kind, clientY) => canvas.dispatchEvent(new PointerEvent(kind, { pointerId: 1, clientY }));
        send("pointerdown", 100); send("pointermove", 90);
        const turned = view.up;
        send("pointercancel", 90);
        const after = { ...view };
        send("pointerdown", 100); send("pointermove", 90); send("pointerup", 90);
        return [turned, after, view.moved]; }"""
    )
    assert found[0] != 0.5
    assert found[1:] == [{"around": 1, "up": 0.5, "zoom": 1, "moved": False}, True] and not wrong


# -- without one -------------------------------------------------------------------------------------------------------


def test_pages_are_told_whether_a_twin_is_the_one_of_before_and_which_program_shows_it(serve):
    told = [events(serve(mark=mark).address, 1)[0][1] for mark in ("a", "a", "", "")]
    assert told[0]["twin"] == told[1]["twin"] == "a"
    assert len({one["twin"] for one in told}) == 3, "without a mark each is another one"
    assert len({one["program"] for one in told}) == 1


def test_a_page_is_of_one_program_though_its_files_change_while_it_is_served(serve, monkeypatch, tmp_path):
    from tautline.twin.page import server

    for name, _ in server.FILES.values():
        (tmp_path / name).write_bytes((server.HERE / name).read_bytes())
    monkeypatch.setattr(server, "HERE", tmp_path)
    before = serve()
    (tmp_path / "page.js").write_text("// of a later version")
    after = serve()

    def served(page):
        with urllib.request.urlopen(f"{page.address}/page.js", timeout=5.0) as found:
            return found.read()

    assert served(after) == b"// of a later version" != served(before)
    first, second = (events(page.address, 1)[0][1]["program"] for page in (before, after))
    assert first != second


def test_a_browser_that_stalls_loses_lines_and_pictures_and_neither_a_shape_nor_the_end(serve):
    page = serve()

    async def look():
        reader = page._events()
        found = [await anext(reader), await anext(reader)]
        for number in (1, 2):
            page._send("shape", f'{{"number": {number}}}')
            for k in range(1000):
                page._take(json.dumps({"time": float(k)}))
                page._send("picture", f'{{"number": {number}, "of": {k}}}')
        page._fall_silent('{"text": "no rows"}')
        page._send("ended", "{}")
        found += [one async for one in reader]
        return found

    made = asyncio.run_coroutine_threadsafe(look(), page._loop).result(5.0)
    told = [(one.split("\n")[0].removeprefix("event: "), json.loads(one.split("data: ")[1])) for one in made]
    times = [content["time"] for kind, content in told if kind == "line"]
    assert times == [float(k) for k in range(600, 1000)], "the newest 400"
    others = [(kind, content) for kind, content in told[2:] if kind != "line"]
    assert others == [
        ("shape", {"number": 2}), ("picture", {"number": 2, "of": 999}), ("silent", {"text": "no rows"}), ("ended", {})
    ]  # fmt: skip


STOPS = {
    "the data have ended": None,
    "the twin was stopped": KeyboardInterrupt(),
    "the twin has ended: the scene moves `a` by itself": SceneEnded(5.0, 4.0, "a"),
    "the twin stopped at 2.0 s: a number overflowed": StoppedEarly(Status.NOT_FINITE, 2.0, "x"),
}


@pytest.mark.parametrize("reason", STOPS)
def test_a_page_is_told_why_its_twin_has_ended(reason, tmp_path, capsys, monkeypatch):
    from tautline.cli.commands import twin
    from tautline.twin.page.server import Page

    told = []
    monkeypatch.setattr(Page, "close", lambda self, reason="", close=Page.close: (told.append(reason), close(self)))
    if STOPS[reason] is not None:
        monkeypatch.setattr(twin._Loop, "_answer_end", Mock(side_effect=STOPS[reason]))
    (tmp_path / "map.yaml").write_text("sensors: [{column: a, unit: m, input: winch.pay_out}]\n")
    (tmp_path / "a.csv").write_text("time,a\n0,0\n0.1,0\n")
    given = ["--map", tmp_path / "map.yaml", "--source", tmp_path / "a.csv", "--serve", "0"]
    commands_of(Crane(), capsys)("twin", "data/hoist.yaml", *given)
    assert len(told) == 1 and told[0].startswith(reason)
