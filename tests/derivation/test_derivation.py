"""The generated kernels are those of the derivation, and looped over they are the whole string's equations."""

import numpy as np
import pytest
from kane_of_many import Numbers, equations
from of_the_suite import studies

from drillstring.model.lumped_string import curve_of
from drillstring.well import wellbore
from tautline.integrators.linearise import evaluate
from tautline.integrators.state import new_state
from tautline.kernels.matrix import dense, new_matrix
from tautline.lumped import derive
from tautline.lumped.bend import Bends, bend_slopes
from tautline.lumped.body import LUMP, EccentricBodies
from tautline.lumped.curve import PER_BODY
from tautline.lumped.link import SPRING, Links, link_slopes
from tautline.system.records import records
from tautline.system.system import Degrees, assemble
from tautline.system.time_functions import compile_functions

WELL = wellbore.from_survey(np.array([0.0, 8.0]), np.array([0.4, 1.5]), np.array([0.5, 2.0]))


@pytest.mark.parametrize("eccentric", ["as it stands", *studies("derived")])
def test_the_generated_kernels_are_what_the_derivation_writes_today(eccentric, monkeypatch):
    """The body off the axis takes half of the time to derive, and is held against other equations below."""
    text = (derive.HERE / "generated.py").read_text(encoding="utf8")
    head, _, body = text.partition("\n\n")
    if eccentric == "as it stands":
        stands = [f"{part}\n" for part in body.split("\n\n\n") if "def eccentric_body_" in part]
        assert len(stands) == 4
        made = derive._body_kernels
        monkeypatch.setattr(derive, "_body_kernels", lambda name, eccentric: stands if eccentric else made(name, False))
    assert head.endswith(f'Derivation {derive.digest()}."""')
    assert body == derive.source()


def numbers_of(n, rng):
    def some(count):
        return rng.uniform(0.5, 1.5, count)

    return Numbers(
        k1=float(WELL.k1[0]), k2=float(WELL.k2[0]),
        down=np.array([WELL.m1s[0, 2], WELL.m2s[0, 2], WELL.tangents[0, 2]]),
        place=1.0 + 1.4 * np.arange(n), mass=some(n), polar=some(n), transverse=some(n), lateral_mass=some(n),
        weight=some(n), damping=some((n, 4)), e=0.3 * rng.standard_normal((n, 2)), axial=some(n - 1),
        torsional=some(n - 1), bending=some(n - 2), link_damping=0.3,
    )  # fmt: skip


def system_of(numbers):
    """The same string as a system of groups; all its degrees of freedom are free."""
    n = numbers.mass.size
    curve = curve_of(WELL, numbers.place)
    # One damping serves both lateral directions.
    names = dict(mass=numbers.mass, polar=numbers.polar, transverse=numbers.transverse, weight=numbers.weight)
    names |= dict(lateral_mass=numbers.lateral_mass, e1=numbers.e[:, 0], e2=numbers.e[:, 1])
    names |= dict(zip(("damping_along", "damping_across", "damping_about"), numbers.damping.T[[0, 1, 3]], strict=True))
    length = np.diff(numbers.place)
    springs = records(n - 1, SPRING, length=length, axial=numbers.axial, torsional=numbers.torsional)
    groups = (
        EccentricBodies(curve, records(n, LUMP, **names), np.zeros((3, 4, 4))),
        Links(curve, springs, numbers.link_damping, link_slopes(), np.zeros((3, 6, 6))),
        Bends(curve, length, numbers.bending, 1.0, bend_slopes(), np.zeros((9, 9))),
    )
    full = PER_BODY * n
    degrees = Degrees([str(i) for i in range(full)], np.zeros(full), np.ones(full))
    every = [np.arange(full)[None, :]]
    return assemble(groups, degrees, compile_functions([]), np.zeros(full), every, every)


def test_the_looped_body_link_and_bend_are_the_equations_of_all_bodies_at_once(bodies=3):
    """Within 1e-9 at random states: mass matrix, gyroscopic terms, weights, springs and dampers.

    Three bodies are the fewest with two links that share one, and with a bend.
    """
    rng = np.random.default_rng(bodies)
    numbers = numbers_of(bodies, rng)
    numbers.damping[:, 2] = numbers.damping[:, 1]
    whole, system = equations(numbers), system_of(numbers)
    full = PER_BODY * bodies
    at = np.array([system.names.index(str(i)) for i in range(full)])
    for _ in range(20):
        q = np.column_stack([0.2 * rng.standard_normal((bodies, 3)), rng.uniform(-3, 3, bodies)]).ravel()
        w = rng.standard_normal(full)
        state = new_state(system)
        state.q[at], state.v[at] = q, w
        matrix, r = new_matrix(full, system.bandwidth), np.zeros(full)
        evaluate(system, state, 0.0, 1.0, False, 1.0, 0.0, 0.0, matrix, r)
        depth = q.copy()
        depth[::PER_BODY] += numbers.place
        mass, forcing = whole(depth, w)
        ours = dense(matrix)[np.ix_(at, at)]
        assert np.allclose(ours, mass, rtol=1e-9, atol=1e-9 * np.abs(mass).max())
        assert np.allclose(r[at], -forcing, rtol=1e-9, atol=1e-9 * np.abs(forcing).max())
