"""Rows that have the stamp of another one and other readings: why that is so, and when it can be told.

| rows come | what they are |
|---|---|
| one step back, and then on evenly over stamps that were there | a clock that was set back by less than its rows show |
| in any other order | stamps with too few digits, or two machines |
"""

from __future__ import annotations

import math

from tautline.scene.values.moments import stamp_said
from tautline.twin.pace import ONE_STAMP

DIFFERENT = 3
"""Rows with a stamp that was there, and with other readings, after which this is told."""
MILLISECOND, ROUNDING = 1e-3, 2e-6
"""A stamp further from whole milliseconds than rounding and a shift of it make was written with more digits, s."""
SOON = 60.0
"""Time within which no clock is set back twice, s: rows of two machines that come in turns step back so."""


class Doubles:
    """Watches rows as they come, for those with a stamp that was there and with other readings.

    A clock that was set back by a few rows is behind the newest stamp for these only: then it has caught up with it,
    and nothing but the step back in between shows what happened.

    Parameters
    ----------
    notes : list of str
        Where sentences for the user go.
    """

    def __init__(self, notes: list[str]) -> None:
        self._notes = notes
        self._told = self._tells = self._fine = False
        self._count = self._run = 0
        self._back, self._before, self._when = 0.0, -math.inf, 0.0
        self._set_back = -math.inf

    def come(self, time: float, newest: float, interval: float) -> None:
        """Take notice of the time of a row, before it is put in its place.

        Parameters
        ----------
        newest : float
            The largest time before it, s.
        interval : float
            The sample interval, s; NaN where it is not known.
        """
        if time > newest + ONE_STAMP:
            self.end()
            self._run, self._before = 0, -math.inf
            return
        if self._run and time > self._before + ONE_STAMP:
            self._run += 1
        else:
            if self._run:  # a second step back before the first was made up for
                self._tell_others()
            self._run = 1
            self._back = newest - time + (interval if math.isfinite(interval) else 0.0)
        self._before = time

    def differ(self, stamp: float) -> None:
        """Take notice that the row that came has other readings than that of the same stamp, s."""
        self._count += 1
        self._fine |= abs(math.remainder(stamp, MILLISECOND)) > ROUNDING
        if self._count == DIFFERENT and not self._told:
            self._tells, self._when = True, stamp
            if self._run < DIFFERENT:
                self._tell_others()

    def was_set_back(self) -> None:
        """Forget the rows: it is told that they are of a clock that was set back, and time goes on by it."""
        self._tells, self._count, self._run = False, 0, 0

    def end(self) -> None:
        """Tell what is known when rows go on behind the newest, or at the end."""
        if self._tells and self._when - self._set_back < SOON:
            self._tell_others()
        if self._tells:
            self._tells, self._count, self._set_back = False, 0, self._when
            self._notes.append(
                f"the source's clock was set back by {self._back:.3g} s, near {stamp_said(self._when)}: rows after "
                "that have stamps that were there. The first one of a stamp counts, and the others are left out"
            )

    def _tell_others(self) -> None:
        """Tell that rows of one stamp are no row that came twice; once."""
        if self._tells:
            self._tells, self._told = False, True
            coarse = (
                "The stamps may have too few digits for rows that come so fast, or two machines are in the data. Write "
                "stamps with milliseconds"
            )
            twice = "Two machines may be in the data, or a program that writes rows twice. Give the rows of one"
            self._notes.append(
                f"rows with the same stamp have different readings, such as at {stamp_said(self._when)}: the first one "
                f"of a stamp counts, and the others are left out. {twice if self._fine else coarse}"
            )
