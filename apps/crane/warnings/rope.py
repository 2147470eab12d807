"""What to tell of a rope whose numbers do not go together: a slip of a unit, more often than not.

Stiffness, strength and mass of ropes go over twelve powers of ten. Over the area of the rope's circle they do not.
"""

from __future__ import annotations

import math
from collections.abc import Iterator

from crane.scene.scene import CraneScene
from tautline.scene.doubts import meant, units_that_fit
from tautline.scene.values.ranges import RANGES, in_range, sized

RELATIONS = (
    ("axial_stiffness", "axial stiffness", "modulus of the rope", "EA"),
    ("breaking_load", "breaking load", "strength of the rope", "the load"),
    ("mass_per_length", "mass per length", "density of the rope", "the mass"),
)
"""Key, its row in the table of ranges, the row of it over the area, and what it is called."""


def rope_warnings(scene: CraneScene) -> Iterator[tuple[str, str]]:
    """Key and text of the numbers of a rope that are implausible for its diameter; none where that is not given."""
    rope = scene.rope
    if rope.diameter is None:
        return
    area = 0.25 * math.pi * rope.diameter**2
    for key, name, over, what in RELATIONS:
        value, row = getattr(rope, key), RANGES[over]
        if value is None or row.holds(value / area):
            continue
        written = None if scene.document is None else scene.document.written(("rope", key))
        own = RANGES[name]
        options = units_that_fit(written or "", own.unit, own, False, lambda x, row=row: row.holds(x / area))
        text = (
            f"{sized(value, own.unit)} does not go with a diameter of {1e3 * rope.diameter:.4g} mm: {what} over the "
            f"area of its circle is {sized(value / area, row.unit)}, and {in_range(row)} is plausible. "
            f"{meant(written or '', options, own.unit)}. Or see whether rope.diameter is what was meant"
        )
        yield f"rope.{key}", text
