"""The lowest version of every package that pyproject.toml allows, as pins for `pip install -r`.

Read from its `>=` floors, so that there is no second list: `python .ci/lowest.py > lowest.txt`. With a word, as in
`python .ci/lowest.py build`, those of the build itself. `python .ci/lowest.py extra docs` prints an extra as it stands.
"""

import re
import sys
import tomllib
from pathlib import Path

FLOOR = re.compile(r"^(?P<name>[A-Za-z0-9._-]+)\s*>=\s*(?P<version>[0-9][0-9A-Za-z.]*)")


def pins(requirements: list[str]) -> list[str]:
    """`name==floor` of each requirement; one without a floor is an error, for it says that any version will do."""
    found = []
    for requirement in requirements:
        floor = FLOOR.match(requirement)
        if floor is None:
            raise SystemExit(f"pyproject.toml: {requirement!r} has no floor: write `name>=version`")
        found.append(f"{floor['name']}=={floor['version']}")
    return found


if __name__ == "__main__":
    project = tomllib.loads((Path(__file__).parents[1] / "pyproject.toml").read_text(encoding="utf-8"))
    if sys.argv[1:2] == ["extra"]:
        print("\n".join(project["project"]["optional-dependencies"][sys.argv[2]]))
        sys.exit()
    build = sys.argv[1:] == ["build"]
    print("\n".join(pins(project["build-system"]["requires"] if build else project["project"]["dependencies"])))
