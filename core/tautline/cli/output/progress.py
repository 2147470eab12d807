"""How far a run is: a bar on a terminal, nothing but a first line elsewhere."""

from __future__ import annotations

from types import TracebackType
from typing import TYPE_CHECKING

from tautline.cli.output.console import console

if TYPE_CHECKING:
    from rich.progress import Progress, TaskID


class Bar:
    """A progress bar as a context manager; call it with simulated and wall time, s.

    Parameters
    ----------
    end : float or None
        Simulated time at which the run ends, s; None if that is not known.
    shown : bool
        False for ``--quiet``; where there is no terminal nothing is drawn either.
    """

    def __init__(self, end: float | None, shown: bool = True) -> None:
        self.end, self.what = end, ""
        self.progress: Progress | None = None
        self.task: TaskID | None = None
        if shown and console().is_terminal:
            from rich.progress import BarColumn, Progress, TextColumn, TimeRemainingColumn

            self.progress = Progress(
                TextColumn("{task.fields[reached]}", justify="right"),
                BarColumn(bar_width=40),
                TextColumn("{task.fields[rate]}"),
                TimeRemainingColumn(compact=True),
                console=console(),
                transient=True,
            )

    def __enter__(self) -> Bar:
        if self.progress is not None:
            self.progress.start()
            self.task = self.progress.add_task("", total=self.end, reached=self._reached(0.0), rate="starting")
        return self

    def __call__(self, simulated: float, wall: float) -> None:
        """Show how far the run is."""
        if self.progress is None or self.task is None:
            return
        rate = f"{simulated / wall:.3g} x real time" if wall > 0.0 else ""
        self.progress.update(self.task, completed=simulated, reached=self._reached(simulated), rate=rate)

    def again(self, end: float, what: str) -> None:
        """Begin anew, with further runs that come to so much simulated time, s; what they are for stands in front."""
        self.end, self.what = end, f"{what}: "
        if self.progress is not None and self.task is not None:
            self.progress.reset(self.task, total=end, reached=self._reached(0.0), rate="")

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        if self.progress is not None:
            self.progress.stop()

    def _reached(self, simulated: float) -> str:
        reached = f"{simulated:.1f} s" if self.end is None else f"{simulated:.1f} of {self.end:g} s"
        return self.what + reached


class Counter:
    """A bar of things done, such as pictures of a film, as a context manager; call it with how many, and of how many.

    Where there is no terminal, or it is not to be shown, nothing is drawn.
    """

    def __init__(self, things: str, shown: bool = True) -> None:
        self.things = things
        self.progress: Progress | None = None
        self.task: TaskID | None = None
        if shown and console().is_terminal:
            from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeRemainingColumn

            self.progress = Progress(
                MofNCompleteColumn(), TextColumn(things), BarColumn(bar_width=40), TimeRemainingColumn(compact=True),
                console=console(), transient=True,
            )  # fmt: skip

    def __enter__(self) -> Counter:
        if self.progress is not None:
            self.progress.start()
            self.task = self.progress.add_task("", total=None)
        return self

    def __call__(self, done: int, total: int) -> None:
        """Show how many are done."""
        if self.progress is not None and self.task is not None:
            self.progress.update(self.task, completed=done, total=total)

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        if self.progress is not None:
            self.progress.stop()
