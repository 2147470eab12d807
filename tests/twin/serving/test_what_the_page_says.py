"""What the page of a twin says, and how it can be read and used: in a browser, as a person would."""

import json
import urllib.request
from datetime import UTC, datetime
from itertools import pairwise

import numpy as np
import pytest
from twin.serving.lookers import events, line, opened, shown, told_of

from crane.application import Crane
from tautline.scene.values.printed import scale_of_zero, scales
from tautline.scene.values.printed import shown as printed

pytest.importorskip("uvicorn", reason="the page needs the extra `live`")
DATE = datetime(2026, 11, 30, 8, 0, 0, tzinfo=UTC).timestamp()
OVERLOAD = {"name": "overload", "since": 12.5, "text": "winch.tension computed: 61.2 kN, above 60 kN", "known": True}
MASS = '#estimates .card[data-name="payload.mass"]'
TENSION = '#traces .card[data-name="winch.tension"]'


@pytest.fixture
def serve():
    """A function that serves a page."""
    from tautline.twin.page.server import Page

    made = []

    def one(units, system):
        made.append(Page(0, "a hoist", units, Crane(), system=system))
        return made[-1]

    yield one
    for page in made:
        page.close()


def contrast(tab, where):
    """Contrast of the text of an element and what is behind it, by WCAG 2.2."""
    found = tab.evaluate(
        """(where) => {
          const node = document.querySelector(where), numbers = (text) => text.match(/[\\d.]+/g).map(Number);
          const clear = (one) => (numbers(getComputedStyle(one).backgroundColor)[3] ?? 1) === 0;
          let behind = node;
          while (behind.parentElement && clear(behind)) behind = behind.parentElement;
          let faded = 1, grey = false;
          for (let one = node; one; one = one.parentElement) {
            faded *= Number(getComputedStyle(one).opacity);
            grey = grey || getComputedStyle(one).filter === "grayscale(1)";
          }
          const found = [node, behind].map((one, k) => numbers(getComputedStyle(one)[k ? "backgroundColor" : "color"]));
          // As the filter does it: one light of all three, by their shares.
          const light = ([r, g, b]) => 0.2126 * r + 0.7152 * g + 0.0722 * b;
          const [over, under] = found.map((one) => grey ? [light(one), light(one), light(one)] : one.slice(0, 3));
          return [over.map((x, k) => faded * x + (1 - faded) * under[k]), under];
        }""",
        where,
    )
    lights = []
    for colour in found:
        parts = [x / 255.0 for x in colour[:3]]
        linear = [x / 12.92 if x <= 0.04045 else ((x + 0.055) / 1.055) ** 2.4 for x in parts]
        lights.append(0.2126 * linear[0] + 0.7152 * linear[1] + 0.0722 * linear[2])
    return (max(lights) + 0.05) / (min(lights) + 0.05)


def test_stamps_that_are_dates_are_said_as_dates_also_those_of_alarms(browser, page):
    page.publish(line(DATE + 0.3, alarms=[OVERLOAD | {"since": DATE - 1.0}]))
    tab, _, wrong = opened(browser, page)
    tab.wait_for_selector("#alarms li")
    assert tab.locator("#time").inner_text() == "2026-11-30 08:00:00.3 UTC"
    since = tab.locator("#alarms .since")
    assert since.inner_text() == "since 2026-11-30 07:59:59.0 UTC"
    assert since.evaluate("(node) => node.scrollWidth <= node.clientWidth")
    assert not wrong


@pytest.mark.parametrize("unit", ["N", "m", "kg", "rad", "rad/s", "Pa", "N m", "s", "", "m/s"])
@pytest.mark.parametrize("system", ["si", "metric", "field"])
def test_a_page_chooses_units_as_printed_tables_do(unit, system):
    for exponent in range(-3, 9):
        value = 2.5 * 10.0**exponent
        factor, name = next((factor, name) for least, factor, name in scales(unit, system) if value >= least)
        number, _, word = printed(value, unit, system).partition(" ")
        assert (name, factor * value) == (word, pytest.approx(float(number), rel=2e-3))
    assert ("0", scale_of_zero(unit, system)[1]) == printed(0.0, unit, system).partition(" ")[::2]


@pytest.mark.parametrize("system", ["si", "metric", "field"])
def test_nothing_is_said_in_the_unit_in_which_printed_tables_say_it(browser, serve, system):
    units = {name: name for name in ("N", "m", "kg", "rad", "rad/s", "Pa", "N m", "s", "m/s")}
    page = serve(units, system)
    page.publish(line(1.0))
    tab, _, wrong = opened(browser, page)
    tab.wait_for_selector(MASS)
    assert {unit: tab.evaluate("(unit) => said(0, unit)", unit) for unit in units} == {
        unit: printed(0.0, unit, system) for unit in units
    }
    assert not wrong


@pytest.mark.parametrize(("system", "speed"), [("si", "12.57 rad/s"), ("metric", "120.0 rpm"), ("field", "120.0 rpm")])
def test_a_rotary_speed_is_said_as_printed_tables_say_it(browser, serve, system, speed):
    """120 rpm are 4 pi rad/s."""
    page = serve({"top_drive.speed": "rad/s"}, system)
    page.publish(line(1.0))
    tab, _, _ = opened(browser, page)
    tab.wait_for_selector(MASS)
    assert tab.evaluate("said(4 * Math.PI, 'rad/s')") == speed
    assert float(speed.split()[0]) == float(printed(12.566371, "rad/s", system).split()[0])


@pytest.mark.parametrize(("value", "sd"), [(-0.3, 10.0), (-0.004, 0.9), (-0.0, 0.0)])
def test_what_rounds_to_zero_has_no_sign(browser, page, value, sd):
    tab, _, _ = opened(browser, page)
    assert float(tab.evaluate("([value, sd]) => digits(value, sd)", [value, sd])) == 0.0
    assert not tab.evaluate("([value, sd]) => digits(value, sd)", [value, sd]).startswith("-")
    assert tab.evaluate("digits(-12.4, 10)") == "-12"


def test_numbers_are_in_the_units_of_the_scene(browser, serve):
    page = serve({"winch.tension": "N", "winch.pay_out": "m", "payload.mass": "kg"}, "field")
    page.publish(line(1.0))
    tab, _, wrong = opened(browser, page)
    tab.wait_for_selector(MASS)
    # 49051 N are 11.03 kip of 4448.22 N, 5000 kg are 11023 lbm of 0.45359237 kg, 0.5 m are 1.640 ft of 0.3048 m.
    assert tab.locator(f"{TENSION} .measured").inner_text() == "11.03 kip"
    assert tab.locator(f"{MASS} .value").inner_text() == "11023 lbm"
    assert tab.locator(f"{MASS} .with").inner_text() == "± 55 lbm"
    assert tab.locator('#others tr[data-name="winch.pay_out"] td').nth(1).inner_text() == "-1.640 ft"
    assert not wrong


def test_a_card_has_one_unit_for_its_numbers_and_its_axis(browser, page):
    for k in range(20):
        page.publish(line(float(k), measured={"winch.tension": 1300.0 if k < 10 else 400.0},
                          outputs={"winch.tension": 380.0}))  # fmt: skip
    tab, _, wrong = opened(browser, page)
    tab.wait_for_selector(TENSION)
    axis = tab.locator(f"{TENSION} canvas").get_attribute("aria-label")
    assert axis == "from 0.38 to 1.30 kN in the last 60 s"
    assert tab.locator(f"{TENSION} .measured").inner_text() == "0.4000 kN"
    assert not wrong


WRITTEN = """window.written = new Map();
const write = CanvasRenderingContext2D.prototype.fillText, clear = CanvasRenderingContext2D.prototype.clearRect;
CanvasRenderingContext2D.prototype.clearRect = function (...at) {
  written.delete(this.canvas);
  clear.call(this, ...at);
};
CanvasRenderingContext2D.prototype.fillText = function (text, x, y) {
  if (text) written.set(this.canvas, [...(written.get(this.canvas) || []), [text, y]]);
  write.call(this, text, x, y);
};"""
"""Keeps what is written on each canvas, with its height."""


@pytest.mark.parametrize(
    ("value", "spread", "number", "axis"),
    [
        (49050.0, 0.0, "49.05", "at 49.05 kN"),
        (49050.0, 0.2, "49.05", "at 49.05 kN"),  # ten thousand times less than the axis is far
        (0.0, 0.0, "0", "at 0 N"),
        (1300.0, 500.0, None, "from 1.30 to 1.80 kN"),
    ],
)
def test_no_text_at_an_axis_is_over_another_one(browser, page, value, spread, number, axis):
    for k in range(4):
        force = {"winch.tension": value + spread * (k % 2)}
        page.publish(line(float(k), measured=force, outputs=force))
    tab, _, wrong = opened(browser, page, WRITTEN)
    tab.wait_for_selector('#time[data-value="3"]')
    label = tab.locator(f"{TENSION} canvas")
    assert label.get_attribute("aria-label") == f"{axis} in the last 60 s"
    texts = label.evaluate("(canvas) => written.get(canvas)")
    heights = sorted(y for _, y in texts)
    assert all(after - before >= 11.0 for before, after in pairwise(heights)), texts
    if number is not None:
        assert [text for text, _ in texts] == [number, axis.split()[-1]]
        assert tab.locator(f"{TENSION} .measured").inner_text().split()[1] == axis.split()[-1]
    assert not wrong


def test_an_estimate_that_stands_still_has_the_digits_of_its_card_at_its_axis(browser, page):
    for k in range(4):
        page.publish(line(float(k), estimates={"payload.mass": {"value": 5000.123, "sd": 0.05, "unit": "kg"}}))
    tab, _, wrong = opened(browser, page)
    tab.wait_for_selector('#time[data-value="3"]')
    assert tab.locator(f"{MASS} .value").inner_text() == "5000.123 kg"
    assert tab.locator(f"{MASS} canvas").get_attribute("aria-label") == "at 5000.123 kg in the last 60 s"
    assert not wrong


def test_the_page_says_why_health_is_not_good(browser, page):
    tab, _, wrong = opened(browser, page)
    page.publish(
        line(1.0, health="degraded", causes=["rope_tension is stuck at 49 kN", "the twin is behind the machine"])
    )
    tab.wait_for_selector("#why li")
    assert tab.locator("#why li").all_inner_texts() == [
        "rope_tension is stuck at 49 kN",
        "the twin is behind the machine",
    ]
    page.publish(line(2.0, causes=[]))
    tab.wait_for_selector("#why", state="hidden")
    assert not wrong


def test_an_alarm_in_doubt_is_outlined_and_says_so(browser, page):
    tab, _, wrong = opened(browser, page)
    page.publish(line(13.0, alarms=[OVERLOAD, OVERLOAD | {"name": "slack rope ahead", "known": False}]))
    tab.wait_for_selector("#alarms .doubted")
    certain, doubted = (tab.locator(f'#alarms li[data-name="{name}"]') for name in ("overload", "slack rope ahead"))
    behind = "(node) => getComputedStyle(node).backgroundColor"
    assert "in doubt" in doubted.inner_text() and "in doubt" not in certain.inner_text()
    assert doubted.evaluate(behind) == "rgba(0, 0, 0, 0)" != certain.evaluate(behind)
    page.publish(line(13.1, alarms=[OVERLOAD, OVERLOAD | {"name": "slack rope ahead"}]))
    tab.wait_for_selector("#alarms .doubted", state="detached")
    assert "in doubt" not in doubted.inner_text() and not wrong


def test_rows_of_alarms_that_go_on_are_not_made_anew(browser, page):
    """Who has the page read aloud hears an alarm once, not with every line."""
    tab, _, wrong = opened(browser, page)
    page.publish(line(13.0, alarms=[OVERLOAD], restrict=[{"text": "slower", "restrict": True}]))
    tab.wait_for_selector("#alarms li")
    tab.evaluate("""() => { window.changes = 0;
      new MutationObserver((all) => { window.changes += all.length; })
        .observe(document.querySelector("main").parentElement, { childList: true, subtree: true });
      window.before = document.querySelector("#alarms li"); }""")
    for k in range(1, 6):
        page.publish(line(13.0 + k, alarms=[OVERLOAD], restrict=[{"text": "slower", "restrict": True}]))
        tab.wait_for_selector(f'#time[data-value="{13 + k}"]')
    assert tab.evaluate("before === document.querySelector('#alarms li')")
    changed = tab.evaluate("changes")
    # Five lines with another time, another force that is measured and computed: each of them is a node or two.
    assert changed <= 5 * 3 * 2
    assert tab.evaluate("document.querySelectorAll('output').length") == 1, "each is read aloud as it changes"
    assert not wrong


@pytest.mark.parametrize("theme", ["light", "dark"])
def test_words_stand_out_from_what_is_behind_them_by_day_and_at_night(chromium, page, theme):
    context = chromium.new_context(color_scheme=theme)
    doubted = OVERLOAD | {"name": "slack", "known": False}
    tab, _, _ = opened(context, page)
    for k, health in enumerate(("good", "degraded", "lost")):
        page.publish(line(1.0 + k, health=health, causes=["a"], alarms=[OVERLOAD, doubted],
                          restrict=[{"text": "slower", "restrict": True}]))  # fmt: skip
        tab.wait_for_selector(f"#health[data-health={health}]")
        assert contrast(tab, "#health") >= 4.5, health
    places = [
        "#alarms .certain .cause", "#alarms .doubted .cause", "#limits .passed", ".measured", ".computed", ".label",
        ".hint", ".with", ".card .name", "#why li",
    ]  # fmt: skip
    assert {where: contrast(tab, where) for where in places if contrast(tab, where) < 4.5} == {}
    page.tell("no rows for 14 s")
    tab.wait_for_selector("#health[data-health=none]")
    assert contrast(tab, "#health") >= 4.5
    # Figures at an axis have the colour of a hint, and what their canvas does to it.
    tab.evaluate("for (const one of document.querySelectorAll('canvas')) one.style.color = 'var(--soft)'")
    places += ["#traces canvas", "#estimates canvas"]
    assert {where: contrast(tab, where) for where in places if contrast(tab, where) < 4.5} == {}
    context.close()


def test_nothing_is_wider_than_a_phone_and_no_number_is_broken(chromium, page):
    context = chromium.new_context(viewport={"width": 390, "height": 844}, has_touch=True, is_mobile=True)
    tab, _, wrong = opened(context, page)
    page.publish(line(DATE, alarms=[OVERLOAD | {"since": DATE}], rig={"state": "drilling", "added": 28.0}))
    tab.wait_for_selector("#alarms li")
    assert tab.evaluate("document.documentElement.scrollWidth") <= 390
    heights = tab.evaluate(
        "[...document.querySelectorAll('.pair, .since')].map((one) => one.getBoundingClientRect().height)"
    )
    assert len(heights) == 3 and max(heights) < 30.0
    # A finger that goes up and down over the picture scrolls the page.
    assert tab.evaluate("getComputedStyle(document.querySelector('#picture canvas')).touchAction") == "pan-y"
    context.close()
    assert not wrong


def test_the_picture_is_turned_and_zoomed_without_a_mouse(browser, page):
    page.publish(line(1.0))
    tab, _, wrong = opened(browser, page)
    tab.wait_for_selector(MASS)
    tab.evaluate("first = { around: 0, up: 0, zoom: 1 }; as_first()")
    view = "[view.around, view.up, view.zoom]"
    tab.keyboard.press("Tab")
    assert tab.evaluate("document.activeElement.tagName") == "CANVAS"
    tab.keyboard.press("ArrowLeft")
    tab.keyboard.press("ArrowDown")
    tab.keyboard.press("+")
    around, up, zoom = tab.evaluate(view)
    assert around > 0.0 and up > 0.0 and zoom > 1.0
    tab.locator('#picture button[value="-"]').click()
    assert tab.evaluate(view)[2] == pytest.approx(1.0)
    tab.locator('#picture button[value="Home"]').click()
    assert tab.evaluate(view) == [0, 0, 1]
    for button, sign in (("ArrowLeft", 1.0), ("ArrowRight", -1.0)):
        tab.locator(f'#picture button[value="{button}"]').click()
        assert sign * tab.evaluate(view)[0] > 0.0
        tab.locator('#picture button[value="Home"]').click()
    assert not wrong


def test_keys_and_buttons_before_the_first_picture_do_not_take_its_view_away(browser, page):
    page.publish(line(1.0))
    tab, _, wrong = opened(browser, page)
    tab.wait_for_selector(MASS)
    tab.locator("#picture canvas").focus()
    for key in ("ArrowLeft", "ArrowDown", "+", "Home"):
        tab.keyboard.press(key)
    for button in ("ArrowRight", "ArrowUp", "-"):
        tab.locator(f'#picture button[value="{button}"]').click()
    tab.evaluate("shape = { eye: [1, 1, 0] }; try { begin(); } finally { shape = null; }")
    assert tab.evaluate("[view.around, view.up, view.zoom]") == pytest.approx([0.25 * np.pi, 0.0, 1.0])
    assert not wrong


def test_two_fingers_zoom(browser, page):
    page.publish(line(1.0))
    tab, _, wrong = opened(browser, page)
    tab.wait_for_selector(MASS)
    tab.evaluate("first = { around: 0, up: 0, zoom: 1 }; as_first()")
    zoom = tab.evaluate(
        """() => { const canvas = document.querySelector("#picture canvas");
        canvas.setPointerCapture = () => {};
        const send = (kind, id, x) =>
          canvas.dispatchEvent(new PointerEvent(kind, { pointerId: id, clientX: x, clientY: 100 }));
        send("pointerdown", 1, 100); send("pointerdown", 2, 200); send("pointermove", 2, 300);
        send("pointercancel", 1, 100); send("pointerup", 2, 300); return view.zoom; }"""
    )
    assert zoom == pytest.approx(2.0) and not wrong


def test_an_estimate_that_begins_later_and_lacks_in_a_row_is_drawn(browser, page):
    page.publish(line(1.0, estimates={}))
    page.publish(line(2.0))
    page.publish(line(3.0, estimates={}))
    page.publish(line(4.0))
    tab, _, wrong = opened(browser, page)
    tab.wait_for_selector('#time[data-value="4"]')
    assert shown(tab, f"{MASS} .value") == 5000.0 and not wrong


# -- what those who come late get --------------------------------------------------------------------------------------


def test_who_comes_late_gets_the_last_picture_though_no_row_comes_any_more(page):
    page._drawn = {"shape": '{"number": 1}', "picture": '{"number": 1, "lines": []}'}
    page.publish(line(1.0))
    found = events(page.address, 4)
    assert found[2:] == [("shape", {"number": 1}), ("picture", {"number": 1, "lines": []})]


def test_a_line_that_comes_while_the_first_ones_are_sent_is_missed_by_nobody_and_comes_once(page):
    """The reader takes what is sent at first while more lines come; it has each of them once, in order."""
    for k in range(200):
        page.publish(line(float(k), filler="x" * 20_000))
    with urllib.request.urlopen(f"{page.address}/events", timeout=5.0) as stream:
        for k in range(200, 240):
            page.publish(line(float(k)))
        times = []
        while not times or times[-1] < 239.0:
            text = stream.readline().decode()
            if text.startswith("data: "):
                told = json.loads(text.removeprefix("data: "))
                times += [one["time"] for one in (told if isinstance(told, list) else [told]) if "time" in one]
    assert times == [float(k) for k in range(240)]


def test_lines_that_come_between_what_is_sent_first_and_the_rest_are_in_the_queue(page):
    """The same without a network: the generator that a browser reads stands between two of its events."""
    import asyncio

    page.publish(line(1.0))

    async def look():
        reader = page._events()
        first = [await anext(reader), await anext(reader)]
        page._take(json.dumps(told_of(line(2.0))))  # as the server's thread does with a line
        first.append(await anext(reader))
        await reader.aclose()
        return first

    made = asyncio.run_coroutine_threadsafe(look(), page._loop).result(5.0)
    assert ["event: about", "event: lines", "event: line"] == [one.splitlines()[0] for one in made]
    assert '"time": 2.0' in made[2]
