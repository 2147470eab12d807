"""The critical step three ways, against textbook element matrices and RK4's own polynomial."""

import math

import numpy as np
import pytest
from of_the_suite import studies
from scipy.linalg import eigh
from study.oscillators import (
    LIMIT,
    OMEGA,
    REAL_LIMIT,
    START,
    bar,
    chain,
    node,
    oscillator,
    rk4,
    rk4_factor,
    spring,
    subject,
    text_of,
)

from tautline.integrators.vibration.critical_step import critical_step
from tautline.run import Run
from tautline.scene.methods import RK4
from tautline.study.robustness import critical as critical_module
from tautline.study.robustness.bar import EFFECTIVE, Bar
from tautline.study.robustness.critical import (
    Critical,
    bisect,
    critical_step_of,
    critical_steps,
    eigenvalues,
    explicit_run,
)
from tautline.study.robustness.penalties import penalties
from tautline.study.robustness.stability import stability
from tautline.study.trials.trial import Setting

RK4_LIMIT = RK4.limit

HOUSE = RK4_LIMIT / LIMIT
"""The house takes the thesis' 2.8 (eq. 2.137) where the polynomial says 2 sqrt 2."""
LOBATTO = np.array([0.0, 0.5, 1.0]), np.array([1.0, 4.0, 1.0]) / 6.0
GAUSS = tuple(0.5 * (np.polynomial.legendre.leggauss(6)[0] + 1.0)), 0.5 * np.polynomial.legendre.leggauss(6)[1]


# what a textbook says of one element, L = EA = rhoA = 1
def cubic_matrices(points):
    """Stiffness by a quadrature's points and weights, mass exactly, of (u, u', u, u') in Hermite's cubic functions."""
    functions = [np.poly1d(c) for c in ([2, -3, 0, 1], [1, -2, 1, 0], [-2, 3, 0, 0], [1, -1, 0, 0])]
    slopes = [f.deriv() for f in functions]
    x, w = (np.asarray(part) for part in points)
    stiffness = np.array([[np.sum(w * a(x) * b(x)) for b in slopes] for a in slopes])
    mass = np.array([[np.polyint(a * b)(1.0) for b in functions] for a in functions])
    return stiffness, mass


def fastest_of(stiffness, mass, held):
    keep = [i for i in range(len(mass)) if i not in held]
    return math.sqrt(eigh(stiffness[np.ix_(keep, keep)], mass[np.ix_(keep, keep)], eigvals_only=True)[-1])


@pytest.mark.parametrize(("shape", "points"), [("cubic", GAUSS), ("bent", LOBATTO)])
def test_effective_lengths_of_cubic_elements_are_those_of_hermites_matrices(shape, points):
    matrices = cubic_matrices(points)
    assert EFFECTIVE[shape, True] == pytest.approx(2.0 / fastest_of(*matrices, held=[0]), rel=1e-5)
    assert EFFECTIVE[shape, False] == pytest.approx(2.0 / fastest_of(*matrices, held=[0, 2]), rel=1e-5)


def test_effective_lengths_of_linear_elements_are_those_of_the_consistent_mass_and_of_masses_on_springs():
    """Free at both ends, as nothing in a mesh is freer: K = (1, -1; -1, 1), M = (2, 1; 1, 2)/6 or unity/2."""
    stiffness = np.array([[1.0, -1.0], [-1.0, 1.0]])
    for free in (True, False):
        consistent = fastest_of(stiffness, np.array([[2.0, 1.0], [1.0, 2.0]]) / 6.0, [])
        assert EFFECTIVE["linear", free] == pytest.approx(2.0 / consistent, rel=1e-5)
        assert EFFECTIVE["lumped", free] == pytest.approx(2.0 / fastest_of(stiffness, np.eye(2) / 2.0, []), rel=1e-9)


@pytest.mark.parametrize("shape", ["cubic", "bent"])
def test_a_mesh_of_many_elements_is_no_faster_than_its_effective_length_says(shape):
    """Bloch waves of an endless mesh: the fastest of all wave numbers, by the element's own matrices."""
    stiffness, mass = cubic_matrices(GAUSS if shape == "cubic" else LOBATTO)
    fastest = 0.0
    for wave in np.linspace(0.0, np.pi, 41):
        join = np.vstack([np.eye(2), np.exp(1j * wave) * np.eye(2)])
        k, m = (join.conj().T @ part @ join for part in (stiffness, mass))
        fastest = max(fastest, math.sqrt(eigh(k, m, eigvals_only=True)[-1]))
    assert fastest <= Bar("", 1.0, 1.0, shape, False).fastest * (1.0 + 1e-5)


def test_a_bars_frequency_goes_with_speed_over_length():
    one, other = Bar("", 1.0, 1.0, "cubic", True), Bar("", 0.05, 300.0, "cubic", True)
    assert other.fastest == pytest.approx(300.0 / 0.05 * one.fastest)
    assert other.effective_length == pytest.approx(0.05 * one.effective_length)


# the region of stability of RK4
def reach(root):
    """How far the region reaches from the origin in the direction of a root, by bisection."""
    ray = root / abs(root)
    low = max(h for h in np.linspace(1e-3, 4.0, 4000) if abs(rk4_factor(h * ray)) <= 1.0)
    high = low + 2e-3
    for _ in range(30):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if abs(rk4_factor(middle * ray)) <= 1.0 else (low, middle)
    return low


@pytest.mark.parametrize("zeta", [0.0, 1e-3, 0.05, 0.3, 0.7, 0.99, 1.01, 2.0, 50.0])
def test_the_critical_step_of_a_damped_mode_lies_on_the_edge_of_the_region_in_the_complex_plane(zeta):
    """The edge is found by bisection on |1 + z + z^2/2 + z^3/6 + z^4/24| along the ray of each root."""
    steps = [min(reach(root), RK4_LIMIT) / abs(root) for root in np.roots([1.0, 2.0 * zeta, 1.0])]
    assert critical_step(1.0, 2.0 * zeta) == pytest.approx(min(steps), rel=2e-3)


@pytest.mark.parametrize(
    ("value", "reach"),
    [(1j, RK4_LIMIT), (-1j, RK4_LIMIT), (-1.0, REAL_LIMIT), (-1e6, REAL_LIMIT), (3e4j, RK4_LIMIT)],
)
def test_the_step_of_an_eigenvalue_is_the_reach_of_the_region_over_its_size(value, reach):
    assert critical_step_of(value) == pytest.approx(reach / abs(value), rel=5e-4)


@pytest.mark.parametrize("value", [0.0, 2.0, 1.0 + 5.0j, 1e-3 + 1j])
def test_what_grows_by_itself_or_rests_sets_no_step(value):
    assert critical_step_of(value) == np.inf


def test_the_step_of_an_eigenvalue_that_is_damped_by_rounding_is_that_of_an_undamped_one():
    assert critical_step_of(-1e-16 + 10j) == critical_step_of(1e-16 + 10j) == pytest.approx(0.28)


# by eigenvalues
SHAPES = {
    ("cubic", True): {}, ("cubic", False): {"ends": ("pinned", "pinned")},
    ("bent", True): {"bends": True}, ("bent", False): {"ends": ("pinned", "pinned"), "bends": True},
}  # fmt: skip


@pytest.mark.parametrize("case", SHAPES)
def test_of_one_element_effective_length_and_eigenvalues_agree_with_the_textbook(case):
    shape, free = case
    found = look_at(bar(EA=4.0, length=0.5, time_step=1e-3, time_end=0.01, **SHAPES[case]))
    omega = fastest_of(*cubic_matrices(GAUSS if shape == "cubic" else LOBATTO), held=[0] if free else [0, 2]) * 2 / 0.5
    assert found.eigenvalue == pytest.approx(RK4_LIMIT / omega, rel=1e-4)
    assert found.effective_length == pytest.approx(RK4_LIMIT / omega, rel=1e-4)
    assert found.omega_max == pytest.approx(omega, rel=1e-4)
    assert found.set_by.startswith("stiffness of tension (100 %)")


def look_at(text) -> Critical:
    """The critical step without the bisection, which takes hundreds of runs."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(critical_module, "bisect", lambda *_: None)
        return critical_steps(subject(text))


@pytest.mark.parametrize("count", [2, 5])
def test_of_a_mesh_the_effective_length_of_its_free_end_is_on_the_safe_side_by_little(count):
    found = look_at(bar(count, time_step=1e-3, time_end=0.01))
    matrix = np.zeros((2, 2 * count + 2, 2 * count + 2))
    for i in range(count):
        for part, one in zip(matrix, cubic_matrices(GAUSS), strict=True):
            scale = np.diag([1.0, 1.0 / count, 1.0, 1.0 / count])
            part[2 * i : 2 * i + 4, 2 * i : 2 * i + 4] += scale @ one @ scale
    omega = count * fastest_of(*matrix, held=[0])
    assert found.eigenvalue == pytest.approx(RK4_LIMIT / omega, rel=1e-3)
    assert 1.0 <= found.eigenvalue / found.effective_length < 1.1


@pytest.mark.parametrize("zeta", [0.0, 0.2, 1.5, 8.0])
def test_eigenvalues_of_an_oscillator_are_the_roots_of_its_equation(zeta):
    model = subject(oscillator(zeta=zeta)).model(Setting())
    started = Run(model)
    started.start()
    found = np.sort_complex(eigenvalues(model.system, started.state, 0.0))
    assert found == pytest.approx(
        np.sort_complex(np.roots([1.0, 2 * zeta * OMEGA, OMEGA**2]).astype(complex)), rel=1e-9
    )


@pytest.mark.parametrize("zeta", [0.0, 0.3, 4.0])
def test_the_critical_step_of_an_oscillator_is_the_polynomials(zeta):
    found = look_at(oscillator(zeta=zeta, time_end=0.4))
    assert found.eigenvalue == pytest.approx(critical_step(OMEGA**2, 2 * zeta * OMEGA), rel=2e-3)
    assert found.effective_length is None and found.shortest == ""
    assert ("damping" in found.set_by) is (zeta > 1.0)


def test_the_least_step_along_a_run_is_told_with_its_time():
    """A rope that takes no compression stands slack at the start, and vibrates when it is taut."""
    slack = [
        node(0, 0.0, 0.0, (1, 1, 1, 1)), node(1, 0.9, 1.0),
        spring(0, (0, 1), 400.0, compression="false"), "PointMass: {id: 0, nodes4: [1], mass: 1.0}",
        "PointForce: {id: 0, nodes4: [1], force: [1.0, 0, 0]}",
    ]  # fmt: skip
    found = look_at(text_of(slack, time_end=0.8, plotpoints=50))
    # Through 0.1 m at 1 m/s^2: taut after sqrt(0.2) s, and then omega = 20.
    assert found.eigenvalue == pytest.approx(RK4_LIMIT / 20.0, rel=1e-6)
    assert math.sqrt(0.2) <= found.at <= math.sqrt(0.2) + 0.03
    assert found.at_start is None and found.bisection is None


def test_multipliers_do_not_count_as_motions():
    """Two masses made one by a multiplier, a third on a spring: (k/m)(1, and the chain's) by hand."""
    found = look_at(chain(100.0, time_end=0.1))
    pair = np.array([[200.0, -100.0], [-100.0, 100.0]])
    fastest = math.sqrt(eigh(pair, np.diag([2.0, 1.0]), eigvals_only=True)[-1])
    assert found.eigenvalue == pytest.approx(RK4_LIMIT / fastest, rel=1e-3)
    assert np.abs(found.points).max() == pytest.approx(fastest, rel=1e-9) and found.points.size == 4


# what sets it
def anchored(stiffness, **solver):
    return oscillator(items=[f"OneNodeSpring: {{id: 0, nodes4: [1], stiffness: {stiffness}}}"], **solver)


def test_what_sets_the_step_is_named_with_its_share_and_its_place():
    found = look_at(anchored(300.0, time_end=0.4))
    assert found.set_by == "stiffness of anchors (75 %), most at node 1: rx"
    assert found.omega_max == pytest.approx(20.0)


def test_the_critical_step_against_the_stiffness_of_a_spring_is_that_of_the_sum_of_both():
    found = penalties(subject(anchored(100.0)))
    assert [entry.kind for entry in found] == ["contact"] * 8
    for entry in found:
        assert entry.critical_step == pytest.approx(RK4_LIMIT / math.sqrt(OMEGA**2 + entry.value), rel=1e-6)
    assert min(e.value for e in found) <= 0.1 and max(e.value for e in found) >= 1e5


def test_the_critical_step_against_the_stiffness_of_a_penalty_is_that_of_two_masses_on_it():
    """Two masses joined by k_p between springs of 100 N/m, and one more: K and M written down."""
    found = penalties(subject(chain(100.0, tie="Penalty4", more=", p_spring: 1.0e4")))
    assert {entry.kind for entry in found} == {"penalty"}
    for entry in found:
        k = entry.value
        stiffness = np.array([[100.0 + k, -k, 0.0], [-k, 100.0 + k, -100.0], [0.0, -100.0, 100.0]])
        expected = RK4_LIMIT / math.sqrt(eigh(stiffness, eigvals_only=True)[-1])
        assert entry.critical_step == pytest.approx(expected, rel=2e-3)


def test_a_scene_without_springs_has_no_table_of_them():
    assert penalties(subject(oscillator())) == []


# by bisection on real runs
@pytest.mark.parametrize(("omega", "zeta"), [(37.0, 0.0), (10.0, 3.0), *studies((10.0, 0.1), (10.0, 0.5))])
def test_bisection_encloses_the_true_limit_of_an_oscillator_within_two_per_cent(omega, zeta):
    """Where |R| = 1 on the ray of its roots: at 2 sqrt 2 without damping."""
    study, why = subject(oscillator(omega=omega, zeta=zeta, **rk4(time_end=5.0))), []
    found = bisect(study, critical_step(omega**2, 2 * zeta * omega), why)
    assert found is not None, why
    low, high = found
    edge = min(reach(root) / abs(root) for root in np.roots([1.0, 2 * zeta * omega, omega**2]))
    assert low <= 1.02 * edge and high >= 0.98 * edge
    assert high / low - 1.0 <= 0.0101


def test_a_run_of_the_bisection_takes_the_step_that_it_names(monkeypatch):
    taken = []
    run_model = critical_module.run_model

    def noting(model, setting, **further):
        done = run_model(model, setting, **further)
        taken.append((setting.step, done.attribute("step")))
        return done

    monkeypatch.setattr(critical_module, "run_model", noting)
    for step in (0.0171, 0.1003, 0.2718):
        explicit_run(subject(oscillator(**rk4(time_end=5.0))), step)
    for named, really in taken:
        assert really == pytest.approx(named, rel=1e-6)


def test_a_scene_at_rest_has_a_limit_by_eigenvalues_and_says_why_runs_show_none():
    found = critical_steps(subject(oscillator(start=0.0, time_end=1.0)))
    assert found.eigenvalue == pytest.approx(RK4_LIMIT / OMEGA)
    assert found.bisection is None and found.why


def test_a_scene_that_nothing_holds_has_no_critical_step():
    free = text_of([node(0, 0.0, 0.0), node(1, 1.0, 1.0), spring(0, (0, 1), 0.0),
                    "PointMass: {id: 0, nodes4: [0, 1], mass: 1.0}",
                    "PointForce: {id: 0, nodes4: [1], force: [1, 0, 0]}"], time_end=0.2)  # fmt: skip
    found = critical_steps(subject(free))
    assert found.eigenvalue is None and found.bisection is None and found.at_start is None
    assert "nothing vibrates" in found.why


def test_an_explicit_run_that_grows_is_told_from_one_that_does_not():
    study = subject(oscillator(**rk4(time_end=5.0)))
    calm, short = explicit_run(study, 0.1), explicit_run(study, 0.001)
    assert calm is not None and short is not None
    # Largest momentum: A omega of 1 kg. At long steps RK4 takes energy, |R(i)|^2 = 1 - 1/72 + 1/576, and gives none.
    assert short[0] == pytest.approx(START * OMEGA, rel=0.02) and short[1] < 1e-6
    assert calm[0] <= START * OMEGA and calm[1] < 1e-6
    grown = explicit_run(study, 0.31)
    assert grown is None or grown[0] > 30.0 * calm[0]


def test_bisection_finds_a_limit_that_is_far_from_the_guess():
    """A guess four times too high, and one four times too low."""
    for guess in (4.0 * LIMIT / OMEGA, 0.25 * LIMIT / OMEGA):
        found = bisect(subject(oscillator(**rk4(time_end=5.0))), guess, [])
        assert found is not None and found[0] <= 1.003 * LIMIT / OMEGA and found[1] >= 0.997 * LIMIT / OMEGA


def test_real_runs_that_break_below_the_eigenvalues_are_told(monkeypatch):
    """The search sees half of the frequency, as with a tangent that is four times too soft."""
    search = critical_module.CriticalStep.search

    def blind(self, state, t):
        step, row = search(self, state, t)
        return 2.0 * step, row

    monkeypatch.setattr(critical_module.CriticalStep, "search", blind)
    monkeypatch.setattr(critical_module, "eigenvalues", lambda *_: np.zeros(0, complex))
    monkeypatch.setattr("tautline.study.robustness.stability.variants", lambda *_: [])
    found = stability(subject(oscillator(**rk4(time_step=0.01, time_end=2.0))))
    assert any("real runs are unstable from" in warning for warning in found.warnings)


def test_a_run_that_stops_while_it_is_looked_at_is_told_and_what_stopped_it_is_found():
    """Beside the spring of 100 N/m lies a slack rope of 1e4 N/m that goes taut on the way."""
    rope = [
        node(2, 1.02, 1.03), spring(1, (0, 2), 1.0e4 * 1.03, compression="false"),
        "LinearCoupl: {id: 0, sNode: 2, sDof: 1, f0: 0.07, masters: [{mNode: 1, mDof: 1}]}",
    ]  # fmt: skip
    push = "PointForce: {id: 0, nodes4: [1], force: [2, 0, 0]}"
    found = look_at(oscillator(start=-0.05, items=[*rope, push], time_end=1.0, plotpoints=20))
    assert "stopped: UNSTABLE" in found.why
    assert found.eigenvalue == pytest.approx(RK4_LIMIT / math.sqrt(100.0 + 1.0e4), rel=1e-3)
    assert found.at_start == pytest.approx(RK4_LIMIT / OMEGA, rel=1e-3)
