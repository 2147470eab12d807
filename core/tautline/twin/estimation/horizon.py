"""The estimate by a moving horizon: Gauss-Newton over the last seconds, with a prior from all that was before.

Measured values y of a window are compared with those that simulations compute, y0 at the parameters theta0 and their
derivatives J. The estimate minimises

    (theta - m)' L (theta - m) + sum over the window of (y - y0 - J (theta - theta0))' W (y - y0 - J (theta - theta0)),

with the prior's mean m and information L. What leaves the window is added to the prior (C. V. Rao, J. B. Rawlings and
D. Q. Mayne, IEEE Trans. Automatic Control 48, 2003, "arrival cost"); a random walk takes information away again.

W is the inverse of the sensor's variance, times the number of samples that count as one: residuals that are alike from
sample to sample, from an oscillation that the simulation does not have or from noise of the inputs, tell less than
their number (the integrated autocorrelation time).
"""

from __future__ import annotations

from collections import deque
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from tautline.twin.map.plan import Channel, Unknown
from tautline.twin.pace import ONE_STAMP

LARGEST_RESIDUAL = 4.0
"""Residuals beyond so many scales of the window count less (Huber)."""
CONTRADICTION = 30.0
"""Squared distance of the window's own estimate from the prior, in standard deviations, beyond which the prior is
released."""
ANOTHER = 200.0
"""By how much the squares of the last samples, in standard deviations, have to fall with an estimate of their own for
what was before to be forgotten: how much noise is alike from sample to sample is hardly known of so few."""
BOTH_WAYS = 2
"""Samples of which a derivative has either sign."""
EXPLAINED = 0.2
"""Share of them that may be left then."""
LASTING = 0.6
"""Share of the window over which that has to last."""
TINY = 1e-4
"""Information, over that of the start, that a window has of what it does not see."""
TENTH = 0.1
"""Standard deviation, over that of the start, from which on downwards the sensors have shown a number; and over the
number itself, from which on downwards it was known before."""
UNSEEN = 0.7
"""Standard deviation, over that of the start, from which on a number is not known."""
MEMORY = 10.0
"""Windows over which autocorrelation is averaged."""
FLOOR = 0.1
"""Share of the largest value seen below which noise that is given as a share does not fall."""
UNSURE = 1.25
"""By how much the autocorrelation time of so few residuals may be too short."""
SHORT = 1.6
"""By how much the sum of autocorrelations of a window is too small."""
FULL = 0.95
"""Share of a window over which samples go that fill it: the next one may be late."""
BENT = 0.5
"""Share of the way from where it was linearised by which an estimate may be wrong."""
MISSED, MOST_MISSED = 2.0, 100.0
"""Time over which it is averaged by how much rows miss what is expected of them, s; and standard deviations of the
sensor that one counts as at most."""
FEWEST, NORMAL = 8, 0.6745
"""Samples of which a spread is told; and the median of the size of normal noise, in standard deviations."""
FAR_LESS = 4.0
"""How many times less a window leaves unexplained, linearised anew, where what was left before was no noise."""
MANY_WILD = 0.25
"""Share of a window's rows that are not used, as nothing in them can be believed, from which on it tells too little."""
ONE_ROW = 0.1
"""Share of a window for which one row counts at most."""
SEEN_OFF = 3.0
"""Standard deviations of the mean residual of a window from which on it is no noise: a sensor is off for good."""
ROUGH = 0.01
"""Standard deviation over the reading where none is given, until residuals tell."""

Stacked = tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray, np.ndarray]


@dataclass
class Sample:
    """One sample of the window: y, y0 (m,), J (m, k), which of the m count, and of how many rows each is the mean."""

    time: float
    y: np.ndarray
    y0: np.ndarray
    J: np.ndarray
    use: np.ndarray
    rows: np.ndarray | float = 1.0

    def __post_init__(self) -> None:
        self.rows = np.broadcast_to(self.rows, self.y0.shape)


def mean_of(samples: Sequence[Sample]) -> Sample:
    """The mean of samples, of each sensor over those that count: what swings about it is no part of it."""
    use = np.array([one.use & np.isfinite(one.y) for one in samples])
    rows = use.sum(axis=0)
    weight = use / np.maximum(rows, 1)
    y = np.einsum("nm,nm->m", weight, np.where(use, [one.y for one in samples], 0.0))
    y0 = np.einsum("nm,nm->m", weight, np.array([one.y0 for one in samples]))
    J = np.einsum("nm,nmk->mk", weight, np.array([one.J for one in samples]))
    return Sample(samples[-1].time, np.where(rows > 0, y, np.nan), y0, J, rows > 0, np.maximum(rows, 1.0))


class Horizon:
    """The estimate and its standard deviations.

    Parameters
    ----------
    unknowns : list of Unknown
        k, those of free motions last.
    channels : list of Channel
        Sensors that are compared, m.
    window : float
        s.
    free : int
        How many of the unknowns are free motions, known anew in every window.
    late : int
        How many of the last samples are held against all others, where the window is long; 0 for none. What they
        contradict is forgotten: the thing itself has changed, and nobody waits for half of five minutes to be told.

    Attributes
    ----------
    theta0 : (k,)
        Where the simulations were linearised.
    mean, covariance : (k,), (k, k)
        The estimate.
    largest : (m,)
        Largest value seen, SI; what the application expects, before there is any.
    rough : (m, k)
        Scatter of the derivatives about their steady part.
    variance, alike, learned : (m,)
        Of what is left unexplained: its variance where no noise is given, over how many samples it stays alike, and
        how often that was learned.
    shaken : bool
        Whether inputs are so noisy that the load bounces in the simulation by that.
    missed : (m,)
        Mean square by which rows missed lately what was expected of them, in variances of the sensor.
    told : (m,), missed_at : float
        How far that mean is known, 0 to 1, and the time at which it was last followed, s.
    wild, wild_at : float
        Share of the rows of about a window that were not used, as none of their derivatives could be believed; and the
        time at which that was last followed, s.
    left : (m,)
        Square of what is left of the window at the estimate, in variances of the sensor: `spread`, and what all of its
        rows have in common.
    lasting : (k,)
        Standard deviations of what sensors that are off for good make of the estimate, however many rows say the same.
    drift : (m,)
        Mean by which rows of a sensor that drifts missed lately what was expected, in its standard deviations; else 0.
    beyond : (k,)
        How far beyond its range each unknown would stand without it, in standard deviations.
    released : float
        Time at which the prior was released for the last time; minus infinity.
    since, changed : float
        Time from which samples count, as what was before it was forgotten, and when that was; minus infinity.
    found : bool
        Whether the estimate is a guess no more. That stays, however little the sensors show of it later on, until the
        estimate starts anew.
    blur, blurs : (m,), float
        Standard deviations of what the sensors show of what nobody measures, and over how many rows that is alike.
    begun : float
        Time of the first sample since the estimate has started anew; NaN before it.
    """

    MADE_ANEW = (
        "late", "unknowns", "channels", "window", "free", "start", "first_sd", "low", "high", "walk", "sd", "relative",
        "bent",
    )  # fmt: skip
    """What another process has of the map, and need not keep."""

    def __init__(
        self, unknowns: Sequence[Unknown], channels: Sequence[Channel], window: float, free: int = 0, late: int = 0
    ) -> None:
        self.late, self.since, self.changed = late, -np.inf, -np.inf
        self.unknowns, self.channels, self.window = list(unknowns), list(channels), window
        k, m = len(self.unknowns), len(self.channels)
        self.free = np.arange(k) >= k - free
        # The offset of a sensor is added to what is computed, wherever that is.
        self.bent = ~self.free & ~np.array([one.is_offset for one in self.unknowns], bool)
        self.start = np.array([one.start for one in unknowns])
        self.first_sd = np.array([one.sd for one in unknowns])
        self.low = np.array([one.low for one in unknowns])
        self.high = np.array([one.high for one in unknowns])
        self.walk = np.array([one.drift for one in unknowns]) ** 2
        self.sd = np.array([one.sd for one in channels])
        self.relative = np.array([one.relative for one in channels], bool)
        self.theta0, self.mean = self.start.copy(), self.start.copy()
        self.prior_mean = self.start.copy()
        self.prior = np.diag(1.0 / self.first_sd**2) if k else np.zeros((0, 0))
        self.prior_time = np.nan
        self.covariance = np.linalg.inv(self.prior) if k else np.zeros((0, 0))
        self.samples: deque[Sample] = deque()
        self.spread, self.correlation = np.ones(m), np.ones(m)
        self.at_bound = np.zeros(k, bool)
        self.beyond, self.lasting, self.left = np.zeros(k), np.zeros(k), np.zeros(m)
        self.released, self._contradicted = -np.inf, np.nan
        self.drift = np.zeros(m)
        self.rough = np.zeros((m, k))
        self.largest = np.zeros(m)
        self.shaken = False
        self.missed, self.told, self.missed_at = np.zeros(m), np.zeros(m), np.nan
        self.wild, self.wild_at = 0.0, np.nan
        self.variance = np.zeros(m)
        self.alike, self.learned = np.ones(m), np.zeros(m)
        self._anew, self._carried, self._carried_at = False, 0.0, -np.inf
        self._told = 0  # readings since `lasting` was found
        self.found, self.begun = False, np.nan
        self.blur, self.blurs = np.zeros(m), 1.0

    # -- samples -------------------------------------------------------------------------------------------------------

    def add(self, sample: Sample) -> None:
        """Take a sample into the window, and those that are too old out of it."""
        self.samples.append(sample)
        self._told += bool((sample.use & np.isfinite(sample.y)).any())
        self.largest = np.maximum(self.largest, np.where(sample.use, np.abs(sample.y), 0.0))
        if not np.isfinite(self.prior_time):
            self.prior_time = sample.time
        if not np.isfinite(self.begun):
            self.begun = sample.time
        while self.samples[0].time < sample.time - self.window - ONE_STAMP:
            self._leave(self.samples.popleft())
        self._forget_what_changed()
        self.solve()

    def replaced(self, samples: Sequence[Sample], theta0: np.ndarray) -> None:
        """The same window, linearised elsewhere, with the free motions at its begin unknown anew."""
        shift = np.abs(theta0 - self.theta0)[self.bent] / self.first_sd[self.bent]
        self._carried = max(self._states_off(samples[-1].time), float(shift.max(initial=0.0)) ** 2)
        self._carried_at = samples[-1].time
        self.samples, self.theta0 = deque(samples), theta0.copy()
        lasting = ~self.free
        if self.free.any():
            known = np.linalg.inv(np.linalg.inv(self.prior)[np.ix_(lasting, lasting)])
            self.prior = np.diag(1.0 / self.first_sd**2)
            self.prior[np.ix_(lasting, lasting)] = known
            self.prior_mean = np.where(self.free, 0.0, self.prior_mean)
            self.mean = np.where(self.free, 0.0, self.mean)
            self._anew = True
        else:
            # What was left unexplained was left by a linearisation elsewhere.
            self.learned[:] = 0.0
        self.solve()
        self._anew = False

    def begin_again(self) -> None:
        """Forget all samples, and how well the estimate is known; the estimate is the start of a new one."""
        self.samples.clear()
        self.prior_mean = np.where(self.free, 0.0, np.clip(self.mean, self.low, self.high))
        self.prior = np.diag(1.0 / self.first_sd**2)
        self.prior_time = np.nan
        self.found, self.begun = False, np.nan
        self.learned[:] = 0.0
        self.lasting, self.left = np.zeros_like(self.lasting), np.zeros_like(self.left)
        self.mean, self.covariance = self.prior_mean.copy(), np.diag(self.first_sd**2)

    @property
    def is_full(self) -> bool:
        """Whether the samples go over the window."""
        return bool(self.samples) and self.samples[-1].time - self.samples[0].time >= FULL * self.window

    def cost(self, samples: Sequence[Sample], theta0: np.ndarray, anew: bool) -> float:
        """Mean square of what a window leaves unexplained, in standard deviations, at its own best estimate.

        Parameters
        ----------
        anew : bool
            Whether free motions are unknown anew in these samples; else they are as far as they are known.
        """
        y, y0, J, use, sd = self._stacked(samples)
        weight = np.where(use, 1.0 / sd**2, 0.0)
        lasting = ~self.free
        prior, mean = self.prior, self.prior_mean
        if anew and self.free.any():
            prior, mean = np.diag(1.0 / self.first_sd**2), np.where(self.free, 0.0, mean)
            prior[np.ix_(lasting, lasting)] = np.linalg.inv(np.linalg.inv(self.prior)[np.ix_(lasting, lasting)])
        r = np.where(use, y - y0, 0.0)
        total = prior + np.einsum("nmi,nm,nmj->ij", J, weight, J)
        theta = np.linalg.solve(total, prior @ (mean - theta0) + np.einsum("nmi,nm,nm->i", J, weight, r))
        left = r - J @ theta
        return float(np.sum(weight * left**2) / max(1, np.count_nonzero(use)))

    def drop_before(self, time: float) -> None:
        """Let samples before a time, s, leave the window."""
        while self.samples and self.samples[0].time < time - ONE_STAMP:
            self._leave(self.samples.popleft())

    def _leave(self, sample: Sample) -> None:
        """What a sample tells goes into the prior."""
        if not self.unknowns:
            return
        self._walk_to(sample.time)
        info, pull = self._information_of(self._stacked([sample]), of_line=self._of_line(sample))
        total = self.prior + info
        self.prior_mean = np.linalg.solve(total, self.prior @ self.prior_mean + pull)
        self.prior = total

    def _of_line(self, sample: Sample) -> np.ndarray:
        """Variances (m,) of what a sample is off by where its line is followed as far as to the estimate.

        Samples of a window are off alike: all together they tell no more than one of them that has this error alone.
        """
        return (1 + len(self.samples)) * np.sum((sample.J * self._off_line(sample.time)) ** 2, axis=-1)

    def _off_line(self, time: float) -> np.ndarray:
        """What the estimate (k,) may be wrong by as machines bend away from their derivatives: by the way squared.

        The way from where it was linearised, or that by which the states were moved at the begin of the window.
        """
        moved = float((np.abs(self.mean - self.theta0)[self.bent] / self.first_sd[self.bent]).max(initial=0.0))
        return np.where(self.bent, BENT * max(moved**2, self._states_off(time)) * self.first_sd, 0.0)

    def _states_off(self, time: float) -> float:
        """The square of the way, in deviations of the start, by which states were moved, as far as it lasts.

        What a state is off by then, a machine forgets within about a window; a free motion is estimated.
        """
        if self.free.any() or not self._carried > 0.0:
            return 0.0
        return self._carried * float(np.exp(-max(0.0, time - self._carried_at) / self.window))

    def _walk_to(self, time: float) -> None:
        """Take information away from the prior as time goes by."""
        passed, self.prior_time = time - self.prior_time, time
        if passed > 0.0 and self.walk.any():
            spread = np.linalg.inv(self.prior) + np.diag(self.walk * passed)
            self.prior = np.linalg.inv(spread)

    # -- the estimate --------------------------------------------------------------------------------------------------

    def deviations(self, y0: np.ndarray) -> np.ndarray:
        """Standard deviations of the sensors (..., m), with what nobody measures."""
        given = np.where(self.relative, self.sd * np.maximum(np.abs(y0), FLOOR * self.largest), self.sd)
        found = np.maximum(np.sqrt(self.variance), 1e-12)
        guess = np.where(self.variance > 0.0, found, ROUGH * np.abs(y0) + 1e-12)
        return np.hypot(np.where(np.isfinite(given), np.maximum(given, 1e-12), guess), self.blur)

    def _noise(self, samples: Sequence[Sample], y0: np.ndarray) -> np.ndarray:
        """Standard deviations of samples (n, m): that of a mean is smaller. Of rows that are alike each tells less."""
        alike = np.sqrt(max(self.blurs - 1.0, 0.0)) * self.blur
        return np.hypot(self.deviations(y0), alike) / np.sqrt(np.array([s.rows for s in samples]))

    def _stacked(self, samples: Sequence[Sample]) -> Stacked:
        """Samples as arrays: y, y0 (n, m), J (n, m, k), which count, and standard deviations (n, m)."""
        y = np.array([s.y for s in samples])
        y0 = np.array([s.y0 for s in samples])
        J = np.array([s.J for s in samples])
        use = np.array([s.use for s in samples]) & np.isfinite(y)
        return y, y0, J, use, self._noise(samples, y0)

    def _information(self, samples: Sequence[Sample]) -> tuple[np.ndarray, np.ndarray]:
        """J' W J and J' W (y - y0 + J theta0) of samples, with the estimate's residuals for the weights."""
        return self._information_of(self._stacked(samples))

    def _information_of(
        self, stacked: Stacked, alone: bool = False, of_line: np.ndarray | float = 0.0
    ) -> tuple[np.ndarray, np.ndarray]:
        """The same of samples that were stacked, with variances (m,) of what their line is off by."""
        y, y0, J, use, _ = stacked
        _, weight = self._weighed(stacked, alone, of_line)
        info = np.einsum("nmi,nm,nmj->ij", J, weight, J)
        wanted = np.where(use, y - y0, 0.0) + J @ self.theta0
        return info, np.einsum("nmi,nm,nm->i", J, weight, wanted)

    def _weighed(
        self, stacked: Stacked, alone: bool = False, of_line: np.ndarray | float = 0.0
    ) -> tuple[np.ndarray, np.ndarray]:
        """Residuals of samples (n, m) at the estimate, and what they weigh."""
        y, y0, J, use, plain = stacked
        residual = np.where(use, y - y0, 0.0) - J @ (self.mean - self.theta0)
        # A derivative that scatters is wrong by as much, and what it is multiplied by is not known better than this.
        sd = np.sqrt(plain**2 + np.sum((self.rough * self.linear_deviation) ** 2, axis=-1))
        # Residuals show what scattering derivatives make of them too: it does not count twice. Times each other the two
        # would let an estimate that is not known keep all samples from telling of it.
        spread = np.maximum(sd, plain * np.sqrt(np.maximum(1.0, self.spread)))
        scale = spread
        if alone and len(y) >= FEWEST:
            # What all samples have in common is no outlier.
            residual = residual - np.median(residual, axis=0)
            scale = np.maximum(scale, np.median(np.abs(residual), axis=0) / NORMAL)
        far = np.abs(residual) / (LARGEST_RESIDUAL * scale)
        sd, alike = sd if alone else spread, UNSURE * np.maximum(1.0, self.alike)
        return residual, np.where(use, 1.0 / (sd**2 * alike + of_line), 0.0) / np.maximum(1.0, far) ** 2

    def solve(self) -> None:
        """Find the estimate of the window and its prior."""
        if not self.unknowns or not self.samples:
            return
        stacked = self._stacked(self.samples)
        self.mean = np.clip(self.mean, self.low, self.high)
        for _ in range(2):  # the weights of far residuals follow the estimate
            info, pull = self._information_of(stacked)
            total = self.prior + info
            self.mean = self._within(total, self.prior @ self.prior_mean + pull)
        self.covariance = np.linalg.inv(total)
        wanted = self.covariance @ (self.prior @ self.prior_mean + pull)
        away = np.maximum(np.maximum(self.low - wanted, wanted - self.high), 0.0)
        self.beyond = away / np.sqrt(np.diag(self.covariance))
        self._follow_found()
        # Whether it contradicts the prior is asked of the window by the sensor's own noise: what a changed load leaves
        # unexplained must not pass for noise.
        info, pull = self._information_of(stacked, alone=True)
        self._judge(info, pull, self.samples[-1].time)
        # So must what a better estimate would explain: what is left is left by the best one that there is.
        best = np.linalg.solve(self.prior + info, self.prior @ self.prior_mean + pull)
        self._learn(stacked, np.clip(best, self.low, self.high))
        self._follow_lasting(stacked)

    def _follow_found(self) -> None:
        """Find whether the estimate is a guess no more: a number was shown, or a whole window has left all well known.

        What the map knows well to begin with, sensors may never show ten times better. Yet a window of readings has to
        come first: it shows the free motions, and that the map is wrong. Where it does so, none counts until another.
        """
        last, newest = ~self.free, self.samples[-1]
        shown = TENTH * self.first_sd[last]
        if not self.found and np.any(self.deviation[last] < shown):
            self.found = True
        elif not self.found and self.has_seen_a_window and not np.isfinite(self._contradicted):
            # What the zero of a sensor is off by does not matter below the sensor's own noise.
            noise = {one.name: sd for one, sd in zip(self.channels, self.deviations(newest.y0), strict=True)}
            size = [noise[one.target] if one.is_offset else abs(mean) * TENTH for one, mean in self._lasting_ones()]
            self.found = bool(np.all(self.linear_deviation[last] < np.maximum(shown, size)))

    def _lasting_ones(self) -> list[tuple[Unknown, float]]:
        """Unknowns that are no free motions, and their estimates."""
        both = zip(self.unknowns, self.mean.tolist(), self.free, strict=True)
        return [(one, mean) for one, mean, free in both if not free]

    @property
    def has_seen_a_window(self) -> bool:
        """Whether rows have come for a window since the estimate started anew."""
        return bool(self.samples) and self.samples[-1].time - self.begun >= FULL * self.window

    @property
    def is_far(self) -> bool:
        """Whether the estimate has left what was simulated, by more than is known of it: that is simulated anew now."""
        off, bent = BENT * np.abs(self.mean - self.theta0), self.bent
        return bool(np.any((off > np.maximum(TENTH * self.first_sd, self.linear_deviation))[bent]))

    def _follow_lasting(self, stacked: Stacked) -> None:
        """Find what is left of the window at the estimate, and what the estimate is off by where that is no noise.

        A sensor that is off for good, or sensors that contradict each other, are off by the same in all rows: what they
        make of the estimate does not fall with the number of rows. Which of them is off is not known, so each may be,
        by what all of them leave. What has left the window is not believed to be better. So it is where readings
        drift: what goes steadily on is followed late, and the mean by which rows missed what was expected is that lag.
        Nothing is known less well than at the start. Too few rows tell nothing of it: what was found of more stays
        until as many have come anew. As a sensor fails, rows leave the window that no others have refuted.
        """
        _, _, J, use, sd = stacked
        residual, weight = self._weighed(stacked)
        rows = np.maximum(use.sum(axis=0), 1)
        told = np.where(use, residual / sd, np.nan)
        for m in range(len(rows)):
            own = told[use[:, m], m]
            self.left[m] = self.spread[m] + (float(np.median(own)) ** 2 if own.size >= FEWEST else 0.0)
        noise = UNSURE * np.maximum(1.0, self.alike) * np.maximum(1.0, self.spread) / rows
        square = (np.nansum(told, axis=0) / rows) ** 2
        off = np.where((square > SEEN_OFF**2 * noise) & (rows >= FEWEST), square, 0.0)
        more = int(np.count_nonzero(use.any(axis=0))) - int(np.count_nonzero(~self.free))
        common = float((off + self.drift**2).sum()) / max(1, more)
        if rows.max(initial=0) >= FEWEST:
            self._told = 0
        elif self._told < FEWEST:
            return
        alone = np.einsum("nmi,nm,nmj->ij", J, weight, J) + np.diag(1.0 / self.first_sd**2)
        pull = np.linalg.solve(alone, np.einsum("nmi,nm,nm->im", J, weight, sd))
        self.lasting = np.minimum(np.sqrt(common * np.sum(pull**2, axis=1)), self.first_sd)

    def _within(self, total: np.ndarray, pull: np.ndarray) -> np.ndarray:
        """The minimum within the ranges: what would leave its range stands at the end of it."""
        fixed = np.zeros(len(pull), bool)
        mean = np.linalg.solve(total, pull)
        for _ in range(len(pull)):
            beyond = (mean < self.low) | (mean > self.high)
            if not beyond.any():
                break
            fixed |= beyond
            mean = np.where(fixed, np.clip(mean, self.low, self.high), mean)
            free = ~fixed
            if not free.any():
                break
            rest = pull[free] - total[np.ix_(free, fixed)] @ mean[fixed]
            mean[free] = np.linalg.solve(total[np.ix_(free, free)], rest)
        self.at_bound = fixed
        return mean

    def _judge(self, info: np.ndarray, pull: np.ndarray, time: float) -> None:
        """Release the prior where the window contradicts it for long: the thing itself has changed."""
        last = ~self.free
        # What the window says alone, with free motions as unknown as ever.
        alone = info + np.diag(np.where(self.free, 1.0 / self.first_sd**2, TINY / self.first_sd**2))
        spread = np.linalg.inv(alone)[np.ix_(last, last)]
        apart = (np.linalg.solve(alone, pull) - self.prior_mean)[last]
        spread = spread + np.linalg.inv(self.prior)[np.ix_(last, last)]
        distance = float(apart @ np.linalg.solve(spread, apart)) if last.any() else 0.0
        if distance < CONTRADICTION:
            self._contradicted = np.nan
            return
        if not np.isfinite(self._contradicted):
            self._contradicted = time
        if time - self._contradicted >= LASTING * self.window:
            wider = np.linalg.inv(self.prior) * distance / last.sum()
            most = np.diag(self.first_sd**2)
            narrow = np.all(np.diag(wider)[last] < np.diag(most)[last])
            self.prior = np.linalg.inv(wider) if narrow else np.linalg.inv(most)
            self.released, self._contradicted = time, np.nan
            self.found, self.begun = False, time

    def _forget_what_changed(self) -> None:
        """Forget what was before some last samples, where another estimate explains these and the old one does not."""
        tell = [one for one in self.samples if one.use.any()]
        if not self.late or len(tell) < 2 * self.late:
            return
        info, pull = self._information(tell[: -self.late])
        old = np.linalg.solve(self.prior + info, self.prior @ self.prior_mean + pull)
        gains = [self._gain(tell[-n:], old) for n in range(self.late // 2, self.late + 1)]
        most = int(np.argmax(gains))
        if gains[most] < ANOTHER:
            return
        self.since, self.changed = tell[-self.late // 2 - most].time, self.samples[-1].time
        self.drop_before(self.since)
        self.prior = np.diag(1.0 / self.first_sd**2)
        self.released, self._contradicted = self.samples[-1].time, np.nan
        self.found, self.begun = False, self.since

    def _gain(self, samples: Sequence[Sample], old: np.ndarray) -> float:
        """By how much the squares of samples fall with an estimate of their own; 0 where they do not fall by most.

        In standard deviations of the sensors. One wild sample among some is not explained by any estimate. Any error of
        a sensor is explained by another friction as long as the string goes one way: samples of both ways have to be
        among them.
        """
        y, y0, J, use, noise = self._stacked(samples)
        sd = noise * np.sqrt(UNSURE * np.maximum(1.0, self.alike))
        weight = np.where(use, 1.0 / sd**2, 0.0)
        r = np.where(use, y - y0, 0.0) - J @ (old - self.theta0)
        ways = np.minimum(np.sum(use[..., None] & (J > 0.0), axis=0), np.sum(use[..., None] & (J < 0.0), axis=0))
        if np.max(ways, initial=0) < BOTH_WAYS:
            return 0.0
        info = np.einsum("nmi,nm,nmj->ij", J, weight, J) + np.diag(TINY / self.first_sd**2)
        new = np.clip(old + np.linalg.solve(info, np.einsum("nmi,nm,nm->i", J, weight, r)), self.low, self.high)
        own = r - J @ (new - old)
        before, after = float(np.sum(weight * r**2)), float(np.sum(weight * own**2))
        return before - after if after <= EXPLAINED * before else 0.0

    def _learn(self, stacked: Stacked, best: np.ndarray) -> None:
        """Learn how residuals spread, and how many samples count as one."""
        y, y0, J, use, sd = stacked
        if len(y) < FEWEST:
            return
        e = np.where(use, y - y0 - J @ (best - self.theta0), 0.0)
        share = 1.0 / (MEMORY * len(y))
        for i in range(e.shape[1]):
            own = e[use[:, i], i]
            if own.size < FEWEST:
                continue
            # What is off all the time is no noise, but a contradiction.
            part = (own - np.median(own)) / sd[use[:, i], i]
            power = float(np.median(np.abs(part)) / NORMAL) ** 2
            part = np.clip(part, -LARGEST_RESIDUAL * power**0.5, LARGEST_RESIDUAL * power**0.5)
            if self._anew and self.shaken and FAR_LESS * power < self.spread[i]:
                # A first guess far away has left it. Noise of inputs is left by every linearisation. Without any a
                # window whose weight is wrong may be explained by free motions alone.
                self.learned[i] = 0.0
            self.learned[i] += 1.0
            keep = max(3.0 * share, 1.0 / self.learned[i])
            self.spread[i] += keep * (power - self.spread[i])
            if not np.isfinite(self.sd[i]):
                middle = float(np.median(np.abs(own)) / NORMAL) ** 2
                self.variance[i] = (
                    middle if self.variance[i] == 0.0 else (1 - share) * self.variance[i] + share * middle
                )
            # What nobody measures is counted with the time that it lasts already.
            known = 2.0 * self.blur[i] ** 2 > np.mean(sd[use[:, i], i] ** 2) / self.blurs
            self.alike[i] += keep * ((1.0 if known else _alike(part)) - self.alike[i])
            self.correlation[i] = UNSURE * max(1.0, self.spread[i]) * max(1.0, self.alike[i])

    # -- what it tells -------------------------------------------------------------------------------------------------

    @property
    def deviation(self) -> np.ndarray:
        """Standard deviations of the estimate (k,), with what it may be off because it was linearised elsewhere."""
        bent = self.bent
        moved = np.abs(self.mean - self.theta0)[bent] / self.first_sd[bent]
        off = np.where(bent, BENT * moved.max(initial=0.0) * self.first_sd, 0.0)
        return np.sqrt(np.diag(self.covariance) + off**2)

    @property
    def stated(self) -> np.ndarray:
        """The same (k,) with what sensors that are off for good make of it: what is told to people."""
        return np.hypot(self.deviation, self.lasting)

    @property
    def linear_deviation(self) -> np.ndarray:
        """The same (k,) of a machine that answers to its parameters in proportion."""
        return np.sqrt(np.diag(self.covariance))

    def expected(self, sample: Sample) -> tuple[np.ndarray, np.ndarray]:
        """What is expected of a sample before it is taken: residuals (m,), and their standard deviations."""
        y0 = sample.y0 + sample.J @ (self.mean - self.theta0) if self.unknowns else sample.y0
        sd = self.deviations(sample.y0) * np.sqrt(np.clip(self.spread, 1.0, np.inf if self.shaken else 9.0))
        own = np.zeros_like(sd)
        if self.unknowns:
            own = np.einsum("mi,ij,mj->m", sample.J, self.covariance, sample.J)
        return np.where(sample.use, sample.y - y0, np.nan), np.sqrt(sd**2 + own)

    def of_inputs(self, y0: np.ndarray) -> np.ndarray:
        """Standard deviations (m,) of what noisy inputs make of computed values (m,), as residuals show it."""
        return self.deviations(y0) * np.sqrt(np.maximum(self.spread - 1.0, 0.0)) * self.shaken

    def of_rows(self, y0: np.ndarray) -> np.ndarray:
        """Standard deviations (m,) of what inputs and the model make of computed values (m,), as rows miss them."""
        return self.deviations(y0) * np.sqrt(np.maximum(self.missed - 1.0, 0.0))

    def miss(self, time: float, residual: np.ndarray, y0: np.ndarray, over: float = MISSED) -> None:
        """Follow by how much rows miss what is expected of them: residuals (m,), NaN of what is not compared.

        What the best estimate leaves of a whole window is less: it knows of a free motion only afterwards.

        Parameters
        ----------
        over : float
            Time over which it is averaged, s.
        """
        passed = min(time - self.missed_at, over) if np.isfinite(self.missed_at) else 0.0
        self.missed_at = time
        square = np.minimum(np.abs(residual) / self.deviations(y0), MOST_MISSED) ** 2
        told = np.isfinite(square)
        # Rows of the beginning are the mean of themselves: what is not known yet is no zero.
        keep = np.where(told, np.exp(-passed / over), 1.0)
        weight = keep * self.told + (1.0 - keep)
        share = (1.0 - keep) / np.maximum(weight, 1e-12)
        self.missed += np.where(told, share * (square - self.missed), 0.0)
        self.told = weight

    def miss_anew(self, time: float) -> None:
        """Forget by how much rows have missed: the first one later than a time, s, begins a new mean."""
        self.missed, self.told, self.missed_at = np.zeros_like(self.missed), np.zeros_like(self.told), time

    def follow_wild(self, time: float, wild: bool) -> None:
        """Follow the share of rows that are not used, as none of their derivatives can be believed."""
        # One row behind a gap tells nothing of the gap.
        passed = min(time - self.wild_at, ONE_ROW * self.window) if np.isfinite(self.wild_at) else 0.0
        self.wild_at = time
        self.wild += (1.0 - float(np.exp(-passed / self.window))) * (float(wild) - self.wild)

    @property
    def starves(self) -> bool:
        """Whether so many rows are not used that the estimate stands where it was, whatever the machine does."""
        return self.wild > MANY_WILD

    def own(self, residual_sd: np.ndarray, y0: np.ndarray) -> np.ndarray:
        """Standard deviations of residuals (m,) without what the sensors are believed to be worse than is given."""
        plain = self.deviations(y0) ** 2
        return np.sqrt(plain + np.maximum(0.0, residual_sd**2 - plain * np.clip(self.spread, 1.0, 9.0)))

    def not_observable(self) -> list[str]:
        """Sentences on what the sensors have not shown so far."""
        if self.free.all():
            return []
        last = ~self.free
        covariance = self.covariance[np.ix_(last, last)]
        sd, first = np.sqrt(np.diag(covariance)), self.first_sd[last]
        alone = 1.0 / np.sqrt(np.diag(np.linalg.inv(covariance)))  # if all others were known
        alike = covariance / np.outer(sd, sd)
        told: dict[frozenset[int], str] = {}
        for i in np.flatnonzero(sd > UNSEEN * first).tolist():
            name = self.unknowns[i].name
            if alone[i] > UNSEEN * first[i]:
                told[frozenset([i])] = f"{name}: the sensors have not shown it so far"
                continue
            others = np.abs(alike[i])
            others[i] = 0.0
            k = int(np.argmax(others))
            text = (
                f"{name} and {self.unknowns[k].name} cannot be told apart so far: the sensors show a sum of them only"
            )
            told.setdefault(frozenset([int(i), k]), text)
        return list(told.values())


def _alike(part: np.ndarray) -> float:
    """Integrated autocorrelation time of residuals, in samples: 1 + 2 (sum up to the first lag without any)."""
    n = part.size
    power = float(part @ part)
    if power <= 0.0:
        return 1.0
    total = 1.0
    for lag in range(1, n // 2):
        alike = float(part[lag:] @ part[:-lag]) / power
        if alike <= 1.0 / np.sqrt(n):
            break
        total += 2.0 * alike
    # The mean was taken off so few residuals, and the sum was cut off: it is too small.
    return 1.0 + SHORT * (total - 1.0)
