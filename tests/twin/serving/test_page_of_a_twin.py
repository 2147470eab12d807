"""The page of a twin: its numbers are those of the stream, in a browser and without one."""

import socket
import threading
import time
import urllib.error
import urllib.request

import pytest
from cli.in_process import commands_of
from twin.rehearsal import CALM, hoist, rows_of, weight_twin
from twin.serving.lookers import UNITS, events, line, opened, shown, told_of

import tautline
from crane.application import Crane
from tautline.twin.page.server import Page

uvicorn = pytest.importorskip("uvicorn", reason="the page needs the extra `live`")


def test_the_page_ends_at_once_and_without_a_word_though_readers_do_not_read(caplog):
    """What was sent fills all buffers on the way: who sends more waits for the reader."""
    made = Page(0, "a hoist", UNITS, Crane())
    for k in range(3000):
        made.publish(line(0.1 * k, long="x" * 4000))
    readers = [socket.create_connection((made.host, made.port)) for _ in range(3)]
    for one in readers:
        one.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 2048)
        one.sendall(b"GET /events HTTP/1.1\r\nHost: localhost\r\n\r\n")
        assert one.recv(15) == b"HTTP/1.1 200 OK"
    time.sleep(0.5)
    begun = time.monotonic()
    made.close()
    assert time.monotonic() - begun < 4.0
    assert not caplog.records, "they would be printed where nobody asks for them"
    for one in readers:
        one.close()


def test_readers_are_told_that_no_rows_come_also_late_ones_and_no_more_once_they_do(page):
    page.publish(line(1.0))
    page.tell("no rows for 14 s")
    assert events(page.address, 3)[1:] == [("lines", [told_of(line(1.0))]), ("silent", {"text": "no rows for 14 s"})]
    page.publish(line(2.0))
    threading.Timer(0.3, page.publish, [line(3.0)]).start()
    assert [kind for kind, _ in events(page.address, 3)] == ["about", "lines", "line"]


def test_one_who_comes_late_gets_all_lines_so_far_and_then_those_that_come(page):
    for k in range(5):
        page.publish(line(0.1 * k))
    later = threading.Timer(0.5, lambda: page.publish(line(7.0)))
    later.start()
    (about, told), (lines, before), (kind, now) = events(page.address, 3)
    assert (about, lines, kind) == ("about", "lines", "line")
    assert told["title"] == "a hoist" and told["units"] == UNITS
    assert [one["time"] for one in before] == pytest.approx([0.0, 0.1, 0.2, 0.3, 0.4])
    assert now == told_of(line(7.0))


def test_browsers_that_do_not_read_do_not_hold_the_twin_up(page):
    readers = [socket.create_connection(("127.0.0.1", page.port)) for _ in range(3)]
    for reader in readers:
        reader.sendall(b"GET /events HTTP/1.1\r\nHost: localhost\r\n\r\n")
    time.sleep(0.3)
    begin = time.thread_time()
    for k in range(3000):
        page.publish(line(0.05 * k, filler="x" * 2000))
    assert (time.thread_time() - begin) / 3000 < 1e-3
    # And one who reads still gets what is new.
    assert events(page.address, 2)[1][1][-1]["time"] == pytest.approx(0.05 * 2999)
    for reader in readers:
        reader.close()


def test_the_page_asks_for_nothing_from_elsewhere(page):
    for name, kind in (("", "text/html"), ("page.js", "text/javascript"), ("page.css", "text/css")):
        with urllib.request.urlopen(f"{page.address}/{name}", timeout=5.0) as answer:
            text = answer.read().decode()
            assert answer.headers["Content-Type"].startswith(kind)
            assert "default-src 'none'" in answer.headers["Content-Security-Policy"]
            assert "http:" not in text and "https:" not in text


def test_a_port_that_is_taken_is_refused_with_the_cure(page):
    with pytest.raises(tautline.TautlineError, match=rf"--serve {page.port}.*give another port, or 0"):
        Page(page.port, "another", UNITS, Crane())


@pytest.mark.parametrize("where", ["eighty", "70000"])
def test_what_is_no_port_ends_with_2_and_writes_nothing(where, tmp_path, capsys):
    (tmp_path / "map.yaml").write_text("sensors: [{column: a, unit: m, input: winch.pay_out}]\n")
    (tmp_path / "a.csv").write_text("time,a\n0,0\n")
    wanted = [
        "twin", "data/hoist.yaml", "--map", str(tmp_path / "map.yaml"), "--source", str(tmp_path / "a.csv"),
        "-o", str(tmp_path / "twin.nc"), f"--serve={where}",
    ]  # fmt: skip
    code, _, told = commands_of(Crane(), capsys)(*wanted)
    assert code == 2 and "--serve" in told
    assert not (tmp_path / "twin.nc").exists()


# -- in a browser ------------------------------------------------------------------------------------------------------


def test_the_page_is_grey_while_no_rows_come(browser, page):
    page.publish(line(1.0))
    tab, _, wrong = opened(browser, page)
    tab.wait_for_selector("#health[data-health=good]")
    page.tell("no rows for 14 s")
    tab.wait_for_selector("body.old #health[data-health=none]", timeout=2000)
    assert tab.locator("#health").inner_text() == "no rows for 14 s"
    page.publish(line(2.0))
    tab.wait_for_selector("body:not(.old) #health[data-health=good]", timeout=2000)
    assert not wrong


def test_the_numbers_on_the_page_are_those_of_the_stream_within_a_second(browser, page):
    page.publish(line(0.0))
    tab, asked, wrong = opened(browser, page)
    tab.wait_for_selector('#estimates .card[data-name="payload.mass"]')
    for k in range(1, 6):
        told = line(10.0 + k, mass=5000.0 + 7.0 * k)
        page.publish(told)
        tab.wait_for_selector(f'#time[data-value="{told["time"]:g}"]', timeout=1000)
        assert shown(tab, '#estimates .card[data-name="payload.mass"] .value') == 5000.0 + 7.0 * k
        assert shown(tab, '#estimates .card[data-name="payload.mass"] .with') == 12.5
        assert shown(tab, '#traces .card[data-name="winch.tension"] .measured') == told["measured"]["winch.tension"]
        assert shown(tab, '#traces .card[data-name="winch.tension"] .computed') == told["outputs"]["winch.tension"]
    assert tab.locator('#estimates .card[data-name="payload.mass"] .value').inner_text() == "5035 kg"
    assert tab.locator('#estimates .card[data-name="payload.mass"] .with').inner_text() == "± 25 kg"
    assert tab.locator('#traces .card[data-name="winch.tension"] .measured').inner_text() == "49.06 kN"
    assert tab.locator('#others tr[data-name="winch.pay_out"] td').nth(1).inner_text() == "-0.5000 m"
    assert tab.locator("#health").inner_text() == "good"
    assert all(url.startswith(page.address) or url.startswith("data:") for url in asked) and not wrong


def test_alarms_are_shown_with_their_cause_and_limits_with_what_they_come_from(browser, page):
    tab, _, wrong = opened(browser, page)
    alarm = {"name": "overload", "since": 12.5, "text": "winch.tension computed: 61.2 kN, above 60 kN"}
    limit = {"name": "hoisting speed", "text": "hoisting speed at most 0.4 m/s, then overload", "restrict": True}
    page.publish(line(13.0, alarms=[alarm], restrict=[limit], health="degraded", not_observable=["a: not shown"]))
    tab.wait_for_selector('#alarms li[data-name="overload"]', timeout=1000)
    assert "61.2 kN, above 60 kN" in tab.locator('#alarms li[data-name="overload"] .cause').inner_text()
    assert tab.locator("#limits li.passed").inner_text() == limit["text"]
    assert tab.locator("#unseen").inner_text() == "a: not shown"
    assert tab.locator("#health").inner_text() == "degraded"
    page.publish(line(13.1))
    tab.wait_for_selector("#alarms", state="hidden", timeout=1000)
    assert not wrong


def test_the_load_is_drawn_where_it_is(browser, page):
    twin = weight_twin(start="5 t")
    rows = rows_of(hoist(CALM), end=2.0)
    lines = [told for stamp, readings in rows for told in twin.add(stamp, readings)]
    first = twin.estimate.family.simulations[0]
    tab, _, wrong = opened(browser, page)
    page.publish(lines[-1], first.model, first.parts.frames.rows[0])
    patience = time.monotonic() + 20.0
    while not tab.evaluate("picture !== null && shape !== null") and time.monotonic() < patience:
        tab.wait_for_timeout(100)
    names = tab.evaluate("shape.solids.filter((one) => one.moves).map((one) => one.name)")
    pose = tab.evaluate("picture.poses")[names.index("payload")]
    assert pose[3::4][:2] == pytest.approx(first["payload.position"][:2], abs=0.01)
    assert tab.evaluate("picture.lines[0]")[0] == pytest.approx(first["position"][0], abs=0.6)
    # Something is on the canvas, and it turns.
    drawn = "document.querySelector('#picture canvas').toDataURL()"
    before = tab.evaluate(drawn)
    box = tab.locator("#picture canvas").bounding_box()
    tab.mouse.move(box["x"] + 100, box["y"] + 100)
    tab.mouse.down()
    tab.mouse.move(box["x"] + 200, box["y"] + 120)
    tab.mouse.up()
    tab.wait_for_timeout(300)
    assert tab.evaluate(drawn) != before and not wrong


def test_a_twin_that_has_ended_is_told_and_its_last_numbers_stay(browser):
    page = Page(0, "a hoist", UNITS, Crane())
    page.publish(line(3.0))
    tab, _, _ = opened(browser, page)
    tab.wait_for_selector('#estimates .card[data-name="payload.mass"]')
    page.close()
    tab.wait_for_selector("#health[data-health=none]", timeout=5000)
    assert shown(tab, '#estimates .card[data-name="payload.mass"] .value') == 5000.0


def test_the_page_answers_to_its_own_name_only(page):
    """A page from elsewhere, whose name was made to lead to this computer, gets nothing."""

    def answer(host):
        request = urllib.request.Request(f"{page.address}/", headers={"Host": host})
        try:
            with urllib.request.urlopen(request, timeout=5.0) as found:
                return found.status
        except urllib.error.HTTPError as error:
            return error.code

    assert [answer(host) for host in ("localhost", f"localhost:{page.port}", "127.0.0.1:1")] == [200, 200, 200]
    assert answer("evil.example") == 400
