"""Who looks at the page of a twin: readers of its events, and tabs of a browser."""

import json
import urllib.request

UNITS = {"winch.tension": "N", "winch.pay_out": "m"}


def line(at, mass=5000.0, **more):
    """A line as a twin tells it."""
    return {
        "time": at, "inputs": {"winch.pay_out": -0.5}, "measured": {"winch.tension": 49050.0 + at},
        "outputs": {"winch.tension": 49000.0 + at, "payload.position": [12.4, 0.0, -7.25]}, "deviations": {},
        "estimates": {"payload.mass": {"value": mass, "sd": 12.5, "unit": "kg"}}, "residuals": {"winch.tension": 50.0},
        "alarms": [], "restrict": [], "not_observable": [], "lag": 0.25, "health": "good", **more,
    }  # fmt: skip


def told_of(one):
    """What a browser gets of a line without alarms: with its stamp in words, as the command prints those of no date."""
    return one | {"stamp": f"{one['time']:.1f} s"}


def events(address, count, timeout=5.0):
    """The first events that a reader gets: (kind, content)."""
    found, kind = [], ""
    with urllib.request.urlopen(f"{address}/events", timeout=timeout) as stream:
        for raw in stream:
            text = raw.decode().rstrip("\n")
            if text.startswith("event: "):
                kind = text.removeprefix("event: ")
            elif text.startswith("data: "):
                found.append((kind, json.loads(text.removeprefix("data: "))))
                if len(found) == count:
                    return found
    return found


def opened(browser, page, before=""):
    """The page in a browser, with what it asked for and what went wrong; with a script first in a tab of its own."""
    tab = browser.pages[0] if browser.pages and not before else browser.new_page()
    if before:
        tab.add_init_script(before)
    asked, wrong = [], []
    tab.on("request", lambda request: asked.append(request.url))
    tab.on("pageerror", lambda error: wrong.append(str(error)))
    tab.on("console", lambda message: wrong.append(message.text) if message.type == "error" else None)
    tab.goto(page.address, wait_until="domcontentloaded")
    return tab, asked, wrong


def shown(tab, where):
    return float(tab.locator(where).get_attribute("data-value"))
