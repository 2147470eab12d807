"""Waves of tension in the rope of a crane whose ends begin to move: the rope as a straight bar, unrolled.

In a bar of stiffness EA and mass rho per length, v = f(s - c t) + g(s + c t) and the tension is Z (g - f), with
c = sqrt(EA/rho) and Z = sqrt(EA rho) (d'Alembert). A wave therefore comes out of a span as it went in, a time later: no
point within a span is computed. Where spans meet stand the masses: bodies, rims of sheaves, drums that turn. All is
linear about the state at rest; friction and slack are left out. A damping c of the rope takes exp(-c w^2 t / 2) from a
wave of the frequency w in a time t, as a mean does over times that are spread by sqrt(c t) about it.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from crane.assembly.estimates import Estimate
from crane.assembly.loads import added_mass_of, pull
from crane.assembly.mesh_damping import damping_of
from crane.assembly.tension_at_rest import stays_held
from crane.scene.scene import Drum, End, Sheave

LEAST_PULL = 0.3
"""Pull on a body along an axis below which it swings that way and does not bounce."""


class Bar(NamedTuple):
    """Spans of a rope and the masses at their ends, for steps of one length.

    Attributes
    ----------
    delay : int array (spans,)
        Steps that a wave takes along each span.
    impedance : array (spans,)
        Tension over speed of a wave, N s/m, so that the stiffness of each span is exact.
    first, last : array (spans, unknowns)
        Speed of the rope at the begin and at the end of each span, along it, by the unknown speeds.
    inertia : array (unknowns,)
        kg; rims, drums and bodies.
    elements : tuple of int
        Of each span.
    spread : int array (spans,)
        Steps by which a wave is spread either way as it goes along a span.
    """

    delay: np.ndarray
    impedance: np.ndarray
    first: np.ndarray
    last: np.ndarray
    inertia: np.ndarray
    elements: tuple[int, ...]
    spread: np.ndarray


def bar_of(found: Estimate, step: float) -> Bar:
    """The rope of a scene as a bar.

    Parameters
    ----------
    found : Estimate
    step : float
        Time from one state to the next, s.
    """
    scene, path = found.scene, found.path
    chords = np.array(path.chords, dtype=float)
    delay = np.maximum(1, np.rint(chords / (scene.rope.wave_speed * step)).astype(int))
    # a quarter either way at a distance d has the variance d^2 / 2
    spread = np.sqrt(2.0 * np.array(damping_of(scene, path)) * delay / step)
    columns, inertia = _unknowns(found)
    first, last = np.zeros((len(chords), len(columns))), np.zeros((len(chords), len(columns)))
    for column, speeds in enumerate(columns):
        for item, (before, after) in speeds.items():
            if item > 0:
                last[item - 1, column] += before
            if item < len(chords):
                first[item, column] += after
    impedance = scene.rope.axial_stiffness / chords * delay * step
    spread = np.minimum(np.rint(spread).astype(int), delay - 1)
    return Bar(delay, impedance, first, last, np.array(inertia), scene.elements, spread)


def _unknowns(found: Estimate) -> tuple[list[dict[int, tuple[float, float]]], list[float]]:
    """Of each unknown speed: that of the rope before and after each item of the path that it moves, and its mass."""
    scene, path = found.scene, found.path
    columns: list[dict[int, tuple[float, float]]] = []
    inertia: list[float] = []
    for i, item in enumerate(scene.path):
        turning = item.inertia / item.radius**2 if isinstance(item, Sheave) and not item.locked else 0.0
        if isinstance(item, Drum):
            turning = (item.inertia or 0.0) / item.radius**2 + scene.rope.mass_per_length * (item.rope_on_drum or 0.0)
            if item.prescribed or turning == 0.0 or stays_held(scene, path, item):
                continue
        if isinstance(item, (Sheave, Drum)):
            columns.append({i: (1.0, 1.0)})
            inertia.append(turning)
    for name, force in pull(scene, path).items():
        body = scene.body(name)
        on = [i for i, one in enumerate(scene.path) if isinstance(one, (End, Sheave)) and one.body == name]
        for c, axis in enumerate("xyz"):
            mass = body.mass + added_mass_of(scene, body)[c]
            if axis not in body.guide and mass > 0.0 and abs(force[c]) > LEAST_PULL:
                columns.append({i: _along(found, i, c) for i in on})
                inertia.append(mass)
    return columns, inertia


def _along(found: Estimate, item: int, axis: int) -> tuple[float, float]:
    """Part along the spans before and after an item of a unit speed along an axis."""
    spans = found.path.spans
    before = float(spans[item - 1].e[axis]) if item > 0 else 0.0
    return before, float(spans[item].e[axis]) if item < len(spans) else 0.0


def tensions(bar: Bar, first: np.ndarray, last: np.ndarray, paid: np.ndarray, step: float) -> np.ndarray:
    """Tension above that at rest at both ends of every span, (steps, spans, 2) N.

    Parameters
    ----------
    bar : Bar
    first, last : array (steps, spans)
        Prescribed part of the speed of the rope at the begin and at the end of each span, along it, m/s.
    paid : array (spans, 2)
        Part of it at t = 0 that drums pay out. A run begins with rope that goes along a span as its two ends pay it
        out, evenly from one to the other, and with nodes at rest: what moves with a point reaches to the next node.
    step : float
        s.
    """
    steps, count = first.shape
    spans, most = np.arange(count), int((bar.delay + bar.spread).max())
    ahead, back = np.zeros((steps + most, count)), np.zeros((steps + most, count))
    z, speed, found = bar.impedance, np.zeros(bar.inertia.size), np.empty((steps, count, 2))
    for k, long in enumerate(bar.delay):
        place = (np.arange(long) + 0.5) / long
        hung = first[0, k] - paid[k, 0], last[0, k] - paid[k, 1]
        near = np.maximum(0.0, 1.0 - bar.elements[k] * place)
        # half of a speed without tension goes either way
        along = 0.5 * (paid[k, 0] * (1.0 - place) + paid[k, 1] * place + hung[0] * near + hung[1] * near[::-1])
        ahead[: most - long, k], back[: most - long, k] = along[-1], along[0]
        ahead[most - long : most, k], back[most - long : most, k] = along[::-1], along
    into_first, into_last = bar.first.T * z, bar.last.T * z
    inertia = bar.inertia / step
    mobility = np.linalg.inv(np.diag(inertia) + into_first @ bar.first + into_last @ bar.last)
    for k in range(steps):
        at = most + k - bar.delay
        arrives = 0.5 * ahead[at, spans] + 0.25 * (ahead[at - bar.spread, spans] + ahead[at + bar.spread, spans])
        comes_back = 0.5 * back[at, spans] + 0.25 * (back[at - bar.spread, spans] + back[at + bar.spread, spans])
        # the masses take part by the implicit Euler rule: no step is too long for a light rim
        push = into_first @ (2.0 * comes_back - first[k]) + into_last @ (2.0 * arrives - last[k])
        speed = mobility @ (inertia * speed + push)
        goes, returns = bar.first @ speed + first[k] - comes_back, bar.last @ speed + last[k] - arrives
        ahead[most + k], back[most + k] = goes, returns
        found[k, :, 0], found[k, :, 1] = z * (comes_back - goes), z * (returns - arrives)
    return found
