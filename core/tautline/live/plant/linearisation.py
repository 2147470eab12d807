"""A simulation linearised about where it stands: ``x. = A x + B u``, ``y = C x + D u``.

Positions of what is free and of what is tied to it follow from coordinates y in which the constraints hold,
dq = Z y + P h, with h the prescribed degrees of freedom. The tangents give

    My y.. + Cy y. + Ky y + S s + N2 u.. + N1 u. + N0 u = 0,   s. = G0 y + G1 y. + G2 y.. + Gs s + R2 u.. + R1 u. + R0 u

with s the integrals over time that forces follow, such as that of a controller: X. = F X + H2 u.. + H1 u. + H0 u for
X = (y, y., s). Derivatives of an input are taken out of the right-hand side by shifted states, X = x + c1 u + c2 u.
with c2 = H2 and c1 = H1 + F H2; where the input is a speed w = u., u is a state, and X = x + c2 w.
Motions of a vessel or boom move the points that ride on them by their products, which are differentiated by complex
steps, to rounding (W. Squire and G. Trapp, SIAM Review 40, 1998).
"""

from __future__ import annotations

import warnings
from collections import Counter
from collections.abc import Callable, Sequence
from typing import Any, NamedTuple

import numpy as np
from scipy.linalg import null_space
from scipy.sparse import csr_array

from tautline.integrators.equations import SUMS, evaluate_full, settle
from tautline.integrators.lengths import Left, without_lengths
from tautline.integrators.time_loop import record_now
from tautline.kernels.dofs import HELD, TIED, Dofs
from tautline.kernels.groups import Integral, hold_laws, known_of, link
from tautline.kernels.matrix import dense, new_matrix
from tautline.kernels.moving_frame import places_of
from tautline.kernels.time_function import sample_all
from tautline.live.errors import SimulationError
from tautline.live.forces import calls_of, room_for_all
from tautline.live.plant.differences import AHEAD, FREE, Room, Slope, slopes
from tautline.live.plant.edges import near_said, what_is_near
from tautline.live.plant.growth import growth_said
from tautline.live.plant.limits import Limited, limits_said
from tautline.live.plant.plant import Plant
from tautline.live.plant.stuck import held_said, stuck_said, what_sticks
from tautline.scene.methods import method_of
from tautline.system.handles import Input, Output

COMPLEX_STEP = 1.0e-30
SMALL = 1.0e-5
"""Step of differences, m or rad, and the same times a frequency for speeds."""
STEPS = SMALL, SMALL, 1.0
"""Steps of the residual's differences along positions, m or rad, speeds and accelerations. It is linear in the last of
these: any step is right, and a small one would leave the rounding of the elastic forces, which grows with stiffness."""
SUMS_OVER_TIME = ("external_work", "dissipated_energy")
"""Outputs that grow with the run."""
NOTHING = 1.0e-9
"""Share of an output's largest derivative below which one is rounding."""
WHOLE = slice(None)
LATER = 1.0e-30
"""A time, s, which is as good as 0, and not that of the first frame of a run."""


class _Drive(NamedTuple):
    """What an input does: changes of h, h. and h.. by u, u. and u.. (3, 3, held), and of the residual itself and of the
    rates of integrals (3, n + integrals)."""

    held: np.ndarray
    direct: np.ndarray


class _Change(NamedTuple):
    """Changes of full q, v and a, of the integrals, and of functions and their two rates (3, inputs)."""

    q: np.ndarray
    v: np.ndarray
    a: np.ndarray
    integrals: np.ndarray
    functions: np.ndarray


def linearise(sim: Any, inputs: Sequence[str], outputs: Sequence[str]) -> Plant:
    """Linearise a simulation about where it stands; see `tautline.Simulation.linearise`."""
    both = [_names(names, what) for names, what in ((inputs, "inputs"), (outputs, "outputs"))]
    work = _Linearisation(sim, *both)
    with calls_of(work.sim.parts.forces):
        found = work.plant()
    told = *held_said(found.held), *stuck_said(work.stuck), *near_said(work.near), *limits_said(work.limits)
    for said in (*told, *growth_said(found.A, work.system, work.step)):
        warnings.warn(said, stacklevel=3)
    return found


def _names(given: Any, what: str) -> list[str]:
    """Names as a list; raises SimulationError for what is none."""
    names = [given] if isinstance(given, str) or not np.iterable(given) else list(given)
    for name in names:
        if not isinstance(name, str):
            raise SimulationError(f"{what}: {name!r} is no name", 'give names, such as ["payload.position"]')
    return names


class _Linearisation:
    """The work, on a copy of the simulation whose state is changed and evaluated."""

    def __init__(self, sim: Any, inputs: list[str], outputs: list[str]) -> None:
        self.names = [part for name in inputs for part in sim.inputs.parts_of(name)]
        self.told = outputs
        self.inputs: list[Input] = [sim.inputs.handle(name) for name in self.names]
        self.outputs: list[Output] = [sim.outputs.handle(name) for name in outputs]
        self._refuse_twice()
        self._refuse_rivals(sim)
        self._refuse_sums()
        self._refuse_jumps()
        self.sim = sim.copy()
        self.system, self.state, self.t = self.sim.model.system, self.sim.parts.state, sim.time
        hold_laws(self.system.groups)
        self.room = room_for_all(self.system, self.sim.parts.forces)
        as_it_is = self.room.groups is self.system.groups
        self.groups = self.system.link(SUMS) if as_it_is else link(self.room.groups, *SUMS)
        self.laws = self.system.link(("commit",))
        dofs, functions = self.system.dofs, self.system.functions
        held = [int(dofs.held[k]) for k in dofs.driven]
        self.held, self.motion = held, [int(dofs.motion[k]) for k in dofs.driven]
        self.extended = _with_held_free(dofs, held)
        self.places = _followers(self.extended, self.system.size + len(held))
        self.n = self.system.size
        solver = self.sim.model.solver
        # An explicit step follows every mode, or the run is stopped.
        self.step = 0.0 if method_of(solver.method).explicit else solver.step
        self.functions = functions
        self.limits: list[Limited] = []
        self.masses: np.ndarray | None = None
        self.here: dict[str, np.ndarray] = {}
        self.a = self.b = np.zeros((0, 0))
        listed = self._integrals()
        self.stuck = what_sticks(self.system, self.t)
        self._residual()  # what was noted by the last step tells nothing of a displacement since
        self.near = what_is_near(self.system, self.state, self._mass_at, SMALL)
        self.onward = self._moving_on()
        self.integrals = [one for _, integrals in listed for one in integrals]
        self.summing = link(tuple(g for g, integrals in listed if integrals), "commit")
        self.held_still = tuple(filter(None, (keeper(g) for g in self.system.groups if (keeper := known_of(g).memory))))

    def _refuse_twice(self) -> None:
        """Refuse what is given twice, a part beside its vector too: columns or rows would be of equal names."""
        parts = [part for one in self.outputs for part in _parts(one)]
        for names, what in ((self.names, "inputs"), (parts, "outputs")):
            for name, count in Counter(names).items():
                if count > 1:
                    raise SimulationError(f"{what}: {name} stands {count} times", "give each once")

    def _refuse_rivals(self, sim: Any) -> None:
        """Refuse two inputs that drive the same, as an FMU does: no run follows both at once."""
        for name in self.names:
            for other in sim.inputs.rivals(name):
                if other in self.names:
                    raise SimulationError(f"{name} and {other} drive the same", "leave one of them out of the inputs")

    def _refuse_sums(self) -> None:
        """Refuse outputs that are sums over time: no state and no input says what they are."""
        for one in self.outputs:
            if one.variable in SUMS_OVER_TIME or one.name in SUMS_OVER_TIME:
                cause = f"{one.name} is a sum over time: no A, B, C, D can say what it is"
                raise SimulationError(cause, "take a power, a force or a speed in its place")

    def _refuse_jumps(self) -> None:
        """Refuse outputs that say which of a few states something is in: they jump, and have no derivative."""
        for one in self.outputs:
            if one.jumps:
                cause = f"{one.name} jumps between a few values: no A, B, C, D can say when"
                raise SimulationError(cause, "take a force or a speed in its place")

    # -- the matrices --------------------------------------------------------------------------------------------------

    def _matrix(self, cm: float, cc: float, ck: float) -> np.ndarray:
        """One of M, C and K with rows of the unknowns and columns of these and of what is held, (n, n + held)."""
        m = len(self.held)
        matrix = new_matrix(self.n + m, self.room.bandwidth, self.system.border + m)
        residual = np.zeros(self.n + m)
        evaluate_full(self.groups, self.extended, self.state, self.t, cm, cc, ck, matrix, residual)
        return dense(matrix)[: self.n]

    def _mass_at(self, places: Sequence[int]) -> float:
        """The largest mass, kg, that moves with one of some places."""
        if self.masses is None:
            self.masses = np.abs(np.diag(self._matrix(1.0, 0.0, 0.0)))
        own = self.places[list(places)][:, : self.n]
        return float((own.multiply(own) @ self.masses).max(initial=0.0))

    def _integrals(self) -> list[tuple[Any, list[Integral]]]:
        """Groups, and those that forces follow as the state is now: an input may have been set since the last step."""
        memory = self.sim.parts.memory
        noted = memory.read()
        self._residual()
        settle(self.laws, self.state, self.t, 0.0)
        found = [(g, integrals(g)) for g in self.system.groups if (integrals := known_of(g).integrals)]
        memory.write(noted)
        return found

    def _moving_on(self) -> list[int]:
        """Full places whose laws are other ones behind where they are, which they leave."""
        q, v = self.state.full_q, self.state.full_v
        groups = self.system.groups
        return [place for g in groups if (listed := known_of(g).onward) for place in listed(g, q, v)]

    def _ahead(self, moved: np.ndarray) -> Room:
        """How far a change of full positions may be made for what moves on: ahead of where it is."""
        room = FREE
        for place in self.onward:
            room = room.both(AHEAD.along(float(moved[place])))
        return room

    def _answer(self) -> np.ndarray:
        """Residual and the rates of the integrals (n + integrals,) at the full vectors as they are."""
        residual = self._residual()
        before = [one.array.copy() for one in self.integrals]
        settle(self.summing, self.state, self.t, 1.0)
        rates = [one.array[one.at] - was[one.at] for one, was in zip(self.integrals, before, strict=True)]
        for one, was in zip(self.integrals, before, strict=True):
            one.array[:] = was
        return np.concatenate((residual, rates))

    def _residual(self) -> np.ndarray:
        residual, none = np.zeros(self.n), new_matrix(0, 0)
        evaluate_full(self.groups, self.system.dofs, self.state, self.t, 0.0, 0.0, 0.0, none, residual)
        return residual

    # -- the inputs ----------------------------------------------------------------------------------------------------

    def _drive(self, one: Input) -> _Drive:
        held = np.zeros((3, 3, len(self.held)))
        for steering, function in one.members:
            for j, number in enumerate(self.motion):
                entry = int(self.functions.entry[number])
                if number == function:
                    held[:, :, j] += steering.factor * np.eye(3)
                elif entry >= 0 and function in self.functions.frames.motion:
                    held[:, :, j] += steering.factor * self._of_frames(function)[:, :, entry // 12, entry % 12]
        return _Drive(held, self._direct(one, held))

    def _of_frames(self, function: int) -> np.ndarray:
        """Derivatives of all frames' places by a motion: (derivative of place, derivative of motion, frame, entry)."""
        frames = self.functions.frames
        k, c = (int(x) for x in np.argwhere(frames.motion == function)[0])
        now = np.zeros((frames.parent.size, 6, 3, 3), complex)
        places = np.argwhere(frames.motion >= 0)
        sampled = sample_all(self.functions, [int(frames.motion[i, j]) for i, j in places], np.array([self.t]))
        for (i, j), value in zip(places, sampled, strict=True):
            now[i, j] = value[0]
        for order in range(3):
            now[k, c, order, order] += 1.0j * COMPLEX_STEP
        placed = places_of(frames.parent, frames.pivot, now)
        return np.stack([derivative.imag / COMPLEX_STEP for derivative in placed])

    def _direct(self, one: Input, held: np.ndarray) -> np.ndarray:
        """Changes of the answer by u, u. and u.. while the unknowns stay, (3, n + integrals), by differences.

        The groups' own tangents know nothing of what is held: how the wheels of a boom turn with it, for one.
        """
        found, still = [], np.zeros(self.n)
        at = [(s, f, sample_all(self.functions, [f], np.array([self.t]))[0, 0]) for s, f in one.members]
        for order in range(3):
            moved = [self._full(still, held[d, order]) for d in range(3)]
            largest = max(float(np.abs(each).max(initial=0.0)) for each in moved)
            # A force or a set value stands in the equations once: any step will do.
            own = 1.0e-3 * max(1.0, *(abs(f[order]) for _, _, f in at))
            step = STEPS[order] / largest if largest > 0.0 else own

            def steer(h: float, order: int = order) -> None:
                for steering, function, f in at:
                    changed = f.copy()
                    changed[order] += h * steering.factor
                    self.sim.inputs.hold(function, self.t, changed)

            given = order == one.steering.order
            slope = self._slope(moved, step, steer, self._room(one) if given else FREE)
            if given:
                self._note_limit(one, slope)
            found.append(slope.value)
        for _, function, f in at:
            self.sim.inputs.hold(function, self.t, f)
        return np.array(found)

    def _room(self, one: Input) -> Room:
        """How far an input is from the least and the most that may be given."""
        steering, function = one.members[0]
        value = sample_all(self.functions, [function], np.array([self.t]))[0, 0, steering.order] / steering.factor
        return Room(max(0.0, value - steering.least), max(0.0, steering.most - value))

    def _note_limit(self, one: Input, slope: Slope) -> None:
        """Note an input that does something else when it rises than when it falls."""
        if slope.limited:
            differ = np.argmax(np.abs(slope.above - slope.below))
            above, below = -float(slope.above[differ]), -float(slope.below[differ])  # the residual is less the forces
            self.limits.append(Limited(one.steering, above, below))

    def _slope(
        self, moved: Sequence[np.ndarray], step: float, besides: Callable[[float], None], room: Room = FREE,
        part: slice = WHOLE,
    ) -> Slope:  # fmt: skip
        """Derivative of a part of the answer along changes of full q, v and a and of what else changes."""
        state = self.state
        vectors = state.full_q, state.full_v, state.full_a
        kept = [array.copy() for array in (*vectors, state.residual)]

        def sample(h: float) -> dict[str, np.ndarray]:
            for array, before, change in zip(vectors, kept, moved, strict=False):
                array[:] = before + h * change
            besides(h)
            return {"": self._answer()[part]}

        found = slopes(sample, step, room.both(self._ahead(moved[0])))[""]
        for array, before in zip((*vectors, state.residual), kept, strict=True):
            array[:] = before
        return found

    def _by_integral(self, one: Integral) -> np.ndarray:
        """How the answer follows an integral (n + integrals,)."""
        before = float(one.array[one.at])

        def change(h: float) -> None:
            one.array[one.at] = before + h

        still = np.zeros(self.places.shape[0])
        found = self._slope([still] * 3, 1.0e-3 * max(1.0, abs(before)), change).value
        change(0.0)
        return found

    def _rates_by_motion(self) -> np.ndarray:
        """How the rates of integrals follow the free unknowns, their speeds and accelerations (3, integrals, free)."""
        found = np.zeros((3, len(self.integrals), self.free.size))
        if not self.integrals:
            return found
        still, held = np.zeros(self.places.shape[0]), np.zeros(len(self.held))
        for j, moving in enumerate(self.free):
            full = self._full(np.eye(1, self.n, int(moving))[0], held)
            for order in range(3):
                moved = [full if d == order else still for d in range(3)]
                step = STEPS[order] / np.abs(full).max()
                found[order, :, j] = self._slope(moved, step, lambda h: None, part=slice(self.n, None)).value
        return found

    # -- the plant -----------------------------------------------------------------------------------------------------

    def plant(self) -> Plant:
        """All of it."""
        self._project()
        size = self.inner + len(self.speeds)
        a, b = np.zeros((size, size)), np.zeros((size, len(self.inputs)))
        x = slice(0, self.inner)
        a[x, x] = self.first_order
        for i, ((h0, h1, _), (c1, c2)) in enumerate(zip(self.driven, self.shifts, strict=True)):
            if i in self.speeds:
                own = self.inner + self.speeds.index(i)
                a[x, own], b[own, i] = h0, 1.0
                b[x, i] = h1 + self.first_order @ c2
            else:
                b[x, i] = h0 + self.first_order @ c1
        self.a, self.b = a, b
        c, d, e = self._read()
        units = {name: one.steering.unit for name, one in zip(self.names, self.inputs, strict=True)}
        units |= {part: one.unit for one in self.outputs for part in _parts(one)}
        told = tuple(part for one in self.outputs for part in _parts(one))
        kept, whole = self._without_lengths()
        a, b, c = (a @ whole)[kept], b[kept], c @ whole
        states = tuple(np.array(self._state_names(), dtype=object)[kept])
        frozen = self.held_still, *(tuple(one.told for one in found) for found in (self.stuck, self.near))
        return Plant(a, b, c, d, e, states, tuple(self.names), told, units, self.t, *frozen)

    def _without_lengths(self) -> Left:
        """The states but for the lengths of vectors of which only the direction counts."""
        directions, rates = [], []
        for places in (one for g in self.system.groups if (lengths := known_of(g).lengths) for one in lengths(g)):
            moved = self.places[places][:, self.free].toarray() @ self.z
            along = self.state.full_q[places] @ moved
            if np.any(along):
                directions.append(along)
                rates.append(self.state.full_v[places] @ moved)
        shape = len(directions), self.count
        return without_lengths(np.reshape(directions, shape), np.reshape(rates, shape), len(self.a))

    def _project(self) -> None:
        """Coordinates within the constraints, and the equations in them, divided by the mass."""
        n, algebraic = self.n, self.system.algebraic
        mass, damping, stiffness = (self._matrix(*part) for part in np.eye(3))
        self.free = free = np.setdiff1d(np.arange(n), algebraic)
        self.z, self.p = z, p = _within_constraints(mass, stiffness, algebraic, free, n)
        self.count = z.shape[1]
        m, c, k = (z.T @ part[np.ix_(free, free)] @ z for part in (mass, damping, stiffness))
        # What a prescribed degree of freedom moves with it by the constraints.
        carried = [z.T @ part[np.ix_(free, free)] @ p for part in (stiffness, damping, mass)]
        rates = self._rates_by_motion()
        by = np.array([self._by_integral(one) for one in self.integrals]).reshape(-1, n + len(self.integrals)).T
        forces = np.hstack((k, c, z.T @ by[free]))
        count, self.inner = self.count, 2 * self.count + len(self.integrals)
        follow = np.hstack((rates[0] @ z, rates[1] @ z, by[n:]))
        self.first_order = self._explicit(m, forces, rates[2] @ z, follow)
        self.first_order[:count, count : 2 * count] = np.eye(count)
        self.drives = [self._drive(one) for one in self.inputs]
        # (inputs, order, states): what u, u. and u.. add to the rates of the states.
        self.driven = []
        for drive in self.drives:
            # K multiplies h, C its rate and M its second rate.
            held = [sum(carried[d] @ drive.held[d, order] for d in range(3)) for order in range(3)]
            also = [sum(rates[d] @ p @ drive.held[d, order] for d in range(3)) for order in range(3)]
            force = np.array([z.T @ drive.direct[o][free] + held[o] for o in range(3)]).T
            rate = np.array([drive.direct[o][n:] + also[o] for o in range(3)]).T
            self.driven.append(self._explicit(m, force, rates[2] @ z, rate).T)
        self.speeds = [i for i, one in enumerate(self.inputs) if one.steering.order == 1]
        self.shifts = [
            (h1 if i in self.speeds else h1 + self.first_order @ h2, h2) for i, (_, h1, h2) in enumerate(self.driven)
        ]

    def _explicit(self, mass: np.ndarray, forces: np.ndarray, felt: np.ndarray, rates: np.ndarray) -> np.ndarray:
        """Rates of the states (y, y., s) by columns of forces and of rates of integrals, which may feel y.. too."""
        accelerations = -np.linalg.solve(mass, forces)
        return np.vstack((np.zeros_like(accelerations), accelerations, rates + felt @ accelerations))

    def _state_names(self) -> tuple[str, ...]:
        whole = self.count == self.free.size
        names = self._unknowns() if whole else [f"coordinate {i + 1}" for i in range(self.count)]
        values = [self.names[i].removesuffix("_speed") for i in self.speeds]
        owners = [self.system.places[one.place].partition(":")[0] for one in self.integrals]
        sums = [f"{owner}: {one.text}" for owner, one in zip(owners, self.integrals, strict=True)]
        return (*names, *(f"d/dt {name}" for name in names), *sums, *values)

    def _unknowns(self) -> list[str]:
        """Names of the free unknowns. Those of one name are numbered in the order in which the scene has them."""
        names = [self.system.names[i] for i in self.free]
        numbers, counts = [0] * len(names), Counter(names)
        seen: Counter[str] = Counter()
        for i in np.argsort(self.system.dofs.free[self.free]):
            seen[names[i]] += 1
            numbers[i] = seen[names[i]]
        return [f"{name} {k}" if counts[name] > 1 else name for name, k in zip(names, numbers, strict=True)]

    # -- the outputs ---------------------------------------------------------------------------------------------------

    def _read(self) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """C, D and E: derivatives of the outputs along every state, every input and the rate of every input."""
        states, inputs = np.eye(len(self.a)), np.eye(len(self.inputs))
        nothing = np.zeros(len(self.a)), np.zeros(len(self.inputs)), np.zeros(len(self.inputs))
        self.extremes = self._places_of_extremes()
        self.here = (
            self._outputs_at(0.0, self._motion(*nothing)) if any(one.places is None for one in self.outputs) else {}
        )
        c = [self._along(self._motion(x, *nothing[1:])) for x in states]
        d = [self._along(self._motion(nothing[0], u, nothing[2])) for u in inputs]
        e = [self._along(self._motion(*nothing[:2], rate)) for rate in inputs]
        count = sum(int(np.prod(one.shape, dtype=int)) for one in self.outputs)
        read = [np.array(rows).reshape(len(rows), count).T for rows in (c, d, e)]
        self._refuse_rates(*read)
        return read[0], read[1], read[2]

    def _refuse_rates(self, c: np.ndarray, d: np.ndarray, e: np.ndarray) -> None:
        """Refuse an input that is a position and an output that follows its rate at once."""
        parts = [part for one in self.outputs for part in _parts(one)]
        for i, one in enumerate(self.inputs):
            if one.steering.order == 1 or not parts:
                continue
            most = np.maximum(np.abs(c).max(axis=1, initial=0.0), np.abs(d[:, i]))
            wrong = np.abs(e[:, i]) > NOTHING * most
            if wrong.any():
                cause = f"{parts[int(np.argmax(wrong))]} follows the rate of {self.names[i]} at once"
                cure = f"take {self._speed_of(self.names[i])} in its place"
                raise SimulationError(f"{cause}: no A, B, C, D can say that", cure)
            e[:, i] = 0.0

    def _speed_of(self, name: str) -> str:
        """The input that gives the rate of the same function, if there is one."""
        function = self.sim.inputs.handle(name).members[0][1]
        for other in self.sim.inputs:
            (steering, number), *_ = self.sim.inputs.handle(other).members
            if number == function and steering.order == 1:
                return other
        return "an output that is a position"

    def _motion(self, x: np.ndarray, u: np.ndarray, rate: np.ndarray) -> _Change:
        """What states, inputs and their rates stand for."""
        count, values = self.count, np.zeros((3, u.size))
        now, later = x[: self.inner].copy(), (self.a @ x + self.b @ u)[: self.inner]
        for i, (c1, c2) in enumerate(self.shifts):
            if i in self.speeds:
                values[:, i] = x[self.inner + self.speeds.index(i)], u[i], rate[i]
                now += c2 * u[i]
                later += c2 * rate[i]
            else:
                values[:2, i] = u[i], rate[i]
                now += c1 * u[i] + c2 * rate[i]
                later += c1 * rate[i]
        y, y_d, y_dd = now[:count], now[count : 2 * count], later[count : 2 * count]
        held = sum((np.einsum("doh,o->dh", drive.held, values[:, i]) for i, drive in enumerate(self.drives)),
                   np.zeros((3, len(self.held))))  # fmt: skip
        found = []
        for motion, moved in zip((y, y_d, y_dd), held, strict=True):
            reduced = np.zeros(self.n)
            reduced[self.free] = self.z @ motion + self.p @ moved
            found.append(self._full(reduced, moved))
        return _Change(found[0], found[1], found[2], now[2 * count :], values)

    def _full(self, reduced: np.ndarray, moved: np.ndarray) -> np.ndarray:
        """Full vector of a change of the unknowns and of what is held."""
        full: np.ndarray = self.places @ np.concatenate((reduced, moved))
        return full

    def _along(self, change: _Change) -> np.ndarray:
        """Derivative of all outputs along a direction: exact of positions and velocities, else by differences."""
        parts = []
        differences = self._differences(change) if self.here else {}
        for one in self.outputs:
            if one.places is not None:
                vector, places = one.places
                parts.append(np.ravel((change.q if vector == "q" else change.v)[places]))
            else:
                parts.append(np.ravel(differences[one.name]))
        return np.concatenate(parts) if parts else np.zeros(0)

    def _differences(self, change: _Change) -> dict[str, np.ndarray]:
        """Derivatives of the compiled outputs along a direction."""
        q, v, a = (float(np.abs(part).max(initial=0.0)) for part in change[:3])
        largest = max(q, v / self._rate) or a / self._rate**2 or 1.0
        room = self._ahead(change.q)
        for i, one in enumerate(self.inputs):
            room = room.both(self._room(one).along(float(change.functions[one.steering.order, i])))
        found = slopes(lambda h: self._outputs_at(h, change), SMALL / largest, room, self.here)
        return {name: slope.value for name, slope in found.items()}

    def _outputs_at(self, h: float, change: _Change) -> dict[str, np.ndarray]:
        """The compiled outputs a step along a direction; all is put back."""
        state = self.state
        memory = self.sim.parts.memory
        noted = memory.read()
        vectors = state.full_q, state.full_v, state.full_a, state.residual
        kept = [array.copy() for array in vectors]
        steered = [(f, s, i) for i, one in enumerate(self.inputs) for s, f in one.members]
        at = {f: sample_all(self.functions, [f], np.array([self.t]))[0, 0] for f, _, _ in steered}
        for array, part in zip(vectors, change[:3], strict=False):
            array += h * part
        for integral, grown in zip(self.integrals, change.integrals, strict=True):
            integral.array[integral.at] += h * grown
        for function, steering, i in steered:
            self.sim.inputs.hold(function, self.t, at[function] + h * steering.factor * change.functions[:, i])
        frame = self._observed()
        found = {one.name: self._value(one, frame) for one in self.outputs if one.places is None}
        memory.write(noted)
        for array, before in zip(vectors, kept, strict=True):
            array[:] = before
        for function, before in at.items():
            self.sim.inputs.hold(function, self.t, before)
        return found

    def _observed(self) -> Any:
        """Variables of one frame of the state as it stands; laws note what they note at the end of a step."""
        _, method, frames, _, _ = self.sim.parts
        self._residual()
        # What a law notes at the end of a step, such as a drive its torque and a contact its force, is of now.
        settle(self.laws, self.state, self.t, 0.0)
        # The first frame of a run may tell of what was before any motion; a plant is of a state that moves.
        record_now(method, self.system, self.state, self.t or LATER, frames.rows[0])
        return self.sim.model.observe(frames)

    def _value(self, one: Output, frame: Any) -> np.ndarray:
        """A compiled output of a frame; of a largest or smallest one the value where it is found now."""
        if one.source:
            return np.array(np.ravel(frame[one.source][0])[self.extremes[one.name]], dtype=float)
        return np.array(one.value(frame), dtype=float)

    def _places_of_extremes(self) -> dict[str, int]:
        """Where each largest or smallest value stands among those that it is taken of.

        A change that is as small as one likes leaves it there. One of 1e-5 m changes the tension of a stiff rope by
        more than the tensions of its elements differ, and the largest would leap from one to another.
        """
        memory = self.sim.parts.memory
        noted = memory.read()
        frame = self._observed()
        memory.write(noted)
        some = [one for one in self.outputs if one.source]
        return {one.name: int(np.argmin(np.abs(frame[one.source][0] - one.value(frame)))) for one in some}

    @property
    def _rate(self) -> float:
        """A frequency by which speeds are compared with positions, 1/s."""
        return 10.0


def _parts(output: Output) -> list[str]:
    """Names of the parts of an output: one, or one for each number of an array."""
    if output.shape == ():
        return [output.name]
    return [f"{output.name}[{','.join(map(str, place))}]" for place in np.ndindex(*output.shape)]


def _followers(dofs: Dofs, unknowns: int) -> csr_array:
    """How all degrees of freedom follow the unknowns (full, unknowns)."""
    known = dofs.unknown >= 0
    rows = np.repeat(np.arange(dofs.number.size), np.diff(dofs.start))
    size = (dofs.number.size, unknowns)
    return csr_array((dofs.factor[known], (rows[known], dofs.unknown[known])), shape=size)


def _with_held_free(dofs: Dofs, held: list[int]) -> Dofs:
    """The map with what follows functions of time as further unknowns, numbered last."""
    number_of = {place: int(dofs.free.size) + j for j, place in enumerate(held)}
    masters: list[list[tuple[int, float]]] = []
    for i in range(dofs.number.size):
        if i in number_of:
            masters.append([(number_of[i], 1.0)])
            continue
        part = range(dofs.start[i], dofs.start[i + 1])
        own = [(int(dofs.unknown[k]), float(dofs.factor[k])) for k in part]
        masters.append([(number_of.get(-1 - k, k) if k < 0 else k, factor) for k, factor in own])
    numbers = []
    for own in masters:
        known = [(k, factor) for k, factor in own if k >= 0]
        single = len(known) == 1 and known[0][1] == 1.0
        numbers.append(HELD if not known else known[0][0] if single else TIED)
    start = np.cumsum([0] + [len(own) for own in masters])
    return dofs._replace(
        start=start.astype(np.int64),
        unknown=np.array([k for own in masters for k, _ in own], dtype=np.int64),
        factor=np.array([factor for own in masters for _, factor in own], dtype=float),
        number=np.array(numbers, dtype=np.int64),
        free=np.concatenate((dofs.free, np.array(held, dtype=np.int64))),
        runs=np.zeros(0, dtype=np.int64),
    )


def _within_constraints(
    mass: np.ndarray, stiffness: np.ndarray, algebraic: np.ndarray, free: np.ndarray, n: int
) -> tuple[np.ndarray, np.ndarray]:
    """Coordinates in which the constraints hold: dq = Z y + P h of free unknowns and what is held."""
    held = mass.shape[1] - n
    if not algebraic.size:
        return np.eye(free.size), np.zeros((free.size, held))
    # The rows of multipliers hold the constraints' factors: beside positions where steps are implicit, else beside
    # accelerations.
    rows = stiffness[algebraic] if np.any(stiffness[algebraic]) else mass[algebraic]
    g, by_held = rows[:, free], rows[:, n:]
    return null_space(g), -np.linalg.pinv(g) @ by_held
