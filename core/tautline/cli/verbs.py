"""The verbs as typer commands. Nothing heavy is imported here: ``--help`` must not wait."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, cast

import typer

from tautline.application.installed import Single
from tautline.cli.options.finite import a_number, finite
from tautline.cli.options.places import file_named

if TYPE_CHECKING:
    from tautline.application.installed import Catalogue
    from tautline.application.protocol import Application

Scene = Annotated[Path, typer.Argument(metavar="SCENE", help="A YAML file.", show_default=False)]
Json = Annotated[bool, typer.Option("--json", help="Print one JSON object on standard output, SI units.")]
ResultFile = Annotated[
    Path | None,
    typer.Option(
        "-o",
        "--output",
        metavar="RESULT",
        parser=file_named,
        help="Result. [dim]\\[default: the scene's name with .nc][/]",
    ),
]
Method = Annotated[str | None, typer.Option("--method", help="Integrator, instead of the scene's.")]
Step = Annotated[
    str | None, typer.Option("--step", help="Time step, with a unit or in s, or auto, instead of the scene's.")
]
End = Annotated[str | None, typer.Option("--end", help="Simulated time, with a unit or in s, instead of the scene's.")]
RhoInf = Annotated[
    float | None,
    typer.Option("--rho-inf", callback=finite, help="Spectral radius of generalized-alpha at infinity, 0 to 1."),
]
Accuracy = Annotated[
    str | None,
    typer.Option(
        "--accuracy",
        metavar="SHARE",
        help="Choose method and step for this relative error of position and force, as '1 %'.",
    ),
]
Resume = Annotated[
    Path | None, typer.Option("--resume", help="Go on from where this earlier result of the scene ended.")
]
Verify = Annotated[
    bool | None,
    typer.Option(
        "--verify/--no-verify",
        help="Estimate the error from two more runs with shorter steps, or not at all. "
        "[dim]\\[default: shorter steps for scenes with friction and fixed steps; "
        "longer ones, which cost less, for others][/]",
    ),
]
Changes = Annotated[
    list[str] | None,
    typer.Option(
        "--set",
        metavar="KEY=VALUE",
        help="A value in place of the scene's, as bodies\\[0].mass='6 t'; repeatable.",
    ),
]
Quiet = Annotated[bool, typer.Option("--quiet", "-q", help="Print errors and warnings only.")]
Results = Annotated[
    list[Path], typer.Argument(metavar="RESULT...", help="Results; several are compared.", show_default=False)
]
FigurePlace = Annotated[
    str | None,
    typer.Option(
        "-o",
        "--output",
        metavar="FILE_OR_FOLDER",
        help="Where to: a file, or without an ending a folder, which is made where its parent is there. "
        "[dim]\\[default: the current folder][/]",
    ),
]
ExportPlace = Annotated[
    str | None,
    typer.Option(
        "-o", "--output", metavar="FOLDER_OR_STEM",
        help="A folder that is there, or with / at its end is made; else the beginning of the names of the files. "
        "[dim]\\[default: the result's name][/]",
    ),
]  # fmt: skip
Picture = Annotated[
    Path | None,
    typer.Option(
        "-o",
        "--output",
        metavar="FIGURE",
        parser=file_named,
        help="Figure: png, svg or pdf. [dim]\\[default: the scene's name][/]",
    ),
]
What = Annotated[
    list[str] | None,
    typer.Option(
        "--what",
        metavar="NAME",
        help="A figure, or a stored variable such as tension or axial_force:3; repeatable. "
        "[dim]\\[default: the application's figures][/]",
    ),
]
Drawing = Annotated[
    Path | None,
    typer.Option("--figure", metavar="FILE", parser=file_named, help="Draw the scene into a png, svg or pdf file."),
]
Format = Annotated[str | None, typer.Option("--format", metavar="png|svg|pdf", help="[dim]\\[default: png][/]")]
Stored = Annotated[Path, typer.Argument(metavar="RESULT", help="A result that `simulate` wrote.", show_default=False)]
Against = Annotated[
    str | None,
    typer.Option("--vs", metavar="NAME", help="Variable to draw those of --what against. [dim]\\[default: time][/]"),
]
Image = Annotated[
    list[str] | None,
    typer.Option("--image", metavar="t=TIME", help="A picture of a time in s, `first` or `last`; repeatable."),
]
Movie = Annotated[Path | None, typer.Option("--movie", metavar="FILE", parser=file_named, help="A film: mp4 or gif.")]
Html = Annotated[
    Path | None,
    typer.Option(
        "--html", metavar="FILE", parser=file_named, help="A web page that plays in any browser, self-contained."
    ),
]
View = Annotated[str | None, typer.Option("--view", metavar="NAME", help="Which view, where there are several.")]
Colour = Annotated[
    str | None,
    typer.Option("--colour", "--color", metavar="NAME", help="Quantity that colours the lines, or none."),
]
Radius = Annotated[
    float | None,
    typer.Option(
        "--radius", min=0.0, callback=finite, help="Times the true thickness. [dim]\\[default: true, but visible][/]"
    ),
]
Exaggerate = Annotated[
    float | None,
    typer.Option("--exaggerate", min=0.0, callback=finite, help="Times the offset across: sag, place in the hole."),
]
Eye = Annotated[
    str | None,
    typer.Option(
        "--camera",
        metavar="VIEW",
        help="front, right, top, corner, ... or azimuth,elevation[,zoom] in degrees; @NAME follows a thing.",
    ),
]
Size = Annotated[
    str | None,
    typer.Option("--size", metavar="WxH", help="Pixels, 100 to 8192 each way. [dim]\\[default: 1280x720][/]"),
]
Rate = Annotated[
    float | None, typer.Option("--rate", min=0.1, callback=finite, help="Pictures a second of a film, at most.")
]
Speed = Annotated[
    float | None, typer.Option("--speed", min=1e-6, callback=finite, help="Simulated over shown time of a film.")
]
Vtk = Annotated[bool, typer.Option("--vtk", help="Files for ParaView: a .pvd with .vtp frames.")]
Csv = Annotated[bool, typer.Option("--csv", help="Tables: CSV files with units in their headers.")]
Variables = Annotated[
    list[str] | None, typer.Option("--what", metavar="NAME", help="A variable, repeatable. [dim]\\[default: all][/]")
]
Every = Annotated[int, typer.Option("--every", min=1, help="Of so many frames ParaView gets one, and the last.")]
MapFile = Annotated[
    Path, typer.Option("--map", metavar="MAP", help="Which sensor is what, what is estimated and watched: a YAML file.")
]
SourceAddress = Annotated[
    str,
    typer.Option("--source", metavar="FILE|-|mqtt://…|opc.tcp://…", help="Where data come from; - is standard input."),
]
Series = Annotated[
    Path | None,
    typer.Option(
        "-o", "--output", metavar="RESULT", parser=file_named, help="What was found over time, a NetCDF file."
    ),
]
ReplaySpeed = Annotated[
    float | None,
    typer.Option(
        "--speed",
        min=1e-6,
        callback=finite,
        help="Of a file, times real time. [dim]\\[default: as fast as possible][/]",
    ),
]
ResumeState = Annotated[
    Path | None, typer.Option("--resume", metavar="STATE", help="Go on from this state, and keep it there.")
]
StateFile = Annotated[
    Path | None, typer.Option("--state", metavar="STATE", help="Keep the state here, every few seconds.")
]
AccountFile = Annotated[
    Path | None, typer.Option("--account", metavar="FILE", help="Keep the rope's damage here, over all operations.")
]
Serve = Annotated[
    str | None,
    typer.Option(
        "--serve", metavar="PORT", help="Show it in a browser; 0: a free port. HOST:PORT to be seen from elsewhere."
    ),
]
ServeNames = Annotated[
    list[str] | None,
    typer.Option(
        "--serve-name", metavar="NAME", help="Show it under this name too, as of a reverse proxy. Can be repeated."
    ),
]
Lines = Annotated[bool, typer.Option("--json", help="Print a JSON object a sample on standard output, SI units.")]
RecordFile = Annotated[Path, typer.Option("-o", "--output", metavar="FILE.csv", parser=file_named, help="Where to.")]
RowRate = Annotated[str, typer.Option("--rate", help="Rows a second.")]
InputNoise = Annotated[
    list[str] | None, typer.Option("--input-noise", metavar="COLUMN:SIZE", help="Of an input: winch_pos:0.001.")
]
Noise = Annotated[
    str | None,
    typer.Option("--noise", help="Of measured outputs, as a share: 1 %. Without it: the sd of the map. 0: none."),
]
SensorDelay = Annotated[str | None, typer.Option("--delay", help="Of measured outputs.")]
Dropout = Annotated[str | None, typer.Option("--dropout", help="Share of rows that do not arrive.")]
Jitter = Annotated[str | None, typer.Option("--jitter", help="Standard deviation of the stamps.")]
Gaps = Annotated[list[str] | None, typer.Option("--gap", metavar="FROM:TO", help="Times without rows, s; repeatable.")]
Faults = Annotated[
    list[str] | None,
    typer.Option(
        "--fault",
        metavar="COLUMN:KIND:FROM:TO[:SIZE]",
        help="stuck, lost, bias, drift, scale, clip or spike; repeatable.",
    ),
]
SweepPath = Annotated[
    Path,
    typer.Argument(
        metavar="SWEEP", help="A YAML file: the scene, what varies, the plan, what is collected.", show_default=False
    ),
]
Workers = Annotated[
    int | None,
    typer.Option("-j", "--jobs", min=1, show_default=False, help="Workers. [dim]\\[default: all processors][/]"),
]
Scheduler = Annotated[
    str | None,
    typer.Option("--dask", metavar="ADDRESS", help="A Dask scheduler, or local: processes on this machine."),
]
SweepFolder = Annotated[
    Path | None,
    typer.Option(
        "-o", "--output", metavar="FOLDER", help="Result, table and figures. [dim]\\[default: the sweep's name][/]"
    ),
]
GoOn = Annotated[
    bool, typer.Option("--resume", help="Go on with the sweep in that folder: no finished case runs again.")
]
Seed = Annotated[int, typer.Option("--seed", min=0, help="Of the noise.")]
Template = Annotated[
    str | None, typer.Argument(metavar="[TEMPLATE]", help="Which one; see --list.", show_default=False)
]
TextFile = Annotated[
    Path | None,
    typer.Option(
        "-o",
        "--output",
        metavar="FILE",
        parser=file_named,
        help="File to write, - for standard output.",
        show_default=False,
    ),
]
Listed = Annotated[bool, typer.Option("--list", help="List the templates and write nothing.")]
Force = Annotated[bool, typer.Option("--force", help="Overwrite a file that exists.")]
Debug = Annotated[bool, typer.Option("--debug", help="Show the traceback of an unexpected error; may stand anywhere.")]
Version = Annotated[bool, typer.Option("--version", help="Print the version and leave.")]

Methods = Annotated[
    str | None, typer.Option("--methods", help="Between commas. [dim]\\[default: rk4 and the scene's implicit one][/]")
]
Steps = Annotated[
    str | None,
    typer.Option("--steps", help="Between commas, with units or in s."),
]
Meshes = Annotated[
    str | None, typer.Option("--elements", help="Meshes, as factors on the number of elements, between commas: 1,2,4.")
]
Constraints = Annotated[
    str | None, typer.Option("--constraints", help="Ways to impose constraints, between commas, or all.")
]
Newton = Annotated[
    str | None,
    typer.Option("--newton", help="How implicit methods iterate, between commas: modified (factors are kept), full."),
]
Tolerance = Annotated[str, typer.Option("--tolerance", help="Relative error of position that is asked for.")]
Point = Annotated[str | None, typer.Option("--point", help="Node, lump or body to look at.")]
ReferenceMethod = Annotated[str | None, typer.Option("--reference", help="Method of the reference.")]
ReferenceStep = Annotated[
    str | None,
    typer.Option("--reference-step", help="Finest step of the reference, with a unit or in s."),
]
Repeat = Annotated[int, typer.Option("--repeat", min=1, help="Runs of each setting, for its time.")]
Budget = Annotated[
    float, typer.Option("--budget", min=0.1, callback=a_number, help="Processor time in s that one run may take.")
]
Quick = Annotated[bool, typer.Option("--quick", help="A tenth of the time, half of the grid; says what is left out.")]
Stem = Annotated[
    str | None,
    typer.Option(
        "-o",
        "--output",
        metavar="FOLDER_OR_STEM",
        help="A folder that is there, or with / at its end is made; else the beginning of the names of the files.",
    ),
]


Unit = Annotated[
    Path | None,
    typer.Option(
        "-o",
        "--output",
        metavar="FILE.fmu",
        parser=file_named,
        help="Where to. [dim]\\[default: the scene's name with .fmu][/]",
    ),
]
Driven = Annotated[
    list[str] | None,
    typer.Option(
        "--inputs",
        metavar="NAMES",
        help="What is driven, as winch.pay_out_speed,vessel.heave (m/s and m), and vessel.heave.rate (m/s) beside it. "
        "May be repeated.",
    ),
]
Read = Annotated[
    list[str] | None,
    typer.Option("--outputs", metavar="NAMES", help="What is read, as payload.position,winch.tension. As often."),
]
Fmi = Annotated[int, typer.Option("--fmi", metavar="2|3", help="Version of the standard.")]


def check(
    context: typer.Context, scene: Scene, changes: Changes = None, figure: Drawing = None, as_json: Json = False
) -> None:
    """Validate a scene and warn, with cause and cure; runs nothing."""
    from tautline.cli.commands import simulate as verb

    verb.check(context.obj, scene, as_json, figure, changes)


def simulate(
    context: typer.Context,
    scene: Scene,
    output: ResultFile = None,
    changes: Changes = None,
    method: Method = None,
    step: Step = None,
    end: End = None,
    rho_inf: RhoInf = None,
    accuracy: Accuracy = None,
    resume: Resume = None,
    verify: Verify = None,
    as_json: Json = False,
    quiet: Quiet = False,
) -> None:
    """Run a scene, store the result, print a summary.

    An earlier result of the same name is replaced once the run has begun. Ctrl-C keeps what there is.
    """
    from tautline.cli.commands import simulate as verb
    from tautline.cli.options.lists import number, seconds
    from tautline.scene.values.quantity import as_in_a_file

    times = {"step": seconds(step, "--step", ("auto",)), "end": seconds(end, "--end")}
    if accuracy is not None:
        number(accuracy, "--accuracy", "", 1.0, "give a share such as 0.01, or 1 %")
    overrides: dict[str, Any] = {"method": method, **times, "rho_inf": rho_inf, "accuracy": as_in_a_file(accuracy)}
    verb.simulate(context.obj, scene, output, overrides, resume, verify, as_json, quiet, changes)


def study(
    context: typer.Context,
    scene: Scene,
    output: Stem = None,
    changes: Changes = None,
    methods: Methods = None,
    steps: Steps = None,
    elements: Meshes = None,
    constraints: Constraints = None,
    newton: Newton = None,
    tolerance: Tolerance = "1 %",
    end: End = None,
    point: Point = None,
    reference: ReferenceMethod = None,
    reference_step: ReferenceStep = None,
    repeat: Repeat = 3,
    budget: Budget = 60.0,
    quick: Quick = False,
    as_json: Json = False,
) -> None:
    """Error against run time over methods and steps: table, CSV, NetCDF, figure, and which setting to take."""
    from tautline.cli.commands import study as verb
    from tautline.cli.options.lists import number

    until = None if end is None else number(end, "--end", "s")
    asked = verb.StudyOptions(
        methods=methods, steps=steps, elements=elements, constraints=constraints, newton=newton, tolerance=tolerance,
        end=until, point=point, reference=reference, reference_step=reference_step, repeat=repeat,
        budget=budget, quick=quick, changes=changes,
    )  # fmt: skip
    verb.study(context.obj, scene, output, asked, as_json)


def stability(
    context: typer.Context,
    scene: Scene,
    output: Stem = None,
    changes: Changes = None,
    tolerance: Tolerance = "1 %",
    end: End = None,
    point: Point = None,
    budget: Budget = 20.0,
    quick: Quick = False,
    as_json: Json = False,
) -> None:
    """Critical step three ways and what sets it, conditioning, drift, and stiff and extreme variants of the scene."""
    from tautline.cli.commands import stability as verb
    from tautline.cli.commands.study import Options
    from tautline.cli.options.lists import number

    until = None if end is None else number(end, "--end", "s")
    asked = Options(tolerance=tolerance, end=until, point=point, budget=budget, quick=quick, changes=changes)
    verb.stability(context.obj, scene, output, asked, as_json)


def plot(
    context: typer.Context,
    results: Results,
    output: FigurePlace = None,
    what: What = None,
    against: Against = None,
    form: Format = None,
    as_json: Json = False,
) -> None:
    """Draw figures of one result, or of several to compare; or any variable, against time or another."""
    from tautline.cli.commands.plot import plot as draw

    draw(context.obj, results, output, what or (), against, form, as_json)


def render(
    context: typer.Context,
    result: Stored,
    output: FigurePlace = None,
    image: Image = None,
    movie: Movie = None,
    html: Html = None,
    view: View = None,
    colour: Colour = None,
    radius: Radius = None,
    exaggerate: Exaggerate = None,
    camera: Eye = None,
    size: Size = None,
    rate: Rate = None,
    speed: Speed = None,
    as_json: Json = False,
) -> None:
    """Show a result in space: in a window, or as pictures, a film or a web page."""
    from tautline.cli.commands import render as verb

    asked = verb.RenderOptions(
        output=output, image=image, movie=movie, html=html, view=view, colour=colour, radius=radius,
        exaggerate=exaggerate, camera=camera, size=size, rate=rate, speed=speed,
    )  # fmt: skip
    verb.render(context.obj, result, asked, as_json)


def export(
    context: typer.Context,
    result: Stored,
    output: ExportPlace = None,
    vtk: Vtk = False,
    csv: Csv = False,
    what: Variables = None,
    view: View = None,
    exaggerate: Exaggerate = None,
    every: Every = 1,
    as_json: Json = False,
) -> None:
    """Write a result for other programs: ParaView, spreadsheets."""
    from tautline.application.space import look_of
    from tautline.cli.commands import export as verb

    verb.export(context.obj, result, output, vtk, csv, what or (), look_of(view, exaggerate), as_json, every)


def fmu(
    context: typer.Context,
    scene: Scene,
    output: Unit = None,
    changes: Changes = None,
    inputs: Driven = None,
    outputs: Read = None,
    fmi: Fmi = 2,
    as_json: Json = False,
) -> None:
    """Write a scene as an FMU for co-simulation: what is driven goes in, what is read comes out."""
    from tautline.cli.commands import fmu as verb

    verb.fmu(context.obj, scene, output, changes, inputs or (), outputs or (), fmi, as_json)


def twin(
    context: typer.Context,
    scene: Scene,
    map: MapFile,
    source: SourceAddress = "-",
    output: Series = None,
    changes: Changes = None,
    speed: ReplaySpeed = None,
    resume: ResumeState = None,
    state: StateFile = None,
    account: AccountFile = None,
    serve: Serve = None,
    serve_names: ServeNames = None,
    force: Force = False,
    as_json: Lines = False,
    quiet: Quiet = False,
) -> None:
    """Run a scene beside the machine: sensor data in; estimates, hidden quantities and alarms out."""
    from tautline.cli.commands import twin as verb

    given = verb.TwinOptions(
        source=source, speed=speed, output=output, resume=resume, state=state or resume, account=account, serve=serve,
        serve_names=serve_names or (), force=force,
    )  # fmt: skip
    verb.twin(context.obj, scene, map, changes, given, as_json, quiet)


def record(
    context: typer.Context,
    scene: Scene,
    map: MapFile,
    output: RecordFile,
    changes: Changes = None,
    end: End = None,
    rate: RowRate = "10 Hz",
    noise: Noise = None,
    input_noise: InputNoise = None,
    delay: SensorDelay = None,
    dropout: Dropout = None,
    jitter: Jitter = None,
    gap: Gaps = None,
    fault: Faults = None,
    seed: Seed = 0,
    force: Force = False,
    as_json: Json = False,
    quiet: Quiet = False,
) -> None:
    """Write what sensors would show of a scene: a record to rehearse a twin with."""
    from tautline.cli.commands import record as verb

    given = verb.RecordOptions(
        end=end, rate=rate, noise=noise, delay=delay, dropout=dropout, jitter=jitter, gap=gap, fault=fault, seed=seed,
        input_noise=input_noise,
    )  # fmt: skip
    verb.record(context.obj, scene, map, output, changes, given, as_json, quiet, force)


def sweep(
    context: typer.Context,
    file: SweepPath,
    jobs: Workers = None,
    dask: Scheduler = None,
    output: SweepFolder = None,
    resume: GoOn = False,
    changes: Changes = None,
    as_json: Json = False,
    quiet: Quiet = False,
) -> None:
    """Run a scene with many values of some of its keys, on all processors or a cluster."""
    from tautline.cli.commands import sweep as verb

    verb.sweep(context.obj, file, jobs, dask, output, resume, changes, as_json, quiet)


def new(
    context: typer.Context,
    template: Template = None,
    output: TextFile = None,
    listed: Listed = False,
    force: Force = False,
) -> None:
    """Write a commented starter scene."""
    from tautline.cli.commands import starter

    starter.new(context.obj, template, output, listed, force)


def schema(context: typer.Context, output: TextFile = None) -> None:
    """Print the JSON schema of a scene, for editors that complete and check."""
    from tautline.cli.commands import starter

    starter.schema(context.obj, output)


SHARED = (check, simulate, plot, render, export, fmu, twin, record, sweep, study, stability, new, schema)
"""The verbs of every application, in the order of ``--help``."""


def make_app(application: Application | Catalogue, arguments: Sequence[str] = ()) -> typer.Typer:
    """Make the command of an application, or of a catalogue of them.

    Parameters
    ----------
    application : Application or Catalogue
        An application may have ``verbs`` of its own: a sequence of typer commands, named otherwise than the shared.
    arguments : sequence of str
        Those of the process, where it serves one command only. If they ask for a shared verb, that one alone is made:
        typer reads the options of each verb, and the application's own have to be imported.

    Returns
    -------
    typer.Typer
        To be run by `tautline.cli.run.run`.
    """
    catalogue: Any = application if hasattr(application, "for_scene") else Single(cast("Application", application))
    app = typer.Typer(
        name=catalogue.name,
        add_completion=False,
        no_args_is_help=True,
        pretty_exceptions_enable=False,
        rich_markup_mode="rich",
        context_settings={"help_option_names": ["-h", "--help"]},
    )

    @app.callback(invoke_without_command=True, help=catalogue.title)
    def begin(context: typer.Context, debug: Debug = False, version: Version = False) -> None:
        context.obj = catalogue
        if version:
            from importlib.metadata import version as installed

            typer.echo(f"{catalogue.name} (tautline {installed('tautline')})")
            raise typer.Exit

    asked = next((one for one in arguments if not one.startswith("-")), None)
    for verb in [one for one in SHARED if one.__name__ == asked] or (*SHARED, *getattr(application, "verbs", ())):
        app.command()(verb)
    return app
