"""Bodies, links and bends of a string, gone through together.

Each by itself reads the coordinates of bodies and the arcs that they are held to, finds chords between them, and adds
its forces; together they do so once, and the length of a link is found once for its stretch and its direction.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from tautline.kernels.groups import register, register_joint
from tautline.kernels.jit import kernel
from tautline.kernels.lanes import LANES, add_rows, gather, load_rows, where, within
from tautline.lumped import generated
from tautline.lumped.bend import SPAN, Bends, forces_of_four, turned_of_four
from tautline.lumped.body import Bodies, EccentricBodies, on_bodies
from tautline.lumped.chain import chord_between
from tautline.lumped.curve import held_arcs, members
from tautline.lumped.link import Links, by_bodies, pull_of_four


class String(NamedTuple):
    """Bodies (n,), the links (n - 1,) between them, and the bends (n - 2,) between links, on one curve."""

    bodies: Bodies | EccentricBodies
    links: Links
    bends: Bends


def string(bodies: Bodies | EccentricBodies, links: Links, bends: Bends) -> String | None:
    """All three together; None where they are not of one string."""
    count = bodies.lumps.size
    if links.springs.size != count - 1 or bends.stiffness.size != count - 2 or count < SPAN:
        return None
    if not bodies.curve.seats is links.curve.seats is bends.curve.seats:
        return None
    return String(bodies, links, bends) if np.array_equal(links.springs.length, bends.length) else None


@kernel
def _residual(g, t, q, v, a, r):
    curve, count = g.bodies.curve, g.bodies.lumps.size
    first, last = members(curve, SPAN, count)
    links, bends = min(count - 1, last), min(count - 2, last)
    for i in range(first, last, LANES):
        one, arc1 = load_rows(q, i, count), held_arcs(curve, i, count)
        on_x, on_u, on_v, about = on_bodies(
            g.bodies, i, count, arc1, one, load_rows(v, i, count), load_rows(a, i, count)
        )
        if i < links:
            two, three = load_rows(q, i + 1, count), load_rows(q, i + 2, count)
            arc2, arc3 = held_arcs(curve, i + 1, count), held_arcs(curve, i + 2, count)
            a1, above = chord_between(one, arc1, two, arc2)
            a2, below = chord_between(two, arc2, three, arc3)
            stretch, d, bent = generated.link_and_bend_gradient(
                gather(g.bends.length, i, links), a1, two[1] - one[1], two[2] - one[2],
                gather(g.bends.length, i + 1, count - 1) + a2, three[1] - two[1], three[2] - two[2],
                *turned_of_four(g.bends.stiff, one, arc1, three, arc3),
            )  # fmt: skip
            d = by_bodies(d, above)
            tension, torque = pull_of_four(g.links, i, links, v, stretch, d, two[3] - one[3])
            # Below the last body there is no link, and no bend below the last link.
            tension, torque = where(within(i, links), tension, 0.0), where(within(i, links), torque, 0.0)
            f = where(within(i, bends), gather(g.bends.stiffness, i, count - 2), 0.0)
            on1, on2, on3 = forces_of_four(f, bent, above, below, g.bends.stiff, arc1, arc3)
            add_rows(
                r, i + 1, links + 1, on2[0] + tension * d[3], on2[1] + tension * d[4], on2[2] + tension * d[5], torque
            )
            add_rows(r, i + 2, links + 1, *on3, 0.0)
            on_x, on_u, on_v = (
                on_x + on1[0] + tension * d[0],
                on_u + on1[1] + tension * d[1],
                on_v + on1[2] + tension * d[2],
            )
            about = about - torque
        add_rows(r, i, last, on_x, on_u, on_v, about)


register(String, residual=_residual)
register_joint((Bodies, Links, Bends), string)
register_joint((EccentricBodies, Links, Bends), string)
