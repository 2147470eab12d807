"""Makes the folders of tests importable: `references.soft_string`, `physics.strings`."""

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parent))
