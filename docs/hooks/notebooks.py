"""Tutorials are notebooks. Each becomes a page as it was last run, with its figures."""

from __future__ import annotations

import re
from base64 import b64decode
from pathlib import Path

from mkdocs.structure.files import File


def on_files(files, config):
    """Add the page and the figures of every notebook in docs/tutorials."""
    import nbformat

    for path in sorted((Path(config.docs_dir) / "tutorials").glob("*.ipynb")):
        pieces = []
        for cell in nbformat.read(path, as_version=4).cells:
            if cell.cell_type == "markdown":
                pieces.append(cell.source)
                continue
            pieces.append(f"```python\n{cell.source}\n```")
            for output in cell.outputs:
                data = output.get("data", {})
                if "image/png" in data:
                    name = f"tutorials/{path.stem}/figure_{len(pieces)}.png"
                    files.append(File.generated(config, name, content=b64decode(data["image/png"])))
                    pieces.append(f"![What the cell above draws]({path.stem}/{Path(name).name})")
                elif text := output.get("text", data.get("text/plain", "")).rstrip():
                    pieces.append(f"```text\n{text}\n```")
        pieces.append(f"[This page as a notebook]({path.name}), to run and to change.")
        files.append(File.generated(config, f"tutorials/{path.stem}.md", content="\n\n".join(pieces) + "\n"))
    return files


def on_page_markdown(markdown, page, config, files):
    """Lead to the pages of tutorials: links name the notebooks, which are what the repository has."""
    pages = {path.stem for path in (Path(config.docs_dir) / "tutorials").glob("*.ipynb")}
    pages -= {Path(page.file.src_uri).stem}  # a page links to its own notebook

    def to_page(link):
        return f"({link[1]}{link[2]}.md)" if link[2] in pages else link[0]

    return re.sub(r"\(((?:\.\./|tutorials/)*)(\w+)\.ipynb\)", to_page, markdown)
