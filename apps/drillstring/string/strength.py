"""Tension that is compared with a string's strength: at rest without friction, and at the ends of elements."""

from __future__ import annotations

from itertools import pairwise

import numpy as np

from drillstring.scene.scene import DrillstringScene
from drillstring.string.fluid import fluid_of, weight_in
from drillstring.string.lumps import Lumps
from drillstring.well.wellbore import Wellbore


def tension_at_rest(scene: DrillstringScene, well: Wellbore, lumps: Lumps) -> np.ndarray:
    """Effective tension at the upper end of each section without friction, (sections,) N; see `tension_at`."""
    return tension_at(scene, well, lumps, _ends(lumps)[:-1])


def tension_at(scene: DrillstringScene, well: Wellbore, lumps: Lumps, place: np.ndarray) -> np.ndarray:
    """Effective tension of a string at rest without friction at measured depths m of it, (n,) N each.

    A frictionless wall does no work along the hole, so from the bit's force on the tension grows by the buoyed weight
    of a metre for every metre of *vertical* depth, whatever the hole's course (C. A. Johancsik et al., 1984).
    """
    fluid, ends = fluid_of(scene.mud), _ends(lumps)
    weight = np.array([weight_in(fluid, tube, scene.gravity) for tube in lumps.tubes])
    below = np.append(np.cumsum((weight * np.diff(well.tvd(ends)))[::-1])[::-1], 0.0)[1:] + scene.bit.load
    section = np.clip(np.searchsorted(ends, place, side="right") - 1, 0, weight.size - 1)
    return below[section] + weight[section] * (well.tvd(ends[1:])[section] - well.tvd(place))


def largest_at_rest(scene: DrillstringScene, well: Wellbore, lumps: Lumps) -> tuple[np.ndarray, np.ndarray]:
    """Largest effective tension of each section at rest, (sections,) N, and measured depths (sections,) m of them.

    It is at an end of the section, or in it where the hole is level: in a hole that climbs, where it is highest.
    """
    ends, level = _ends(lumps), well.level()
    found = []
    for upper, lower in pairwise(ends.tolist()):
        # At its lower end a section is that end's limit from above, where another one begins.
        inside = np.nextafter(lower, upper)
        places = np.concatenate([[upper], level[(level > upper) & (level < lower)], [inside]])
        tension = tension_at(scene, well, lumps, places)
        most = int(np.argmax(tension))
        found.append((tension[most], places[most]))
    tension, place = np.array(found).T
    return tension, place


def _ends(lumps: Lumps) -> np.ndarray:
    """Measured depths of the ends of sections, (sections + 1,) m, of a string at the rotary table."""
    return np.cumsum([0.0] + [tube.length for tube in lumps.tubes])


def extreme_tension(
    scene: DrillstringScene, lumps: Lumps, hook_load: np.ndarray, tension: np.ndarray, least: bool = False
) -> np.ndarray:
    """Largest effective tension in each link or element, which is at one of its ends, or the least one.

    A model has the tension in the middle of a link, T_i. Forces balance on the piece of string between two middles:
    T_(i-1) - T_i is all that acts on it along the hole, of weight, friction and inertia. That is spread over the piece
    as its buoyed weight, so that with half links of the weights W_(i-1) and W_i

        tension at lump i = T_i + (T_(i-1) - T_i) W_i / (W_(i-1) + W_i).

    The upper end of the first link has the hook load; the lower end of the last one is as far below its middle as its
    upper end is above. Of a hanging string at rest all this is exact for any number of links. The middle counts too:
    in waves of tension it may have more than both ends.

    Parameters
    ----------
    scene : DrillstringScene
    lumps : Lumps
        Its mesh of n links or elements.
    hook_load : (...) array
        N.
    tension : (..., n) array
        In the middles of the links, or means of the elements of a beam, N.
    least : bool
        Whether the least is asked for.

    Returns
    -------
    (..., n) array
        N.
    """
    return tension_at_ends(shares_at_ends(scene, lumps), hook_load, tension, least)


def shares_at_ends(scene: DrillstringScene, lumps: Lumps) -> np.ndarray:
    """W_i / (W_(i-1) + W_i) of `extreme_tension` at the lumps between two links, (n - 1,)."""
    fluid = fluid_of(scene.mud)
    weight = lumps.of_links(lambda tube: weight_in(fluid, tube, scene.gravity)) * lumps.length
    if weight.min() <= 0.0:
        # Nothing weighs, or something floats: what acts is spread as the length is.
        weight = lumps.length
    return weight[1:] / (weight[:-1] + weight[1:])


def tension_at_ends(share: np.ndarray, hook_load: np.ndarray, tension: np.ndarray, least: bool = False) -> np.ndarray:
    """What `extreme_tension` gives, from the shares that `shares_at_ends` has found."""
    upper, lower = ends_of_links(share, hook_load, tension)
    extreme = np.minimum if least else np.maximum
    return extreme(extreme(upper, lower), np.asarray(tension, float))


def ends_of_links(share: np.ndarray, hook_load: np.ndarray, tension: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Effective tension at the upper and at the lower end of each link or element, (..., n) N each.

    ``share`` is what `shares_at_ends` has found; the other arguments, and the source, are those of `extreme_tension`.
    """
    tension = np.asarray(tension, float)
    inside = tension[..., 1:] + share * (tension[..., :-1] - tension[..., 1:])
    upper = np.concatenate([np.asarray(hook_load, float)[..., None], inside], axis=-1)
    return upper, np.concatenate([inside, 2.0 * tension[..., -1:] - upper[..., -1:]], axis=-1)
