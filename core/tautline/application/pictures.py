"""Figures of a result in Python: ``result.plot.overview()``, ``result.plot("hook_load", vs="block_position")``."""

from __future__ import annotations

import functools
from collections.abc import Callable, Mapping, Sequence
from typing import TYPE_CHECKING, Any

from tautline.application.installed import Installed
from tautline.application.twins import drawer
from tautline.arguments import NAME, RESULT, RESULTS, as_arguments, check, check_given, check_members

if TYPE_CHECKING:
    from tautline.results.result import Result


class Plots:
    """Figures of a result, each a method by its name; ``dir(result.plot)`` lists them.

    Calling it draws any figure or variable by name. What it returns is a ``matplotlib.figure.Figure`` that pyplot does
    not know: a notebook shows it, ``savefig`` writes it.

    Parameters
    ----------
    result : Result
    application : Application, optional
        That the result belongs to; by default, the installed one that recognises its scene.
    """

    def __init__(self, result: Result, application: Any = None) -> None:
        self._result, self._given = result, application

    @functools.cached_property
    def _application(self) -> Any:
        return drawer(self._result, lambda one: Installed().for_result(one) if self._given is None else self._given)

    @property
    def _figures(self) -> Mapping[str, str]:
        return self._application.figure_names

    def __call__(self, what: str, vs: str | None = None, beside: Sequence[Result] = ()) -> Any:
        """Draw a figure, or any variable.

        Parameters
        ----------
        what : str
            A figure's name, or a variable's, as ``--what`` takes it: ``tension:winch to boom tip:first``.
        vs : str, optional
            Variable to draw it against, in place of time.
        beside : sequence of Result
            Results of the same application to overlay.

        Returns
        -------
        Figure or dict of str to Figure
            Several by their names where `what` stands for several, as a hose's ``overview`` does.

        Raises
        ------
        ResultError
            If a name is unknown, the result lacks what the figure shows, or the figure shows one result alone.
        ArgumentTypeError
            For a name that is no text, and what is no list of results.
        """
        check_given(what=(what, NAME))
        check(vs=(vs, NAME))
        check_members("beside", beside, RESULTS, RESULT)
        with as_arguments({"--what": "what", "--vs": "vs"}):
            drawn = self._application.pictures([self._result, *beside], (what,), vs)
        if len(drawn) > 1 and not beside:
            return drawn
        if len(drawn) > 1:
            from tautline.results.errors import ResultError

            raise ResultError("beside", f"'{what}' is a figure of one result", "draw it of each, one by one")
        return next(iter(drawn.values()))

    def __getattr__(self, name: str) -> Callable[..., Any]:
        if name.startswith("_"):
            raise AttributeError(name)
        if name in self._figures:
            method = functools.partial(self, name)
            method.__doc__ = self._figures[name]
            return method
        from tautline.view.figures.comparison import nearest

        hint = nearest(name, list(self._figures))
        variable = f'; draw the variable by result.plot("{name}")' if name in self._result else ""
        raise AttributeError(f"there is no figure '{name}'{variable}; {hint}known: {', '.join(self._figures)}")

    def __dir__(self) -> list[str]:
        return [*super().__dir__(), *self._figures]

    def __repr__(self) -> str:
        lines = "\n".join(f"  {name}: {text}" for name, text in self._figures.items())
        return f"Figures of {self._result!r}:\n{lines}"
