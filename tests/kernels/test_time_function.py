"""Functions of time: what is written is what is evaluated, with its exact derivatives and integrals."""

import math
from typing import Annotated

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from pydantic import TypeAdapter
from scipy.integrate import quad

from tautline.kernels.jit import entry
from tautline.kernels.time_function import MANY, evaluate, sample, value_at
from tautline.scene.errors import SceneError
from tautline.scene.functions import Chirp, Constant, Harmonic, Ramp, Spectrum, Sum, Table, Velocity, time_function
from tautline.system.time_functions import FunctionRequest, bounds_of, compile_functions, jonswap

SEA = Spectrum(significant_height=2.5, peak_period=9.0, gamma=2.0, seed=7, rao=0.6)
WAVE_TABLE = Table(time=tuple(np.arange(0.0, 12.1, 0.5)), value=tuple(np.sin(np.arange(0.0, 12.1, 0.5))))
SPEEDS = Table(time=(0.0, 2.0, 3.0, 8.0, 9.0), value=(0.0, 0.0, -0.8, -0.8, 0.0), interpolation="linear")
FUNCTIONS = {
    "constant": Constant(value=2.5),
    "ramp": Ramp(to=-2.0, over=3.0),
    "ramp from": Ramp(**{"from": 1.0}, to=4.0, over=2.0, at=1.5),
    "ramp rate": Ramp(rate=0.25, over=2.0, at=0.5),
    "table": WAVE_TABLE,
    "harmonic": Harmonic(amplitude=0.5, period=8.0, phase=0.3, mean=0.2),
    "harmonic under an envelope": Harmonic(amplitude=0.5, frequency=0.4, phase=0.3, ramp=8.0),
    "chirp": Chirp(amplitude=1.0, period=20.0, rate=0.0025, shift=5.0),
    "spectrum": SEA,
    "spectrum under an envelope": SEA.model_copy(update={"ramp": 5.0}),
    "sum": Sum(terms=(Ramp(to=1.0, over=2.0), Harmonic(amplitude=0.1, period=3.0), Constant(value=-1.0))),
}
TIMES = np.linspace(0.013, 11.87, 97)


def compiled(model, integrate=False, end=20.0):
    return compile_functions([FunctionRequest(model, integrate, end)])


def value(functions, t):
    return value_at(functions, 0, t)[0]


@pytest.mark.parametrize("name", FUNCTIONS)
def test_many_samples_which_are_compiled_equal_single_values_which_are_not(name):
    functions = compiled(FUNCTIONS[name])
    times = np.linspace(-1.0, 13.0, MANY)
    values = np.array([value_at(functions, 0, t) for t in times[::100]])
    assert sample(functions, 0, times)[::100] == pytest.approx(values, rel=1e-12, abs=1e-13)


@pytest.mark.parametrize("integrate", [False, True])
@pytest.mark.parametrize("name", sorted(FUNCTIONS.keys() - {"spectrum", "spectrum under an envelope"}))
def test_few_samples_are_the_single_values_to_the_bit(name, integrate):
    functions = compiled(FUNCTIONS[name], integrate)
    # At the breaks too, where one piece ends and the next begins.
    times = np.sort(np.concatenate([np.linspace(-1.0, 13.0, 57), np.arange(0.0, 12.1, 0.5)]))
    assert sample(functions, 0, times).tolist() == [list(value_at(functions, 0, t)) for t in times]


@pytest.mark.parametrize("integrate", [False, True])
@pytest.mark.parametrize("name", FUNCTIONS)
def test_rates_equal_central_differences(name, integrate):
    functions = compiled(FUNCTIONS[name], integrate)
    h = 1e-4
    f, above, below = (sample(functions, 0, TIMES + step) for step in (0.0, h, -h))
    scale = 1.0 + np.abs(f).max(axis=0)
    assert np.allclose(f[:, 1], (above[:, 0] - below[:, 0]) / (2 * h), atol=1e-6 * scale[1])
    assert np.allclose(f[:, 2], (above[:, 1] - below[:, 1]) / (2 * h), atol=1e-5 * scale[2])


@pytest.mark.parametrize("name", [*FUNCTIONS, "speeds"])
def test_the_integral_is_zero_at_zero_and_good_to_1e_minus_9(name):
    model = FUNCTIONS.get(name, SPEEDS)
    rate, whole = compiled(model), compiled(model, integrate=True)
    if name == "table":
        model = model.model_copy(update={"interpolation": "linear"})
        rate = compiled(model)
    assert abs(value(whole, 0.0)) < 1e-15
    breaks = [t for t in (0.5, 1.5, 2.0, 2.5, 3.0, 3.5, 5.0, 8.0, 9.0)]
    for t in (0.7, 4.4, 11.8):
        points = breaks if name != "table" else list(WAVE_TABLE.time)
        points = [p for p in points if p < t]
        exact, error = quad(lambda s: value(rate, s), 0.0, t, points=points, epsabs=1e-13, epsrel=1e-13, limit=2000)
        scale = max(1e-3, t * np.abs(sample(rate, 0, np.linspace(0.0, t, 400))[:, 0]).mean())
        assert error < 1e-9 * scale
        assert value(whole, t) == pytest.approx(exact, abs=1e-9 * scale)


def test_the_integrals_rate_is_the_function_itself():
    for name, model in FUNCTIONS.items():
        if name == "table":
            continue
        rate, whole = sample(compiled(model), 0, TIMES), sample(compiled(model, True), 0, TIMES)
        assert np.allclose(whole[:, 1], rate[:, 0], atol=1e-8), name
        assert np.allclose(whole[:, 2], rate[:, 1], atol=1e-6), name


def test_the_chirp_is_equation_2_171_of_the_thesis_less_its_start():
    functions = compiled(FUNCTIONS["chirp"])
    start = math.sin(-math.pi / 2 + 25 / 400)
    for t in (0.0, 1.0, 12.3, 39.9):
        expected = math.sin(2 * math.pi * (t - 5) / 20 + (t - 5) ** 2 / 400) - start
        assert value(functions, t) == pytest.approx(expected, abs=1e-13)
    assert value_at(functions, 0, 0.0)[1] == pytest.approx(0.0181, abs=5e-5)


def test_a_ramp_starts_and_ends_without_rate_or_acceleration_and_is_held():
    functions = compiled(Ramp(to=2.0, over=3.0, at=1.0))
    for t, f in ((-1.0, 0.0), (0.5, 0.0), (1.0, 0.0), (2.5, 1.0), (4.0, 2.0), (100.0, 2.0)):
        assert value(functions, t) == pytest.approx(f, abs=1e-14)
    for t in (1.0, 1.0 + 1e-9, 4.0 - 1e-9, 4.0):
        assert value_at(functions, 0, t)[1:] == pytest.approx((0.0, 0.0), abs=1e-7)


def test_a_ramped_rate_grows_on_at_that_rate():
    functions = compiled(Ramp(rate=0.25, over=2.0))
    assert value_at(functions, 0, 2.0) == pytest.approx((0.25, 0.25, 0.0), abs=1e-14)
    assert value_at(functions, 0, 12.0) == pytest.approx((2.75, 0.25, 0.0), abs=1e-13)


def test_a_linear_table_integrates_to_the_trapezoids_and_goes_on_at_the_last_speed():
    functions = compiled(Velocity(velocity=Table(time=(0.0, 1.0, 3.0), value=(0.0, 2.0, 1.0))))
    for t, f in ((0.5, 0.25), (1.0, 1.0), (3.0, 4.0), (5.0, 6.0)):
        assert value(functions, t) == pytest.approx(f, abs=1e-14)


def test_a_table_is_held_outside():
    for interpolation in ("linear", "cubic"):
        functions = compiled(Table(time=(1.0, 2.0, 4.0), value=(3.0, 1.0, 5.0), interpolation=interpolation))
        assert value_at(functions, 0, 0.5) == (3.0, 0.0, 0.0)
        assert value_at(functions, 0, 9.0) == (5.0, 0.0, 0.0)
        assert value(functions, 2.0) == pytest.approx(1.0, abs=1e-13)


@pytest.mark.parametrize("beside", [0.0, 4.0e-15, -4.0e-15, 1.0e-10])
@pytest.mark.parametrize("interpolation", ["linear", "cubic"])
def test_at_its_last_row_and_within_rounding_of_it_a_table_still_moves_and_behind_it_is_held(interpolation, beside):
    time = np.linspace(0.0, 12.0, 241)
    table = Table(time=tuple(time), value=tuple(0.5 * np.sin(0.25 * np.pi * time)), interpolation=interpolation)
    functions, end = compiled(table), 12.0 * (1.0 + 0.5 * beside)
    # Half a meter at a period of 8 s, and 12 s are one and a half of them.
    speed = -0.125 * np.pi
    assert value_at(functions, 0, end) == (
        pytest.approx(0.0, abs=1e-9), pytest.approx(speed, rel=1e-3), pytest.approx(0.0, abs=0.05),
    )  # fmt: skip
    assert sample(functions, 0, np.full(MANY, end))[-1, 1] == pytest.approx(speed, rel=1e-3)
    assert value_at(functions, 0, 12.0 + 1e-6) == (table.value[-1], 0.0, 0.0)


def test_at_its_last_row_a_table_of_speeds_still_changes_them():
    functions = compiled(Velocity(velocity=Table(time=(0.0, 1.0, 3.0), value=(0.0, 2.0, 1.0))))
    assert value_at(functions, 0, 3.0) == pytest.approx((4.0, 1.0, -0.5), abs=1e-14)
    assert value_at(functions, 0, 3.1) == pytest.approx((4.1, 1.0, 0.0), abs=1e-14)


def test_a_run_that_begins_at_the_last_row_of_a_table_begins_held():
    functions = compiled(Table(time=(-2.0, -1.0, 0.0), value=(3.0, 1.0, 5.0)))
    assert value_at(functions, 0, 0.0) == (5.0, 0.0, 0.0)


def test_a_cubic_table_follows_a_sampled_wave_with_fourth_order():
    errors = []
    for n in (20, 40):
        t = np.linspace(0.0, 2 * np.pi, n + 1)
        functions = compiled(Table(time=tuple(t), value=tuple(np.sin(t))))
        fine = np.linspace(0.1, 6.1, 500)
        errors.append(np.abs(sample(functions, 0, fine)[:, 0] - np.sin(fine)).max())
    assert errors[1] < 1e-6 * 5
    assert math.log2(errors[0] / errors[1]) == pytest.approx(4.0, abs=0.4)


def test_a_cubic_table_has_a_continuous_second_derivative():
    t = np.array([0.0, 0.3, 1.0, 1.1, 2.0, 4.0])
    functions = compiled(Table(time=tuple(t), value=(0.0, 0.0, 1.0, 5.0, 5.0, 2.0)))
    for knot in t[1:-1]:
        before, after = value_at(functions, 0, knot - 1e-10), value_at(functions, 0, knot + 1e-10)
        assert after == pytest.approx(before, abs=1e-4)


@settings(max_examples=60, deadline=None)
@given(
    st.lists(st.tuples(st.floats(0.01, 100.0), st.one_of(st.just(0.0), st.floats(1e-3, 1e3))), min_size=2, max_size=12)
)
def test_a_cubic_table_never_overshoots_monotone_data(steps):
    t, f = np.cumsum([[0.0, 0.0], *steps], axis=0).T
    functions = compiled(Table(time=tuple(t), value=tuple(f)))
    fine = sample(functions, 0, np.linspace(0.0, t[-1], 2001))[:, 0]
    tolerance = 1e-5 * (1.0 + f[-1])
    assert np.all(np.diff(fine) > -tolerance)
    assert fine.min() > -tolerance
    assert fine.max() < f[-1] + tolerance


def test_a_sea_has_the_variance_of_its_significant_height():
    amplitude, frequency, _ = jonswap(SEA)
    assert (amplitude**2).sum() / 2 == pytest.approx((0.6 * 2.5) ** 2 / 16, rel=1e-12)
    assert 2 * np.pi / frequency[amplitude.argmax()] == pytest.approx(9.0, rel=0.1)
    record = sample(compiled(SEA), 0, np.arange(0.0, 20_000.0, 0.9))[:, 0]
    assert 4 * record.std() == pytest.approx(0.6 * 2.5, rel=0.02)


def test_a_sea_is_repeated_by_its_seed_only():
    again = jonswap(SEA.model_copy())
    other = jonswap(SEA.model_copy(update={"seed": 8}))
    assert np.array_equal(jonswap(SEA)[1], again[1])
    assert not np.array_equal(jonswap(SEA)[1], other[1])


def test_functions_of_a_scene_do_not_mix():
    models = list(FUNCTIONS.values())
    together = compile_functions([FunctionRequest(model) for model in models])
    for i, model in enumerate(models):
        assert value_at(together, i, 3.21) == value_at(compiled(model), 0, 3.21)


@entry
def _evaluate(functions, i, t, out):
    out[0], out[1], out[2] = evaluate(functions, i, t)


def test_in_the_time_loop_a_function_of_nothing_is_zero_and_the_others_are_what_they_are():
    nothing, still = Constant(value=0.0), Constant(value=2.5)
    models = [
        nothing,
        SPEEDS,
        still,
        FUNCTIONS["harmonic"],
        nothing,
        Sum(terms=(nothing, still)),
        Ramp(to=0.0, over=1.0),
    ]
    asked = [FunctionRequest(model, integrate, 20.0) for model in models for integrate in (False, True)]
    functions, out = compile_functions(asked), np.full(3, np.nan)
    for i in range(len(asked)):
        for t in (0.0, 2.5, 11.0):
            _evaluate(functions, i, t, out)
            assert out == pytest.approx(value_at(functions, i, t), rel=1e-14, abs=1e-15)
            if i in (0, 1, 8, 9):
                assert not np.any(out)


def test_no_functions_make_empty_arrays():
    functions = compile_functions([])
    assert functions.track_from.size == functions.entry.size == 0
    assert functions.waves.shape == (0, 5)


def test_a_table_of_a_hundred_thousand_rows_is_good_everywhere():
    t = np.arange(100_000) * 0.01
    functions = compiled(Table(time=tuple(t), value=tuple(np.sin(t))))
    where = np.linspace(0.0, 999.9, 3001)
    assert np.allclose(sample(functions, 0, where)[:, 0], np.sin(where), atol=1e-9)
    whole = compiled(Table(time=tuple(t), value=tuple(np.sin(t)), interpolation="cubic"), integrate=True)
    assert np.allclose(sample(whole, 0, where)[:, 0], 1.0 - np.cos(where), atol=1e-9)


def test_an_integral_in_numbers_goes_on_straight_after_its_end():
    functions = compiled(FUNCTIONS["chirp"], integrate=True, end=5.0)
    at_end, after = value_at(functions, 0, 5.0), value_at(functions, 0, 7.0)
    assert after[0] == pytest.approx(at_end[0] + 2.0 * at_end[1], abs=1e-12)


def test_an_endless_integral_in_numbers_is_refused_with_a_cure():
    with pytest.raises(SceneError, match="end earlier"):
        compiled(Chirp(amplitude=1.0, period=1e-3, rate=0.1), integrate=True, end=1e6)


def test_what_is_written_is_read_in_the_unit_of_its_place():
    read = TypeAdapter(Annotated[object, time_function("rad/s", velocity="rad/s^2")]).validate_python
    assert read("60 rpm") == Constant(value=2 * math.pi)
    assert read(3) == Constant(value=3.0)
    assert read({"ramp": {"to": "30 rpm", "over": "2 s"}}).to == pytest.approx(math.pi)
    assert read({"harmonic": {"amplitude": 1, "frequency": "2 Hz", "phase": "90 deg"}}).phase == math.pi / 2
    assert isinstance(read({"velocity": {"constant": 1}}), Velocity)
    summed = read({"sum": ["60 rpm", {"sum": [1.0, {"ramp": {"rate": 1.0, "over": 1.0}}]}]})
    assert value(compiled(summed), 0.0) == pytest.approx(2 * math.pi + 1.0)


@pytest.mark.parametrize("model", FUNCTIONS.values(), ids=FUNCTIONS)
@pytest.mark.parametrize("end", [0.0, 1.0, 11.87])
def test_a_function_stays_within_its_bounds(model, end):
    value = sample(compiled(model), 0, np.linspace(0.0, end, 5001))[:, 0]
    low, high = bounds_of(model, end)
    assert low <= value.min() + 1e-12 and value.max() - 1e-12 <= high


BOUNDED = {
    "constant": (Constant(value=2.5), (2.5, 2.5)),
    "nothing": (Constant(value=0.0), (0.0, 0.0)),
    "ramp": (Ramp(to=-2.0, over=3.0), (-2.0, 0.0)),
    "ramp that is not done": (Ramp(to=-2.0, over=3.0, at=8.5), (-1.0, 0.0)),
    "ramp rate": (Ramp(rate=0.25, over=2.0, at=1.0), (0.0, 2.0)),
    "table of straight lines": (SPEEDS, (-0.8, 0.0)),
    "table that dips for a moment": (
        Table(time=(0.0, 5.0, 5.0001, 5.0002), value=(1.0, 1.0, 0.0, 1.0), interpolation="linear"), (0.0, 1.0),
    ),
    "harmonic": (Harmonic(amplitude=0.5, period=8.0, mean=0.2), (-0.3, 0.7)),
}  # fmt: skip


@pytest.mark.parametrize(("model", "expected"), BOUNDED.values(), ids=BOUNDED)
def test_bounds_of_straight_pieces_ramps_and_sines_are_their_extremes(model, expected):
    assert bounds_of(model, 10.0) == pytest.approx(expected, abs=1e-12)
