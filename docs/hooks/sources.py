"""Links of a page that leave docs/ lead to a page of the site that shows the file.

A link such as `../../core/tautline/elements/tension.py` works where the repository is browsed. In the site it leads to
a page with that file, so that the site is whole without network. A link to what is no file is reported as missing.
"""

from __future__ import annotations

import posixpath
import re
from pathlib import Path

from mkdocs.structure.files import File, InclusionLevel

LINK = re.compile(r"\]\((?P<way>(?:\.\./)+[^)#\s]+)(?P<place>#[^)\s]*)?\)")
BARE = re.compile(r"\[(?:docs/)?[\w/]+\.md\]\(([\w/.]+\.md)")
"""A link whose text is the name of a page's file: in the site it has the page's title."""
SPOKEN = {".py": "python", ".yaml": "yaml", ".yml": "yaml", ".toml": "toml", ".cff": "yaml", ".sh": "bash"}
WHOLE = {"README.md": "index.md", "CHANGELOG.md": "changelog.md", "CONTRIBUTING.md": "contributing.md"}
"""Files of the repository's folder that have a page of their own."""


def on_files(files, config):
    """Add a page for every file outside of docs/ that a page links to."""
    docs = Path(config.docs_dir)
    root = docs.parent
    for name, page in (("CHANGELOG.md", "changelog.md"), ("CONTRIBUTING.md", "contributing.md")):
        files.append(File.generated(config, page, content=_from_root((root / name).read_text(encoding="utf8"))))
    wanted = set()
    for file in list(files.documentation_pages()):
        for link in LINK.finditer(file.content_string):
            outside = _outside(file.src_uri, link["way"])
            if outside is not None and (root / outside).is_file() and outside not in WHOLE:
                wanted.add(outside)
    for outside in sorted(wanted):
        page = File.generated(config, _page(outside), content=_shown(root / outside, outside))
        page.inclusion = InclusionLevel.NOT_IN_NAV
        files.append(page)
    return files


def on_page_markdown(markdown, page, config, files):
    """Turn links that leave docs/ into links to the pages added above."""

    def to_page(link):
        outside = _outside(page.file.src_uri, link["way"])
        if outside is None:
            return link[0]
        target = WHOLE.get(outside, _page(outside))
        if outside not in WHOLE and files.get_file_from_path(target) is None:
            return link[0]
        here = posixpath.dirname(page.file.src_uri) or "."
        place = (link["place"] or "").replace("#L", "#__span-0-")
        return f"]({posixpath.relpath(target, here)}{place})"

    def to_title(named):
        file = files.get_file_from_path(posixpath.join(posixpath.dirname(page.file.src_uri), named[1]))
        title = file.page.title if file is not None and file.page is not None else None
        return f"[{title}]({named[1]}" if title else named[0]

    return BARE.sub(to_title, LINK.sub(to_page, markdown))


def _outside(page: str, way: str) -> str | None:
    """Path from the repository's folder of what a link leads to; None where it stays in docs/."""
    path = posixpath.normpath(posixpath.join("docs", posixpath.dirname(page), way))
    return None if path.startswith(("docs/", "..")) else path


def _page(outside: str) -> str:
    return f"source/{outside}" if outside.endswith(".md") else f"source/{outside}.md"


def _shown(path: Path, outside: str) -> str:
    text = path.read_text(encoding="utf8")
    if path.suffix == ".md":
        return text
    title = f"---\ntitle: {path.name}\nsearch: {{exclude: true}}\n---\n\n# `{outside}`\n\n"
    return f'{title}````{SPOKEN.get(path.suffix, "text")} linenums="1"\n{text.rstrip()}\n````\n'


def _from_root(text: str) -> str:
    """Links of a page of the repository's folder, as seen from docs/."""
    moved = re.sub(r"\]\((?!\w+:|#|/|docs/)([^)]+)\)", r"](../\1)", text)
    return moved.replace("](docs/", "](")
