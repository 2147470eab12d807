"""From lumps and a wellbore to the groups of the lumped model: which physics a scene has, and its numbers."""

from __future__ import annotations

from typing import Any

import numpy as np

import tautline.lumped.string  # noqa: F401 - bodies, links and bends run together
from drillstring.groups.contact import SPRING, WallContact, nothing_kept
from drillstring.groups.drag import Drag
from drillstring.groups.friction import BANDED, PROJECTED, SLIP, STICK, Karnopp, Projection, Regularised
from drillstring.string.factors import factors_of
from drillstring.string.fluid import Fluid, mass_beside, weight_in
from drillstring.string.lumps import Lumps
from drillstring.well.wellbore import Wellbore
from tautline.lumped.bend import Bends, bend_slopes
from tautline.lumped.body import LUMP, Bodies, EccentricBodies
from tautline.lumped.curve import ARC, PER_BODY, SEAT, Curve
from tautline.lumped.link import SPRING as STRING_SPRING
from tautline.lumped.link import Links, link_slopes
from tautline.system.records import records


def curve_of(well: Wellbore, measured_depth: np.ndarray) -> Curve:
    """The wellbore as the kernels read it, with the straight piece above the rotary table as its first arc."""
    arcs = records(well.k1.size + 1, ARC)
    table = dict(start=well.md, k1=well.k1, k2=well.k2, turn1=well.phi1, turn2=well.phi2, depth=well.positions[:, 2])
    table |= dict(g1=well.m1s[:, 2], g2=well.m2s[:, 2], g3=well.tangents[:, 2])
    for name, values in table.items():
        arcs[name][1:] = values[: well.k1.size]
    for name in ("g1", "g2", "g3"):
        arcs[name][0] = arcs[name][1]
    seats = records(measured_depth.size, SEAT, place=measured_depth)
    return Curve(arcs, seats, np.array([0, PER_BODY * seats.size]))


def buoyed_weight(lumps: Lumps, fluid: Fluid, gravity: float) -> np.ndarray:
    """Weight of each lump in the mud, N."""
    return lumps.of_lumps(lambda tube: weight_in(fluid, tube, gravity))


def lateral_mass(lumps: Lumps, fluid: Fluid, hole_diameter: float) -> np.ndarray:
    """Mass that follows lateral motion beside the steel, kg: added mass of the mud outside, and the mud inside."""
    return lumps.of_lumps(lambda tube: mass_beside(fluid, tube, hole_diameter))


def bodies_of(
    lumps: Lumps, curve: Curve, weight: np.ndarray, lateral: np.ndarray, damping: Any, scaled: np.ndarray
) -> Bodies | EccentricBodies:
    """Group of all lumps; eccentric only where a section says so.

    The transverse inertia is that of the cross-section alone: every metre of pipe moves along its own tangent of the
    arc, so the lump's m s'^2 / 2 is the whole kinetic energy and a rod's m l^2 / 12 would count it twice.
    """
    mass = lumps.of_lumps(lambda tube: tube.mass_per_length)
    polar = lumps.of_lumps(lambda tube: tube.rotary_inertia)
    e1, e2 = (lumps.of_lumps(lambda tube, k=k: tube.mass_per_length * tube.eccentricity[k]) / mass for k in (0, 1))
    rows = records(
        mass.size, LUMP, mass=mass, polar=polar, transverse=0.5 * polar, lateral_mass=lateral, weight=weight,
        e1=e1, e2=e2,
        damping_along=damping.translation * scaled + damping.mass_proportional * mass,
        damping_across=damping.translation * scaled + damping.mass_proportional * (mass + lateral),
        damping_about=damping.rotation * scaled + damping.mass_proportional * polar,
    )  # fmt: skip
    kind = EccentricBodies if np.any(e1) or np.any(e2) else Bodies
    return kind(curve, rows, np.zeros((3, 4, 4)))


def links_of(lumps: Lumps, curve: Curve, structural_damping: float) -> Links:
    """Group of all axial and torsional springs."""
    springs = records(
        lumps.length.size,
        STRING_SPRING,
        length=lumps.length,
        axial=lumps.of_links(lambda tube: tube.youngs_modulus * tube.area) / lumps.length,
        torsional=lumps.of_links(lambda tube: tube.torsional_stiffness) / lumps.length,
    )
    return Links(curve, springs, float(structural_damping), link_slopes(), np.zeros((3, 6, 6)))


def bends_of(lumps: Lumps, curve: Curve, stiff: bool) -> Bends:
    """Group of all bends: EI of two links in series, weighted by their lengths, over their mean length."""
    rigidity = lumps.of_links(lambda tube: tube.youngs_modulus * tube.second_moment)
    a, b = lumps.length[:-1], lumps.length[1:]
    series = (a + b) / (a / rigidity[:-1] + b / rigidity[1:])
    return Bends(
        curve=curve,
        length=lumps.length,
        stiffness=series / (0.5 * (a + b)),
        stiff=1.0 if stiff else 0.0,
        slopes=bend_slopes(),
        scratch=np.zeros((9, 9)),
    )


def drag_of(lumps: Lumps, curve: Curve, fluid: Fluid) -> Drag:
    """Group of lateral drag."""
    return Drag(curve, 0.5 * fluid.density * fluid.drag * lumps.of_lumps(lambda tube: tube.od))


def contact_of(
    lumps: Lumps,
    curve: Curve,
    links: Links,
    lateral: np.ndarray,
    hole_diameter: float,
    wall: Any,
    contact_rotation: float,
    law: str,
    moving: bool,
) -> WallContact:
    """Group of wall contacts of every lump below the top drive.

    The wall's stiffness and damping are given for the largest tube in ``wall.lumps`` lumps; they scale with a lump's
    diameter and tributary length, so that results do not depend on the number of lumps.
    """
    below = slice(1, None)
    od = lumps.largest(lambda tube: tube.od)
    contact_od = lumps.largest(lambda tube: tube.contact_od)
    share = lumps.tributary / (lumps.total / wall.lumps)
    scale = (od / od.max() * share)[below]
    n = scale.size
    mass = lumps.of_lumps(lambda tube: tube.mass_per_length)
    polar = lumps.of_lumps(lambda tube: tube.rotary_inertia)
    radius = 0.5 * contact_od[below]
    stiffness = np.append(links.springs.axial, 0.0) + np.append(0.0, links.springs.axial)
    return WallContact(
        curve=curve,
        law=law_of(
            wall, law, *(end[below] for end in lumps.reach), mass[below], stiffness[below],
            1.0 / (1.0 / (mass + lateral)[below] + radius**2 / polar[below]), moving,
        ),
        springs=records(
            n, SPRING, body=np.arange(1, n + 1), stiffness=wall.stiffness * scale, damping=wall.damping * scale,
            clearance=0.5 * (hole_diameter - contact_od[below]), radius=radius, viscous=contact_rotation * share[below],
        ),
        scratch=np.zeros((2, 4, 4)),
        kept=nothing_kept(n),
    )  # fmt: skip


def law_of(
    wall: Any,
    law: str,
    top: np.ndarray,
    bottom: np.ndarray,
    along: np.ndarray,
    stiffness: np.ndarray,
    around: np.ndarray,
    moving: bool,
) -> Projection | Karnopp | Regularised:
    """The law of friction of n contacts; ``moving`` says that the string starts in motion, hence slipping.

    A contact has the mean factor of its piece of the hole from ``top`` (n,) to ``bottom`` (n,) m, and keeps it.
    """
    n, friction = top.size, wall.friction
    static, kinetic = (factors_of(wall, kind).over(top, bottom) for kind in ("static", "kinetic"))
    if law == "projection":
        settled = SLIP if moving else STICK
        return Projection(
            records(
                n,
                PROJECTED,
                static=static,
                kinetic=kinetic,
                mass=along,
                mass_c=around,
                links=stiffness,
                settled=settled,
                c=1.0,
            )
        )
    if law == "karnopp":
        rows = records(n, BANDED, static=static, kinetic=kinetic, mass_a=along, mass_c=around)
        return Karnopp(rows, float(friction.slip_velocity))
    return Regularised(static, kinetic, float(friction.slip_velocity), float(friction.decay_velocity))
