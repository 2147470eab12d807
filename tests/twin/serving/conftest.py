"""A page that is served, and a browser."""

import shutil

import pytest
from twin.serving.lookers import UNITS

from crane.application import Crane

CHROMIUM = shutil.which("chromium") or shutil.which("chromium-browser") or shutil.which("google-chrome")


@pytest.fixture
def page():
    from tautline.twin.page.server import Page

    made = Page(0, "a hoist", UNITS, Crane())
    yield made
    made.close()


@pytest.fixture(scope="module")
def chromium():
    """Started once: that takes longer than most of what is asked of it."""
    if CHROMIUM is None:
        pytest.skip("there is no Chromium")
    sync_api = pytest.importorskip("playwright.sync_api")
    with sync_api.sync_playwright() as playwright:
        made = playwright.chromium.launch(executable_path=CHROMIUM, args=["--no-sandbox"])
        yield made
        made.close()


@pytest.fixture(scope="module")
def profile(chromium):
    """A window with one tab: to make one for a page, and its process, takes several times as long as to open the page.

    Each page has a port of its own: what a browser keeps for one it does not show to another.
    """
    made = chromium.new_context(viewport={"width": 1280, "height": 720})
    made.new_page()
    yield made
    made.close()


@pytest.fixture
def browser(profile):
    """A window with one empty tab."""
    yield profile
    first, *others = profile.pages
    first.goto("about:blank")
    for tab in others:
        tab.close()
