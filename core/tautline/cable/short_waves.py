"""How a mesh makes short waves grow where material runs through taut elements faster than waves along them.

A wave w across a straight rope obeys m (d/dt - u d/dp)^2 w = T w'' - EJ w'''', with T = N/|r'| and c^2 = T/m.
Elements make of it M a - 2 u C v + (T K - m u^2 E) w + EJ B w. Three Gauss points integrate all of it exactly, and
yet it is not stable beyond c: the square of the discrete derivative M^-1 C is not -M^-1 E. For waves as short as an
element C is nearly zero, so that nothing turns them against the negative stiffness T - m u^2. Bloch waves on an
endless chain of equal elements grow by

    linear (nodes by turns up and down)             sqrt(12 (u^2 - c^2)) / L
    cubic, Gauss (all slopes alike, no node moves)  sqrt(42 (u^2 - c^2 - 60 EJ/(m L^2))) / L
    cubic, Lobatto                                  sqrt(42 (u^2 - 5/2 c^2 - 60 EJ/(m L^2))) / L

at most, as three Lobatto points find 5/2 times the energy in that wave. Between c and 1.58 c waves of two elements
and longer grow with them all the same, by `WEAK` c / L. Of the true rope's waves none grows at any speed.
"""

from __future__ import annotations

from collections.abc import Container, Iterable, Iterator
from typing import Any, NamedTuple

import numpy as np

from tautline.cable.input.material import SHORTEST
from tautline.cable.input.parts import CableScene, Element

TOLD = 1.0e4
"""By how much a short wave grows in a run before that is told."""
SLACK = 1.0e-6
"""Strain up to which an element counts as slack, another matter: positions are written with about as many digits."""
LINEAR, CUBIC = 12.0, 42.0
BENDING = 60.0
STIFFER = 2.5
"""Energy of the shortest wave of cubic elements by three Lobatto points over that by exact integration."""
WEAK = (
    (1.0, 1.01, 1.03, 1.05, 1.07, 1.1, 1.15, 1.2, 1.3, 1.4, 1.5, 1.575),
    (0.0, 0.104, 0.162, 0.184, 0.183, 0.162, 0.132, 0.108, 0.069, 0.039, 0.016, 0.0),
)
"""Of Lobatto points without bending: u/c, and the growth of the fastest wave times L/c."""
NEEDED = ("material_velocity", "axial_force", "end_force", "position", "material_coordinate")


class Curve(NamedTuple):
    """Elements between the same two nodes, which move as one: their places in the scene, and their sums.

    ``mass`` is in kg/m, ``bending`` in N m^2, ``stiffness`` in N; ``acts`` is weight and load, N/m.
    """

    places: tuple[int, ...]
    element: Element
    mass: float
    bending: float
    stiffness: float
    acts: float

    def slack(self, length: Any) -> Any:
        """Tension, N, up to which lengths of it, m, hang in a bow or fold: they carry no waves of a string."""
        return np.maximum(self.acts * length, SLACK * self.stiffness)


class Overtaken(NamedTuple):
    """The curve whose short waves grow most: when, s, at which speeds, m/s, how far, and how many more are told of."""

    curve: Curve
    begin: float
    end: float
    speed: float
    wave: float
    tension: float
    length: float
    grown: float
    more: int


def curves_of(scene: CableScene, between: Container[int]) -> list[Curve]:
    """Curves with mass on which a wave may run: those with a node or a slope that is not held throughout.

    Only those with both ends among the nodes ``between``.
    """
    alike: dict[tuple[int, ...], list[int]] = {}
    for k, element in enumerate(scene.elements) if between else ():
        if element.nodes[0] in between and element.nodes[1] in between and element.conveyed is None:
            alike.setdefault(element.nodes, []).append(k)
    ends = {node for nodes in alike for node in nodes}
    fixed = {node.id for node in scene.nodes if node.id in ends and all(node.held[:-1])} if ends else set()
    gravity, found = np.array(scene.gravity), []
    for nodes, places in alike.items():
        elements = [scene.elements[k] for k in places]
        mass = sum(element.rhoA for element in elements)
        if mass > 0.0 and not fixed.issuperset(nodes):
            main = max(elements, key=lambda element: element.EA)
            bending, stiffness = (sum(getattr(element, name) for element in elements) for name in ("EJ", "EA"))
            acts = float(np.linalg.norm(mass * gravity + np.sum([element.load for element in elements], axis=0)))
            found.append(Curve(tuple(places), main, mass, bending, stiffness, acts))
    return found


def growth(curve: Curve, speed: np.ndarray, tension: np.ndarray, length: np.ndarray) -> np.ndarray:
    """Fastest growth of short waves, 1/s, of a taut curve; 0 where it is slack or nothing grows.

    Parameters
    ----------
    speed : (n,) array
        Of material through the curve, m/s.
    tension : (n,) array
        T = N/|r'|, N.
    length : (n,) array
        Unstretched, m.
    """
    c2, u2 = np.maximum(tension, 0.0) / curve.mass, speed * speed
    lobatto = curve.element.axial_points == "lobatto"
    factor = LINEAR if curve.element.kind == "linear" else CUBIC
    beyond = u2 - (STIFFER if lobatto else 1.0) * c2 - BENDING * curve.bending / (curve.mass * length**2)
    rate = np.sqrt(factor * np.maximum(beyond, 0.0))
    if lobatto and curve.bending == 0.0:
        weak = np.interp(np.sqrt(u2 / np.maximum(c2, 1e-300)), *WEAK, right=0.0)
        rate = np.maximum(rate, weak * np.sqrt(c2))
    return np.where(tension > curve.slack(length), rate / length, 0.0)


def through(first: np.ndarray, second: np.ndarray) -> np.ndarray:
    """Speed of material through an element, m/s, by the rates of p at its nodes: 0 where they go against each other."""
    return np.where(first * second > 0.0, np.minimum(np.abs(first), np.abs(second)), 0.0)


def most_overtaken(
    curves: list[Curve], time: np.ndarray, seen: Iterable[tuple[np.ndarray, np.ndarray, np.ndarray]]
) -> Overtaken | None:
    """The curve whose short waves grow most, if by more than `TOLD`; ``seen`` are each one's arguments of `growth`."""
    found = []
    for curve, (speed, tension, length) in zip(curves, seen, strict=True):
        with np.errstate(all="ignore"):  # numbers of no rope grow by none
            rate = np.nan_to_num(growth(curve, speed, tension, length), posinf=0.0)
        grown = float((0.5 * (rate[1:] + rate[:-1]) * np.diff(time)).sum())
        if grown > np.log(TOLD):
            k, fast = int(np.argmax(rate)), np.flatnonzero(rate)
            wave = float(np.sqrt(tension[k] / curve.mass))
            span = float(time[fast[0]]), float(time[fast[-1]])
            found.append(Overtaken(curve, *span, float(speed[k]), wave, float(tension[k]), float(length[k]), grown, 0))
    return max(found, key=lambda one: one.grown)._replace(more=len(found) - 1) if found else None


def overtaken(result: Any, scene: CableScene) -> list[str]:
    """What a run tells of material that ran through its elements faster than their waves: one sentence after another.

    Of a result that does not keep all of its frames nothing is told.
    """
    if any(name not in result for name in NEEDED):
        return []
    place = {node.id: i for i, node in enumerate(scene.nodes)}
    rate, time = np.asarray(result["material_velocity"]), np.asarray(result.time, dtype=float)
    fastest = np.maximum(rate.max(axis=0, initial=0.0), -rate.min(axis=0, initial=0.0))
    curves = curves_of(scene, {node for node, i in place.items() if fastest[i] > 0.0})
    if not curves:
        return []
    material = np.asarray(result["material_coordinate"])
    curves = [curve for curve in curves if may_be_overtaken(curve, time, *_bounds(curve, place, fastest, material))]
    worst = most_overtaken(curves, time, _seen(result, curves, place))
    return [] if worst is None else [_sentence(worst)]


def _bounds(curve: Curve, place: dict[int, int], fastest: np.ndarray, material: np.ndarray) -> tuple[float, float]:
    """Largest speed of material through a curve, m/s, and its shortest length, m, of a run."""
    i, j = (place[node] for node in curve.element.nodes)
    shortest = float((material[:, j] - material[:, i]).min())
    return float(min(fastest[i], fastest[j])), max(shortest, SHORTEST)


def may_be_overtaken(curve: Curve, time: np.ndarray, fastest: float, shortest: float) -> bool:
    """Whether short waves of a curve may grow by more than `TOLD`, by its largest speed, m/s, and shortest length, m.

    The slowest waves of a taut rope are those at the tension up to which it is slack. No wave grows faster than those
    without tension.
    """
    wave = np.sqrt(curve.slack(shortest) / curve.mass)
    most = np.sqrt(CUBIC) * fastest / shortest * (time[-1] - time[0])
    return bool(fastest > wave and most > np.log(TOLD))


def _seen(
    result: Any, curves: list[Curve], place: dict[int, int]
) -> Iterator[tuple[np.ndarray, np.ndarray, np.ndarray]]:
    """Of curves of a result, one at a time: the arguments of `growth`."""
    rate, force, ends, position, material = (np.asarray(result[name]) for name in NEEDED)
    for curve in curves:
        i, j = (place[node] for node in curve.element.nodes)
        some = list(curve.places)
        length = np.maximum(material[:, j] - material[:, i], SHORTEST)
        stretch = np.linalg.norm(position[:, j] - position[:, i], axis=-1) / length
        # Where it is slack anywhere it is no string.
        pull, (first, second) = force[:, some].sum(axis=1), ends[:, some].sum(axis=1).T
        tension = np.where(np.minimum(first, second) > 0.0, pull / np.maximum(stretch, 1e-12), 0.0)
        yield through(rate[:, i], rate[:, j]), tension, length


def _sentence(worst: Overtaken) -> str:
    element = worst.curve.element
    others = f" {worst.more} more elements are like this one." if worst.more else ""
    return (
        f"material ran through element {element.id}, between nodes {element.nodes[0]} and {element.nodes[1]}, faster "
        f"than waves run along it, from {worst.begin:.4g} to {worst.end:.4g} s: {speeds(worst)}. {what_it_does()} "
        f"{cure_of(worst)}.{others}"
    )


def speeds(worst: Overtaken) -> str:
    """Both speeds, of the moment at which short waves grow fastest."""
    return f"{worst.speed:.4g} m/s against {worst.wave:.4g} m/s = sqrt(T/rhoA) with T = N/|r'| = {worst.tension:.4g} N"


def what_it_does() -> str:
    """What comes of it."""
    return (
        "Elements let waves as short as themselves grow then, which a rope does not. Their energy is booked as work of "
        "what drives p, so the balance shows nothing. Shorter steps change nothing, more elements make it worse."
    )


def cure_of(worst: Overtaken) -> str:
    """What to do, by the kind of element."""
    curve = worst.curve
    slower = "Let the nodes move along with the material, so that p changes slower"
    enough = curve.mass * worst.length**2 * (worst.speed**2 - worst.wave**2) / BENDING
    bending = f"bending stiffness of about EJ = {max(enough, 2.0 * curve.bending):.2g} N m^2"
    if curve.element.kind == "linear":
        return f"{slower}, or take cubic elements with {bending}"
    if curve.element.axial_points == "gauss":
        return (
            f"{slower}, or give {bending}, or `quadrature: lobatto`, with which waves grow far slower up to "
            f"{np.sqrt(STIFFER):.3g} times their speed"
        )
    return f"{slower}, or give {bending}"
