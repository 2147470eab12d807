"""A window on a result: a slider for the time, play and pause, and the history of what is picked."""

from __future__ import annotations

import time as clock
from typing import Any

import numpy as np

from tautline.view.space.stage import Stage

KEYS = (
    "space: play or pause; left, right: a frame; home: first frame; click on a line: history of a node; r: whole view"
)
TICK = 20
"""Milliseconds between two looks at the clock while playing."""
NEAR = 0.02
"""Share of the picture's size within which a click counts as on a node's line."""


class Window:
    """A stage that plays; make one of a stage with ``window=True``, and call `open`.

    Attributes
    ----------
    playing : bool
    picked : (line, node) or None
        Numbers of the line and of the node on it, from 0, whose history is shown.
    """

    def __init__(self, stage: Stage, speed: float = 1.0) -> None:
        self.stage, self.speed = stage, speed
        self.time = stage.appearance.time
        self.playing = False
        self.picked: tuple[int, int] | None = None
        self._begun = 0.0
        self._from = 0.0
        self._chart: Any = None
        self._mark: Any = None
        self._slider: Any = None
        plotter = stage.plotter
        if len(self.time) > 1:
            self._slider = plotter.add_slider_widget(
                self._slid, (float(self.time[0]), float(self.time[-1])), value=float(self.time[0]),
                pointa=(0.56, 0.035), pointb=(0.86, 0.035), style="modern", fmt="%.2f", title_height=0.018,
            )  # fmt: skip
            for key, act in (
                ("space", self.toggle), ("Right", lambda: self.go(1)), ("Left", lambda: self.go(-1)),
                ("Home", lambda: self.show(0)), ("r", stage.look),
            ):  # fmt: skip
                plotter.add_key_event(key, act)
        plotter.enable_point_picking(self.pick, show_message=False, show_point=False, left_clicking=True)

    def open(self) -> None:
        """Show the window, and wait until it is closed."""
        plotter = self.stage.plotter
        plotter.add_timer_event(max_steps=10**9, duration=TICK, callback=lambda _: self.tick())
        plotter.show(title=f"{self.stage.appearance.title} - Tautline", auto_close=True)

    def toggle(self) -> None:
        """Play, or pause; at the end it starts again."""
        self.playing = not self.playing
        if self.playing:
            if self.stage.frame >= len(self.time) - 1:
                self.show(0)
            self._begun, self._from = clock.perf_counter(), float(self.time[self.stage.frame])

    def tick(self) -> None:
        """Go where the clock says, while playing."""
        if not self.playing:
            return
        now = self._from + self.speed * (clock.perf_counter() - self._begun)
        self.show(int(np.searchsorted(self.time, now, side="right")) - 1)
        self.playing = now < self.time[-1]

    def go(self, frames: int) -> None:
        """Step by frames, and pause."""
        self.playing = False
        self.show(self.stage.frame + frames)

    def show(self, frame: int) -> None:
        """Show a frame."""
        self.stage.show(frame)
        if self._slider is not None:
            self._slider.GetRepresentation().SetValue(float(self.time[self.stage.frame]))
        if self._mark is not None:
            at = float(self.time[self.stage.frame])
            self._mark.update([at, at], self._mark.y)
        self.stage.plotter.render()

    def pick(self, point: Any) -> None:
        """Show the history of the node nearest to a point, (3,) m; nothing if no line is near."""
        found = self.nearest(point)
        if found is None:
            return
        self.picked = found
        self._draw_history(*found)
        self.stage.plotter.render()

    def nearest(self, point: Any) -> tuple[int, int] | None:
        """Line and node, from 0, nearest to a point; None if no line with nodes is near."""
        best: tuple[float, int, int] | None = None
        for number, line in enumerate(self.stage.appearance.lines):
            if len(line.nodes) == 0 or not line.quantities:
                continue
            points = line.points(self.stage.frame)
            away = np.linalg.norm(points - point, axis=1) - self.stage.thickness(line)
            if away.min() > NEAR * self.stage.size:
                continue
            node = int(np.linalg.norm(points[line.nodes] - point, axis=1).argmin())
            if best is None or away.min() < best[0]:
                best = (float(away.min()), number, node)
        return None if best is None else best[1:]

    def history(self, line: int, node: int) -> np.ndarray:
        """Values of the quantity that is shown, of a node, (frames,) in the legend's unit."""
        part, shade = self.stage.appearance.lines[line], self.stage.shading
        name = shade.name if shade is not None else part.quantities[0].name
        quantity = next((one for one in part.quantities if one.name == name), part.quantities[0])
        factor = shade.factor if shade is not None and shade.name == quantity.name else 1.0
        place = int(part.nodes[node])
        return np.array([quantity.values(frame)[place] for frame in range(len(self.time))]) / factor

    def _draw_history(self, line: int, node: int) -> None:
        values, part = self.history(line, node), self.stage.appearance.lines[line]
        shade = self.stage.shading
        plotter, pyvista = self.stage.plotter, self.stage.pyvista
        if self._chart is not None:
            plotter.remove_chart(self._chart)
        title = shade.title if shade is not None else part.quantities[0].text
        chart = pyvista.Chart2D(size=(0.36, 0.34), loc=(0.01, 0.58), x_label="time [s]", y_label=title)
        chart.background_color = (1.0, 1.0, 1.0, 0.85)
        chart.title = f"{part.name}, node {node + 1}"
        chart.line(self.time, values, color="#0072B2", width=2.0)
        at = float(self.time[self.stage.frame])
        self._mark = chart.line([at, at], [float(values.min()), float(values.max())], color="#D55E00", width=1.5)
        plotter.add_chart(chart)
        self._chart = chart

    def _slid(self, value: float) -> None:
        self.playing = False
        self.stage.show(int(np.abs(self.time - value).argmin()))
