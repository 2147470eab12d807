"""Whether a built site holds together: `python .ci/site.py site`.

Every link and picture leads to a file of the site, and to a place in it that there is. No page loads anything from a
network. The reference says of every key what it means. Where Chromium and Playwright are installed every page
with equations is opened from the folder, and each equation must be typeset; the search must find something. Links to
other sites are not followed: there is no network.
"""

from __future__ import annotations

import re
import shutil
import sys
from html.parser import HTMLParser
from pathlib import Path
from urllib.parse import unquote, urlsplit

LOADED = {"script": "src", "img": "src", "link": "href", "iframe": "src", "source": "src", "video": "src"}
"""Tags that load what they name, and the attribute that does; a link to a canonical address loads nothing."""

UNTYPESET = """async () => {
  const left = () => [...document.querySelectorAll('.arithmatex')].filter(
    one => !one.querySelector('.katex') || one.querySelector('.katex-error')).length
  for (let waited = 0; left() && waited < 100; waited += 1) await new Promise(done => setTimeout(done, 100))
  return left()
}"""
"""Number of equations of a page that are not typeset, ten seconds after it was opened at the latest."""


class Page(HTMLParser):
    """Places that a page has, what it links to and what it loads."""

    def __init__(self, path: Path) -> None:
        super().__init__(convert_charrefs=True)
        self.places: set[str] = set()
        self.links: list[str] = []
        self.loads: list[str] = []
        self.equations = False
        self.feed(path.read_text(encoding="utf8"))

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        """Note what a tag names, links to and loads."""
        of = {name: value or "" for name, value in attrs}
        self.places |= {of[name] for name in ("id", "name") if name in of}
        self.equations |= "arithmatex" in of.get("class", "").split()
        if tag == "a" and "href" in of:
            self.links.append(of["href"])
        elif tag in LOADED and of.get(LOADED[tag]) and of.get("rel") not in ("canonical", "next", "prev"):
            self.loads.append(of[LOADED[tag]])


def faults(site: Path, pages: dict[Path, Page]) -> list[str]:
    """What is wrong with links and with what is loaded."""
    found = []
    for path, page in pages.items():
        here = path.relative_to(site)
        for address in (*page.links, *page.loads):
            parts = urlsplit(address)
            if parts.scheme in ("http", "https") or parts.netloc:
                if address in page.loads:
                    found.append(f"{here}: loads {address} from a network")
                continue
            if parts.scheme:
                continue
            target = (path.parent / unquote(parts.path)).resolve() if parts.path else path
            if target.is_dir():
                target /= "index.html"
            if not target.is_file():
                found.append(f"{here}: leads to {address}, which is not there")
            elif parts.fragment and target in pages and unquote(parts.fragment) not in pages[target].places:
                found.append(f"{here}: leads to {address}, and there is no such place")
    return found


def unexplained(site: Path) -> list[str]:
    """Keys of scenes of which the reference does not say what they mean."""
    row = re.compile(r"<tr>\s*<td><code>(.*?)</code></td>(?:\s*<td>.*?</td>){2}\s*<td>(.*?)</td>\s*</tr>", re.S)
    return [
        f"{path.name}: nothing is said of the key {key}"
        for path in sorted(site.glob("reference/keys_*.html"))
        for key, meaning in row.findall(path.read_text(encoding="utf8"))
        if not meaning.strip()
    ]


def seen(site: Path, pages: dict[Path, Page]) -> list[str]:
    """What a browser finds wrong when pages are opened from the folder."""
    from playwright.sync_api import sync_playwright

    found: list[str] = []
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=shutil.which("chromium"), args=["--no-sandbox"])
        page = browser.new_page()
        page.on("request", lambda asked: asked.url.startswith("http") and found.append(f"{page.url}: asks {asked.url}"))
        page.on("pageerror", lambda error: found.append(f"{page.url}: {error}"))
        for path in sorted(one for one, of in pages.items() if of.equations):
            page.goto(path.as_uri())
            plain = page.evaluate(UNTYPESET)
            if plain:
                found.append(f"{path.name}: {plain} equations are not typeset")
            if page.evaluate("/\\$[^$]*\\\\[a-z]+[^$]*/.test(document.querySelector('article').innerText)"):
                found.append(f"{path.name}: an equation was left as text")
        page.goto((site / "index.html").as_uri())
        # By keys, as a reader does: the search listens to them. Text put in at once is found only where the page
        # looks at the field between its being entered and filled, which a busy machine does not always do.
        page.locator("input.md-search__input").press_sequentially("capstan")
        page.wait_for_selector(".md-search-result__item", timeout=60000)
        browser.close()
    return found


def main() -> None:
    """Check a site and leave with 1 where it has faults."""
    site = Path(sys.argv[1]).resolve()
    pages = {path: Page(path) for path in site.rglob("*.html") if path.name != "404.html"}
    found = faults(site, pages) + unexplained(site)
    told = f"{len(pages)} pages, {sum(len(page.links) for page in pages.values())} links"
    if shutil.which("chromium"):
        found += seen(site, pages)
        told += f", {sum(page.equations for page in pages.values())} pages with equations seen in a browser"
    print("\n".join(found), file=sys.stderr)
    if found or not pages:
        sys.exit(f"the site does not hold together: {len(found)} faults")
    print(f"the site holds together: {told}")


if __name__ == "__main__":
    main()
