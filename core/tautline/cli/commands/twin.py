"""The verb ``twin``: a scene beside the machine."""

from __future__ import annotations

import json
import logging
import math
import time as clock
from collections import Counter
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import closing, contextmanager, suppress
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

from tautline.application.installed import Catalogue
from tautline.cli.options.changes import change_of
from tautline.cli.options.sensors import read_sensors
from tautline.cli.output.console import finite, print_text, say
from tautline.cli.output.preparing import preparing
from tautline.cli.output.scene_warnings import print_warnings
from tautline.cli.run import Ended, ExitCode
from tautline.results.errors import WriteError
from tautline.scene.errors import SceneError

if TYPE_CHECKING:
    from tautline.application.protocol import Application
    from tautline.twin.map.file import TwinMap
    from tautline.twin.sources.record import Record, Source
    from tautline.twin.storage import Packed
    from tautline.twin.twin import Twin

CHATTERING = "asyncua"
"""A library that logs the loss of a server with a traceback; the user gets one sentence of us in its place."""
NOWHERE = logging.NullHandler()
SAID = {
    "no stamp": "without a stamp that can be read", "doubled": "with a stamp that another row had",
    "late": "that came too late", "future": "with a stamp from the future",
}  # fmt: skip
"""Kinds of rows that were left out, in words that say what is wrong."""
STAMPS = "a stamp is a number of seconds, or a date and a time such as 2026-11-27T20:15:03Z"
SAVE_EVERY = 5.0
"""How often the state is saved, s of the wall clock."""
POLL = 0.05
"""How long a record is waited for at a time, s."""
PIECE = 0.002
"""How long is looked ahead between two looks at the source, s."""
NOT_HELD, MESH = "not in ±", "a mesh that is too coarse: compare with a twin of more elements"
"""What is said of estimates in the summary: deviations know of noise alone."""
SILENCE = 1.0
"""After how long without records those that wait for others are answered, s."""


@dataclass(frozen=True, kw_only=True)
class TwinOptions:
    """What the command line gave of a twin: where its data come from, and where what it finds goes.

    Attributes
    ----------
    source : str
        Address of the data, ``-`` for standard input.
    speed : float or None
        At which a file is played, times real time; None for as fast as possible.
    output : Path or None
        The result; nothing is stored without it.
    resume : Path or None
        State to go on from.
    state, account : Path or None
        Where the state of the twin and the damage of its rope are kept; None for nowhere.
    serve : str or None
        Port of the page, or ``HOST:PORT``.
    serve_names : sequence of str
        Further names under which the page is asked for.
    force : bool
        Whether an operation that begins anew may replace the result of another one.
    """

    source: str
    speed: float | None
    output: Path | None
    resume: Path | None
    state: Path | None
    account: Path | None
    serve: str | None
    serve_names: Sequence[str]
    force: bool


def twin(
    catalogue: Catalogue, path: Path, map: Path, changes: Sequence[str] | None, given: TwinOptions,
    as_json: bool, quiet: bool,
) -> None:  # fmt: skip
    """Run a scene beside the machine.

    Raises
    ------
    SceneError, ResultError
        For bad input; nothing is written then.
    """
    from tautline.integrators.status import Interrupted, StoppedEarly
    from tautline.results.output_path import check_found
    from tautline.scene.values.moments import stamp_said
    from tautline.twin.series import Series
    from tautline.twin.sources.rereading import Ending
    from tautline.twin.storage import load
    from tautline.twin.twin import Twin

    application, scene = catalogue.read(path, change_of(changes))
    read, resume = read_sensors(map), given.resume
    goes_on = resume is not None and (resume.exists() or given.state != resume)
    if given.output is not None and not goes_on and not given.force:
        check_found(given.output, resume)
    with preparing(path, scene, quiet):
        warnings = application.warnings(scene)
    print_warnings(warnings)
    silence_library_logs()
    with (
        _alone({"--state": given.state, "--account": given.account, "-o": given.output}, resume if goes_on else None),
        closing(_open(application, scene, read, given, resume if goes_on else None)) as opened,
    ):
        try:
            made = Twin(scene, read, live=opened.live, account=given.account)
            made.readings.rows.factors = opened.factors
            begin = load(made, resume) if resume is not None and goes_on else None
            if begin is not None and opened.again and made.readings.rows.shift and not made.heard:
                _refuse_unknown_rows(resume)
            ended = Ending.of(made.heard)
            if begin is not None:
                say(_said_of_begin(begin, len(made.readings.rows.waiting), ended is not None))
            if made.plan_names.unwatched:
                say(f"limits of the scene that a twin cannot watch: {', '.join(made.plan_names.unwatched)}", "yellow")
            while made.notes:
                say(made.notes.pop(0), "yellow")
            page = _page(given, path, made)
            series = Series(given.output, made, begin, ended is not None) if given.output is not None else None
            _Loop(made, opened, series, page, given.state, as_json, quiet).run()
        except StoppedEarly as stop:
            say(f"{path}: stopped at {stamp_said(stop.time)}, {stop.part}: {stop.sentence}", "red")
            raise Ended(ExitCode.STOPPED_EARLY) from None
        except Interrupted:
            raise KeyboardInterrupt from None  # while the twin was made, or looked for its start


def _open(application: Application, scene: Any, read: TwinMap, given: TwinOptions, resume: Path | None) -> Any:
    """The source of a twin's rows; raises SceneError at the map where the fault lies there.

    It begins to read at once, so that it is told first which units hold.
    """
    from tautline.twin.sources.opening import open_source
    from tautline.twin.sources.record import NoColumn
    from tautline.twin.storage import stated_in

    stated = stated_in(resume) if resume is not None else None
    units = {one.column: one.unit for one in read.sensors}
    try:
        return open_source(given.source, list(units), time=read.time, speed=given.speed, units=units, stated=stated)
    except SceneError as error:
        _check_map(application, scene, read, given.account)
        columns, problems = list(units), []
        for one in error.problems:
            if isinstance(one, NoColumn):
                key = ("sensors", columns.index(one.column), "column")
                one = read.problem(key, f"{one.file} has no column '{one.column}'", one.cure)
            problems.append(one)
        raise SceneError(problems) from None


def _check_map(application: Application, scene: Any, read: TwinMap, account: Path | None) -> None:
    """See that a map goes with its scene, whatever the source has; raises SceneError."""
    from tautline.integrators.status import StoppedEarly
    from tautline.twin.map.check import checked
    from tautline.twin.operation import findings

    make = getattr(application, "operation", None)
    operation = make(scene, account) if make else None
    with suppress(StoppedEarly):
        checked(read, scene, operation.signals if operation else {}, findings(operation))


def _refuse_unknown_rows(state: Path | None) -> None:
    """Refuse to go on in a file whose clock was set back from a state that has not counted its rows."""
    from tautline.results.errors import ResultError

    cause = "the clock of the source was set back, and this state does not say which rows of the file it has read"
    raise ResultError(state or "", cause, "begin the twin anew, without --resume")


@contextmanager
def _alone(files: Mapping[str, Path | None], resumed: Path | None) -> Iterator[None]:
    """See that no other twin writes the same files meanwhile, by option; each would undo what the other has counted.

    The state that is `resumed` is judged as it is read: nothing else is lost where it is replaced.

    Raises
    ------
    ResultError
        Where another one does, and where there is no such folder.
    """
    from tautline.results.disk import Lock
    from tautline.results.errors import ResultError
    from tautline.results.output_path import check_folder, check_state

    locks: list[Lock] = []
    given = {option: path for option, path in files.items() if path is not None}
    for option, path in given.items():
        others = [one for one, other in given.items() if other.resolve() == path.resolve() and one != option]
        if others:
            raise ResultError(path, f"is named by {option} and by {others[0]}", "give each a file of its own")
    try:
        for option, path in given.items():
            another = resumed is None or path.resolve() != resumed.resolve()
            (check_state if option == "--state" and another else check_folder)(path)
            if option == "-o":
                continue  # a result has a lock of its own
            lock = Lock(path.resolve())  # through a link the file that it leads to is written
            writer = lock.take()
            if writer is not None:
                who = f"process {writer}" if writer else "another process"
                cure = f"wait until it has ended, or name another with {option}"
                raise ResultError(path, f"{who} is writing there", cure)
            locks.append(lock)
        yield
    finally:
        for lock in locks:
            lock.give_back()


def silence_library_logs() -> None:
    """Keep what a library logs off standard error.

    Only the command does this, never `open_source`: in another program it is that program's to say. And it is no more
    than that logging's handler of last resort has nothing to do: no level and no handler of others is changed, and
    where the root logger has a handler, it still gets everything.
    """
    logging.getLogger(CHATTERING).addHandler(NOWHERE)


def _page(given: TwinOptions, path: Path, made: Twin) -> Any:
    """The page at a port, or at a host and a port; None where none was asked for."""
    from tautline.twin.page.hosts import checked_names, place_of

    names = checked_names(given.serve_names, given.serve is not None)
    if given.serve is None:
        return None
    from tautline.twin.page.server import Page
    from tautline.twin.series import heading
    from tautline.whole_file import legible

    host, port = place_of(given.serve)
    estimated = {one.name: one.unit for one in made.plan.unknowns}
    units = {**made.plan_names.inputs, **made.units, **estimated}
    title, system = heading(made.scene) or legible(path.stem), getattr(made.scene, "units", "si")
    page = Page(port, title, units, made.application, host, system, names, made.mark)
    say(f"the twin is shown at {' and at '.join(page.addresses)}")
    return page


class _Loop:
    """Takes records, prints lines, looks ahead while it waits, saves the state."""

    def __init__(
        self, made: Twin, source: Source, series: Any, page: Any, state: Path | None, as_json: bool, quiet: bool
    ) -> None:
        from tautline.twin.sources.connection import Silence
        from tautline.twin.sources.rereading import Ending, Rereading

        self.twin, self.source, self.series, self.page, self.state = made, source, series, page, state
        self.as_json, self.quiet = as_json, quiet
        self.told: dict[str, float] = {}
        self.known_alarms: set[str] = set()
        self.unsaved: set[str] = set()
        self.begin = self.twin.now
        self.ending = Ending.of(made.heard)
        self.packed: Packed | None = None  # the state of before the end, once the source has ended
        self.packed_at = 0  # lines until then
        self.begun = self.twin.now > -math.inf  # gone on with: there is a state of it
        rows = made.readings.rows
        self.rereading = Rereading(made.heard, self.begin, rows.shift) if source.again else None
        self.held_again = 0  # rows of the source that the state holds, as they were not answered for good
        self.silence = Silence(source.name, made.plan.lost)
        self.known = Counter(self.twin.readings.rows.counts)
        self.unused = self._not_used()
        self.saved = clock.monotonic()
        self.lines = 0
        self.last: dict[str, Any] | None = None

    def run(self) -> None:
        """Until the source has ended, or Ctrl-C.

        Raises
        ------
        StoppedEarly
            Where the twin cannot go on; what it has found until then is stored.
        """
        from tautline.integrators.status import Interrupted, StoppedEarly
        from tautline.scene.values.moments import stamp_said
        from tautline.twin.loss import SceneEnded
        from tautline.twin.sources.record import SourceStopped

        status, why = "done", "the data have ended"
        try:
            try:
                self._hear_all()
            except SourceStopped as fault:
                say(str(fault), "red")
                status, why = "source failed", str(fault)
            for one in self.rereading.rest() if self.rereading is not None else ():
                self._add(one)
            self._answer_end()
        except (KeyboardInterrupt, Interrupted):  # the second is the first, heard within a step
            status, why = "interrupted", "the twin was stopped"
        except SceneEnded as end:
            say(f"the twin ends: {end}", "red")
            status, why = "scene ended", f"the twin has ended: {end}"
        except StoppedEarly as stop:
            if self.series is not None:
                self._keep("result", partial(self.series.finish, stop.status.word))
            self._leave_page(f"the twin stopped at {stamp_said(stop.time)}: {stop.sentence}")
            raise
        if status == "done" and self.lines and self.twin.loss.of_all:
            status, why = "nothing simulated", f"nothing was simulated: {self.twin.loss.of_all}"
            say(why, "red")
        self._end(status, why)

    def _hear_all(self) -> None:
        """Answer all records of the source; raises SourceStopped."""
        heard = clock.monotonic()
        while not self.source.ended:
            self._pass_on()
            busy = self.twin.work(PIECE if self._hurries else None)
            record = self.source.poll(0.0 if busy else POLL)
            now = clock.monotonic()
            if record is not None and self._hear(record, now):
                heard = now
                continue
            self.silence.useless(self._not_used().total())
            if now - heard > SILENCE:
                # A record that is piped in is answered alike however fast it comes.
                if self.ending is None and (record is None or self._hurries):
                    self._take_in(partial(self.twin.answers, silent=True))
                self._watch_silence()
                heard = clock.monotonic()

    def _hear(self, record: Record, now: float) -> bool:
        """Take a record; whether the machine was heard by it: a row that is left out tells nothing.

        One that came a while ago tells nothing of a silence: rows that can be used may have come behind it. Rows of a
        file are not sent by anyone.
        """
        taken = self.twin.readings.rows.taken
        for one in (record,) if self.rereading is None else self.rereading.new(record):
            self._add(one)
        used = not self.source.live or self.twin.readings.rows.taken > taken
        if used:
            self.silence.rested()
        return used or now - record.arrived > SILENCE

    def _take_in(self, answer: Callable[[], list[dict[str, Any]]]) -> None:
        """Give the lines of an answer, and tell where with it rows that can be used come again."""
        rows, passed = self.twin.readings.rows, self.silence.seconds
        before, lines = rows.taken, answer()
        if rows.taken > before:
            self._notice(self.silence.heard(passed))
            self.unused = self._not_used()
        self._give(lines)

    def _not_used(self) -> Counter[str]:
        """How many rows, lines and messages could not be used so far, by what is said of them."""
        counts = self.twin.readings.rows.counts
        found = Counter({f"row {said}": counts[kind] for kind, said in SAID.items()})
        found |= {"line that could not be read": self.source.refused, "message left out": self.source.left_out}
        return found

    @property
    def _hurries(self) -> bool:
        """Whether a machine waits for answers: then a look ahead makes way for rows. A record is looked ahead of whole,
        also one that is piped in: what is found must not depend on how busy this computer is.

        That ends with the first row that has come at pace, however many of the record are still to be answered."""
        return self.source.live and not self.source.pace.is_record

    def _watch_silence(self) -> None:
        """Tell that rows have stopped coming, where they should come while they are measured."""
        if self.source.ended or not self.source.live:
            return
        unused = self._not_used() - self.unused
        why = ", ".join(_many(count, *what.split(" ", 1)) for what, count in sorted(unused.items()))
        rows = self.twin.readings.rows
        self._notice(self.silence.watch(rows.interval, why, rows.judged_in))
        if self.silence.lasts and self.page is not None:
            self.page.tell(self.silence.in_short(rows.interval, why))

    def _add(self, record: Record) -> None:
        """Answer a record, and what waited for it.

        The state is of before a half line of a file: when the file has grown, its row comes again, whole.
        """
        if not record.whole:
            say(f"{self.source.name}: the last line has no line end, so its last cell counts as missing", "yellow")
            if self.rereading is not None:
                self._save_before_end()
        if self.rereading is not None:
            self.twin.readings.rows.place = self.rereading.place
        if self.rereading is None or self.rereading.is_new:
            self.ending = None
        else:
            self.held_again += 1
        self._take_in(partial(self.twin.add, record.time, record.values, record.arrived, record.repeated))

    def _pass_on(self) -> None:
        """Print what the source has to say, such as that nobody answers."""
        while self.rereading is not None and self.rereading.notes:
            say(self.rereading.notes.pop(0), "yellow")
        while self.source.notes:
            self._notice([self.source.notes.pop(0)])

    def _notice(self, notes: Sequence[str]) -> None:
        """Print sentences, and for programs those on the connection."""
        from tautline.twin.sources.connection import Notice

        for note in notes:
            say(note, "yellow")
            if isinstance(note, Notice):
                # Whoever reads the time of each line finds it: that of the last row.
                time = self.last["time"] if self.last else None
                self._print({"time": time, "connection": note.status, "text": str(note)})

    def _give(self, lines: Sequence[dict[str, Any]]) -> None:
        begins = bool(lines) and not self.begun
        if begins:
            # Killed behind the first lines of a result, a twin could not go on without a state beside it.
            self.begun = True
            self._save_state()
        for line in lines:
            self.lines, self.last = self.lines + 1, line
            self._print(line)
            if self.series is not None:
                self._keep("result", partial(self.series.add, line))
            if self.page is not None:
                first = self.twin.estimate.family.simulations[0]
                self.page.publish(finite(line), first.model, first.parts.frames.rows[0])
            self._tell(line)
        self._remark(self.twin.readings.rows.notes)  # what is wrong with rows may be why there is no line
        now = clock.monotonic()
        if begins or (lines and now - self.saved > SAVE_EVERY):
            # The first state is behind the first lines: what goes on from it does not give them again.
            self._save()

    def _print(self, line: dict[str, Any]) -> None:
        """Print a line for programs, where such lines are asked for and can be written.

        A twin goes on to warn and to store where they cannot. It does not try again: half a line may stand there.
        """
        if not self.as_json:
            return
        try:
            print_text(json.dumps(finite(line), allow_nan=False) + "\n")
        except WriteError as error:
            self.as_json = False
            self.unsaved.add("lines")
            say(f"{error}. The twin goes on, and prints no more lines there", "red")

    def _remark(self, notes: list[str]) -> None:
        """Print sentences, and take them out."""
        for note in notes:
            say(note, "yellow")
        notes.clear()

    def _tell(self, line: dict[str, Any]) -> None:
        """Print alarms as they begin and end."""
        from tautline.scene.values.moments import stamp_said
        from tautline.twin.alarms import NOT_KNOWN

        self._remark(self.twin.notes)
        self._remark(self.twin.readings.rows.notes)
        active = {one["name"]: one for one in line["alarms"]}
        for name, one in active.items():
            if name not in self.told:
                say(f"{stamp_said(line['time'])}: ALARM {name}: {one['text']}", "red")
            elif one["known"] and name not in self.known_alarms:
                say(f"{stamp_said(line['time'])}: {name} is certain now: {one['text']}", "red")
            elif name in self.known_alarms and not one["known"]:
                doubt = "" if one["text"].startswith(NOT_KNOWN) else "in doubt now: "
                say(f"{stamp_said(line['time'])}: {name} is {doubt}{one['text']}", "yellow")
        self.known_alarms = {name for name, one in active.items() if one["known"]}
        for name, since in list(self.told.items()):
            if name not in active:
                say(f"{stamp_said(line['time'])}: {name} has ended, after {line['time'] - since:.3g} s")
        self.told = {name: float(one["since"]) for name, one in active.items()}

    def _save_before_end(self) -> None:
        """Keep the last state, of before what is answered only as the source has ended.

        Rows that wait are answered without those behind them then. When more have come they are answered anew. Where
        it cannot be written now it is written later, as it is now.
        """
        if self.packed is None:
            self._save()
            if self.state is not None:
                self.packed, self.packed_at = self._packed(), self.lines

    def _answer_end(self) -> None:
        """Answer the rows that wait, as none comes behind them; once only, where none has come since."""
        self._save_before_end()
        if self.ending is not None:
            return
        from tautline.twin.sources.rereading import Ending

        self._give(self.twin.finish())
        if self.lines > self.packed_at and self.packed is not None:
            self.packed.heard(Ending(self.twin.now, self.lines - self.packed_at).memory())

    def _save(self) -> None:
        """Keep the result, what goes over operations, and then the state: what it has counted is not counted again."""
        if self.series is not None:
            self._keep("result", self.series.flush)  # what the state is later than is in the result then
        if self.lines or self.twin.readings.rows.waiting:
            self._save_state()
        self.saved = clock.monotonic()

    def _save_state(self) -> None:
        """Keep the account, and the state behind it."""
        from tautline.twin.storage import write

        counted = self.twin.operation is None or self._keep("account", self.twin.operation.save)
        # A state that is later than the account would leave out how the rope was bent meanwhile.
        if self.state is not None and counted:
            self._keep("state", partial(write, self.packed or self._packed(), self.state))

    def _packed(self) -> Packed:
        """The state as it is now."""
        from tautline.twin.storage import packed

        # What a live source gave is in no file: there its stamps tell what is new.
        again = self.rereading
        rows, self.twin.stated = self.twin.readings.rows, {**self.twin.stated, **self.source.stated}
        self.twin.heard = {} if again is None else again.memory(rows.held, rows.newest)
        if self.ending is not None:
            self.twin.heard |= self.ending.memory()
        return packed(self.twin)

    def _keep(self, what: str, write: Callable[[], None]) -> bool:
        """Write a file, and whether that went well.

        A twin goes on to warn where a disk is full: this is told once, and a later attempt may go well again.
        """
        from tautline.results.errors import ResultError

        try:
            write()
        except (ResultError, OSError) as error:
            if what not in self.unsaved:
                text = f"the {what} cannot be saved: {error}. The twin goes on, and tries again"
                self._tell_saved(what, False, text)
            self.unsaved.add(what)
            return False
        if what in self.unsaved and not (what == "result" and self.series.behind):
            self.unsaved.remove(what)
            self._tell_saved(what, True, f"the {what} is saved again")
        return True

    def _tell_saved(self, what: str, saved: bool, text: str) -> None:
        """Print whether a file can be written."""
        say(text, "green" if saved else "red")
        time = self.last["time"] if self.last else None
        self._print({"time": time, "file": what, "saved": saved, "text": text})

    def _leave_page(self, why: str) -> None:
        """Tell who looks at the page why nothing comes any more, and end it."""
        if self.page is not None:
            self.page.close(why)

    def _end(self, status: str, why: str) -> None:
        self._pass_on()
        self._save()
        if self.series is not None:
            self._keep("result", partial(self.series.finish, status))
            self._say_no_result()
        self._leave_page(why)
        self._summarise()
        if status == "interrupted":
            raise Ended(ExitCode.INTERRUPTED)
        if status != "done" or self.unsaved:
            raise Ended(ExitCode.STOPPED_EARLY)
        if self.last is None and not self._before:
            raise Ended(ExitCode.STOPPED_EARLY)

    def _say_no_result(self) -> None:
        """Say that the file that was asked for does not come to be where no row was answered."""
        if self.lines == 0 and not self.series.path.exists() and "result" not in self.unsaved:
            say(f"{self.series.path} is not written: no row was answered", "yellow")

    @property
    def _before(self) -> int:
        """Rows that a file has of those that were answered by an earlier process; what it has lost is not counted."""
        if self.rereading is None:
            return 0
        return self.rereading.before + (self.held_again if self.ending is not None else 0)

    def _summarise(self) -> None:
        """Print what was found last, and what was wrong with the data."""
        from tautline.cli.output.console import console
        from tautline.cli.output.summary import two_columns
        from tautline.twin.watch import said

        rows, system = [], getattr(self.twin.scene, "units", "si")
        if self.last is None:
            self._say_why_nothing()
        else:
            # Where nothing was simulated they are the map's guesses.
            estimates = {} if self.twin.loss.of_all else self.last["estimates"]
            rows += [
                (name, f"{said(one['value'], one['unit'], system)} ± {said(2.0 * one['sd'], one['unit'], system)}")
                for name, one in estimates.items()
            ]
            rows += [(NOT_HELD, MESH)] if estimates else []
            rows += [("not observable", text) for text in self.last["not_observable"]]
            rows += self.twin.operation.summary() if self.twin.operation is not None else []
        counts = sorted(self.twin.readings.rows.counts.items())
        rows += [(f"rows {kind}", str(count)) for kind, count in counts if count]
        if self.source.refused:
            rows.append(("lines that could not be read", str(self.source.refused)))
        if self.source.left_out:
            rows.append(("messages left out", str(self.source.left_out)))
        if self.source.dropped:
            rows.append(("records dropped, as they came too fast", str(self.source.dropped)))
        waiting = len(self.twin.readings.rows.waiting) if self.ending is None else 0  # else they were answered
        if left := self.source.waiting + waiting:
            rows.append(("rows not processed", str(left)))
        rows.append(("rows processed", str(self.lines)))
        if not self.quiet:
            console().print(two_columns(rows))

    def _say_why_nothing(self) -> None:
        """Say what was wrong with the rows where none of them could be used."""
        from tautline.scene.values.moments import stamp_said

        counted = self.twin.readings.rows.counts - self.known
        causes = [f"{_many(count, 'row')} {SAID.get(kind, kind)}" for kind, count in sorted(counted.items())]
        if self.source.refused:
            causes.append(f"{_many(self.source.refused, 'line')} could not be read")
        if self.source.left_out:
            count = self.source.left_out
            causes.append(f"{_many(count, 'message')} {'was' if count == 1 else 'were'} left out")
        if self._before:
            begin = self.begin if self.ending is None else self.ending.time
            old = f"{_many(self._before, 'row')} not after {stamp_said(begin)}, from where the twin goes on"
            say(f"nothing is new: {', '.join([old, *causes])}")
            return
        why = ", ".join(causes) or "the source gave no row"
        cure = f"; {STAMPS}" if counted["no stamp"] else ""
        say(f"no row of data could be used: {why}{cure}", "red")


def _said_of_begin(time: float, waiting: int, answered: bool) -> str:
    """From where a twin goes on: the time of its last row, and how many rows behind it wait, or were `answered` as the
    source had ended."""
    from tautline.scene.values.moments import stamp_said

    where = f"going on from {stamp_said(time)}" if math.isfinite(time) else "going on"
    if not waiting:
        return where
    verb = "is" if waiting == 1 else "are"
    if answered:
        was = "was" if waiting == 1 else "were"
        last = f"the last {_many(waiting, 'row')} {was} answered at the end of the source"
        return f"{where}: {last}, and {verb} answered anew where rows follow"
    return f"{where}, with {_many(waiting, 'row')} that waited for others and {verb} answered now"


def _many(count: int, what: str, then: str = "") -> str:
    return f"{count} {what}{'' if count == 1 else 's'}{' ' if then else ''}{then}"
