"""The table of plausible ranges: a row a quantity, for the warnings of unit mistakes.

A quantity of a scene names its row where it is declared, ``quantity("m", of="hole diameter")``. A number outside of the
row's range is not refused, it is warned of, with the unit under which the number as typed would lie inside. Ranges hold
for models of the laboratory as well as for the largest machine, and are of sizes: of the number without its sign. Zero
is never warned of. `tautline.scene.unit_slips` makes the warnings; `benchmarks/pages/plausible_ranges.py` writes the
table into docs/ranges.md.
"""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Range:
    """A row: what is plausible of a quantity.

    Attributes
    ----------
    unit : str
        In SI; empty for a pure number, or where nothing is said.
    low, high : float or None
        Of the size, in `unit`; None where any number is plausible, and `why` says why.
    meant : tuple of str
        Units that are often meant by a number without them, or with another, the likeliest first.
    why : str
        What the range was taken from: common knowledge of the field, or the reason why there is none.
    """

    unit: str
    low: float | None
    high: float | None
    meant: tuple[str, ...] = ()
    why: str = ""

    def holds(self, value: float) -> bool:
        """Whether a value in SI is plausible; zero and rounding at the ends are."""
        if self.low is None or self.high is None or value == 0.0:
            return True
        return self.low * (1.0 - 1e-9) <= abs(value) <= self.high * (1.0 + 1e-9)


def _any(why: str) -> Range:
    return Range("", None, None, (), why)


_SMALL = ("mm", "in", "cm")
_LONG = ("ft", "mm", "cm", "km")
_FORCES = ("kN", "klbf", "lbf", "MN")
_TIMES = ("ms", "us", "min", "h")
_TORQUES = ("kN m", "ft-lbf", "kN mm")

RANGES: dict[str, Range] = {
    # Time, and how a scene is solved.
    "time step": Range("s", 1e-9, 2.0, ("ms", "us"), "waves in a bar of millimetres, to the slow swing of a long rope"),
    "time simulated": Range("s", 1e-6, 1e6, ("ms", "min", "h"), "a wave in a bar, to eleven days"),
    "interval of frames": Range("s", 1e-9, 1e5, ("ms", "min"), "as the time that is simulated"),
    "moment": Range("s", 1e-9, 1e6, _TIMES, "as the time that is simulated"),
    "moment of a record": _any("as its clock counts: a run that does not lie in the record is refused"),
    "duration": Range("s", 1e-9, 1e6, _TIMES, "as the time that is simulated"),
    "period": Range("s", 1e-6, 1e5, _TIMES, "a wave in a bar, to the tide"),
    "frequency": Range("Hz", 1e-5, 1e6, ("mHz", "kHz"), "one over the period"),
    "delay": Range("s", 1e-6, 10.0, ("ms", "us"), "a control system"),
    "step error": Range("m", 1e-16, 1.0, ("mm", "um"), "from rounding to what no study would accept"),
    "relative error": Range(
        "", 1e-7, 0.25, ("%",), "from what a day of computing reaches to what no study would accept"
    ),
    "frames a second": Range("", 1e-4, 1e7, (), "as the interval of frames"),
    "parameter of the method": _any("bounds are those of the method, and what is outside of them is refused"),
    "control gain": _any("has the unit and the size of the machine that it controls"),
    "bound of an output": _any("the unit is that of the output, which is a result: anything can come out"),
    # Geometry.
    "position": Range("m", 0.0, 12_000.0, _LONG, "the deepest sea, and above the highest crane by far"),
    "length": Range("m", 1e-6, 30_000.0, _LONG, "a rod of the laboratory, to the longest well or umbilical"),
    "distance": Range("m", 0.0, 12_000.0, _LONG, "as a position"),
    "material coordinate": Range("m", 0.0, 1e5, _LONG, "as a length, from any origin"),
    "direction": _any("a direction may be given by a vector of any length"),
    "factor": _any("a factor of the author's own"),
    "angle": Range("rad", 0.0, 6.3, ("deg",), "one turn; bare numbers are radians"),
    "slew": Range("rad", 0.0, 6.3, ("deg",), "one turn; bare numbers are radians"),
    "luff": Range("rad", 0.0, 3.15, ("deg",), "half a turn: booms luff by less; bare numbers are radians"),
    "inclination": Range("rad", 0.0, 3.15, ("deg",), "0 is straight down, 180 deg straight up"),
    "phase": Range("rad", 0.0, 12.6, ("deg",), "two turns; bare numbers are radians"),
    # Forces and masses.
    "gravity": Range("m/s^2", 1e-6, 30.0, ("ft/s^2", "cm/s^2", "mm/s^2"), "a planet's: 9.81 on ours, 24.8 on Jupiter"),
    "speed": Range("m/s", 0.0, 500.0, ("mm/s", "ft/min", "m/min"), "a snapping rope is below"),
    "current speed": Range("m/s", 0.0, 8.0, ("kn", "cm/s", "ft/s"), "the strongest tidal race"),
    "acceleration": Range("m/s^2", 0.0, 1e5, ("mm/s^2",), "a snapping rope is below"),
    "angular speed": Range("rad/s", 0.0, 1e4, ("rpm", "deg/s"), "a motor of the laboratory"),
    "angular acceleration": Range("rad/s^2", 0.0, 1e6, ("deg/s^2",), "a motor of the laboratory"),
    "rate of change": _any("the rate of a function whose own values are looked at"),
    "force": Range("N", 1e-9, 1e10, _FORCES, "a thread of the laboratory, to the cable of a bridge"),
    "load per length": Range("N/m", 1e-9, 1e7, ("kN/m", "lbf/ft"), "a thread of the laboratory, to a bridge's cable"),
    "torque": Range("N m", 1e-9, 1e8, _TORQUES, "a motor of the laboratory, to the largest winch"),
    "mass": Range("kg", 1e-9, 1e8, ("t", "lb", "g"), "a bead of the laboratory, to the heaviest lift, 2e7 kg"),
    "moment of inertia": Range("kg m^2", 1e-14, 1e12, ("lb ft^2", "t m^2"), "as mass, over its size squared"),
    "volume": Range("m^3", 1e-12, 1e6, ("l", "cm^3", "ft^3"), "as mass, in water"),
    "spring stiffness": Range("N/m", 1e-6, 1e14, ("kN/m", "N/mm", "lbf/ft"), "a thread, to what stands for rigid"),
    "damping coefficient": Range("N s/m", 1e-9, 1e11, ("kN s/m", "lbf s/ft"), "of the springs above"),
    "quadratic drag": Range("N s^2/m^2", 1e-9, 1e9, ("kN s^2/m^2",), "half of density, area and drag coefficient"),
    "share": Range("", 0.0, 1.0, ("%",), "a part of a whole"),
    "number of cycles": Range("", 1e-6, 1e10, (), "a rope over sheaves lasts some hundred to some million"),
    # Ropes, hoses and cables.
    "axial stiffness": Range("N", 1e-6, 1e12, ("kN", "MN", "lbf", "klbf"), "EA: a rubber thread, to a tunnel's tube"),
    "bending stiffness": Range("N m^2", 1e-16, 1e12, ("N mm^2", "kN m^2"), "EJ: a thread, to a tunnel's tube"),
    "mass per length": Range("kg/m", 1e-8, 1e5, ("g/m", "lb/ft"), "a thread, to a tunnel's tube"),
    "damping time": Range("s", 1e-12, 10.0, ("ms", "us"), "stress over rate of strain, as a share of the stiffness"),
    "rate of damping": Range("1/s", 1e-9, 1e4, ("1/min",), "a motion that dies out in days, to one in no time"),
    "rope diameter": Range("m", 2e-5, 0.5, _SMALL, "a wire, to the cable of a bridge; EN 12385 ropes are 6 to 60 mm"),
    "breaking load": Range("N", 1e-3, 1e9, _FORCES, "a thread, to a bridge's cable"),
    "modulus of the rope": Range(
        "Pa",
        1e6,
        4e11,
        (),
        "EA over the area of its circle: rubber 5 MPa, nylon 0.5 to 5 GPa, wire rope 50 to 130 GPa, carbon 200 GPa",
    ),
    "strength of the rope": Range(
        "Pa",
        5e6,
        6e9,
        (),
        "breaking load over the area of its circle: rubber 10 MPa, wire rope 0.5 to 1.2 GPa, the best fibre 4 GPa",
    ),
    "density of the rope": Range(
        "kg/m^3",
        200.0,
        25_000.0,
        (),
        "mass per length over the area of its circle: floating fibre 600, wire rope 4000 to 5500, lead 11 300",
    ),
    "flow speed": Range("m/s", 1e-6, 500.0, ("mm/s", "ft/s", "km/h"), "dripping water, to gas near its sound"),
    "ratio of outlet speed": Range("", 0.01, 100.0, ("%",), "a diffuser, to a jet cutter's nozzle"),
    # Cranes.
    "radius of a sheave or drum": Range("m", 5e-4, 20.0, _SMALL, "a pulley of the laboratory, to a cableway's sheave"),
    "bearing radius": Range("m", 1e-4, 5.0, _SMALL, "the pin of a sheave"),
    "winch speed": Range("m/s", 1e-6, 20.0, ("m/min", "ft/min", "mm/s"), "hoists to 5 m/s, mine winders to 20 m/s"),
    "drum speed": Range("rad/s", 1e-6, 50.0, ("rpm", "deg/s"), "winch speed over the radius of a drum"),
    "groove angle": Range("rad", 0.1, 3.15, ("deg",), "V grooves of 30 to 60 deg"),
    "fleet angle": Range("rad", 1e-4, 1.58, ("deg",), "limits of 1.5 to 4 deg are usual"),
    "surge or sway": Range("m", 0.0, 1000.0, ("mm", "cm"), "a moored ship's drift"),
    "heave": Range("m", 0.0, 30.0, ("cm", "ft", "mm"), "half of the highest wave measured, and more"),
    "roll or pitch": Range("rad", 0.0, 1.1, ("deg",), "60 deg: cranes work below 5; bare numbers are radians"),
    "yaw": Range("rad", 0.0, 6.3, ("deg",), "one turn; bare numbers are radians"),
    "significant wave height": Range("m", 5e-4, 25.0, ("cm", "mm", "ft"), "a model basin, to the highest sea, 20 m"),
    "peak period": Range("s", 0.1, 30.0, ("ms",), "a model basin, to long swell"),
    "peak factor": Range("", 0.5, 10.0, (), "gamma of JONSWAP: 1 to 7 (DNV-RP-C205), 3.3 on average"),
    "response to waves": _any("the unit is that of the motion, over a metre of wave"),
    "water density": Range("kg/m^3", 500.0, 3000.0, ("sg", "pcf", "ppg", "g/cm^3"), "fresh 1000, sea 1025, brine 2300"),
    "drag coefficient": Range("", 0.001, 20.0, ("%",), "a smooth cylinder 0.5 to 1.2 (DNV-RP-C205), blades more"),
    "added mass coefficient": Range(
        "", 0.001, 20.0, ("%",), "1 for a cylinder (DNV-RP-C205), more in a narrow annulus"
    ),
    "stroke": Range("m", 1e-4, 100.0, ("mm", "cm", "ft"), "an actuator of the laboratory, to a rope's compensator"),
    # Wells and drill strings.
    "hole diameter": Range("m", 0.004, 2.0, ("in", "mm", "cm"), "3 3/4 to 36 in are drilled; tubes of the laboratory"),
    "pipe diameter": Range(
        "m", 5e-4, 1.5, ("in", "mm", "cm"), "API 5DP pipe of 2 3/8 to 6 5/8 in; collars to 14 in; rods"
    ),
    "bit radius": Range("m", 0.002, 1.0, ("in", "mm", "cm"), "half of the hole's"),
    "eccentricity": Range("m", 1e-6, 0.1, ("mm", "in"), "collars 1 to 10 mm"),
    "depth": Range("m", 0.01, 15_000.0, ("ft", "km"), "the longest well is 15 km"),
    "radius of curvature": Range("m", 0.2, 1e5, ("ft", "km"), "short radius wells 12 m, tubes of the laboratory less"),
    "dogleg severity": Range(
        "rad/m", 1e-7, 0.5, ("deg/30m", "deg/100ft", "deg/10m", "deg/m"), "3 to 15 deg/30m are usual, short radius 150"
    ),
    "Young's modulus": Range(
        "Pa",
        1e9,
        1.2e12,
        ("GPa", "Mpsi", "MPa", "ksi"),
        "steel 206, titanium 110, aluminium 70, plastics of the laboratory 2 to 4 GPa",
    ),
    "shear modulus": Range("Pa", 3e8, 5e11, ("GPa", "Mpsi", "MPa", "ksi"), "0.38 of Young's modulus"),
    "pipe density": Range(
        "kg/m^3", 700.0, 23_000.0, ("sg", "pcf", "ppg", "g/cm^3"), "steel 7850, aluminium 2700, plastics 900"
    ),
    "pipe mass per length": Range("kg/m", 1e-4, 3000.0, ("lb/ft", "g/m"), "drill pipe 10 to 60, collars to 500 kg/m"),
    "second moment": Range("m^4", 1e-16, 0.1, ("in^4", "cm^4", "mm^4"), "pi/64 of the diameter's fourth power"),
    "mud density": Range(
        "kg/m^3", 200.0, 3000.0, ("ppg", "sg", "pcf", "g/cm^3"), "foam 200, water 1000, heavy mud 2400"
    ),
    "friction factor": Range(
        "", 1e-4, 1.5, ("%",), "0.1 to 0.5 in a well, 0.05 to 0.2 of rope in a groove, dry rubber 1"
    ),
    "slip speed": Range("m/s", 1e-12, 1.0, ("mm/s", "um/s"), "below what moves"),
    "contact stiffness": Range("N/m", 1.0, 1e14, ("kN/m", "MN/m", "lbf/ft"), "a soft wall of the laboratory, to rigid"),
    "rotary damping": Range("N m s/rad", 1e-12, 1e8, ("kN m s/rad",), "a rod of the laboratory, to a top drive"),
    "block position": Range("m", 0.0, 15_000.0, ("ft", "mm"), "as the depth"),
    "block speed": Range("m/s", 1e-7, 10.0, ("m/min", "ft/min", "m/h"), "tripping at 0.5 to 2 m/s"),
    "rotary speed": Range("rad/s", 1e-4, 40.0, ("rpm", "deg/s"), "60 to 250 rpm; 40 rad/s are 380 rpm"),
    "hook load": Range("N", 0.01, 3e7, _FORCES, "block and drive of 50 to 1000 kN"),
    "weight on bit": Range("N", 100.0, 2e6, ("kN", "klbf"), "10 to 300 kN; drilling rigs of the laboratory 1 kN"),
    "yield load": Range("N", 1.0, 1e9, _FORCES, "API 5DP pipe 1 to 5 MN"),
    "bit torque": Range("N m", 1e-3, 1e6, _TORQUES, "1 to 30 kN m"),
    "rate of penetration": Range("m/s", 1e-7, 0.3, ("m/h", "ft/h", "m/min"), "1 to 100 m/h; 0.03 m/s are 108 m/h"),
    "specific energy": Range("Pa", 1e5, 1e10, ("MPa", "ksi", "psi", "GPa"), "rock of 10 to 500 MPa"),
    "wear flat": Range("m", 1e-6, 0.2, ("mm", "in"), "cutters of 13 mm, worn by some; all blades together"),
    "number of the bit": Range("", 0.01, 10.0, (), "about 1 (Detournay and Defourny 1992)"),
    "exponent": Range("", 0.01, 3.0, (), "0.3 to 2 of fitted drilling rates"),
}
"""Name of a quantity -> what is plausible of it."""

EXAMPLES = {
    "time simulated": "60 s", "interval of frames": "50 ms", "moment": "10 s", "duration": "5 s", "period": "8 s",
    "delay": "20 ms", "step error": "1 mm", "position": "12 m", "length": "30 m", "distance": "12 m",
    "material coordinate": "30 m", "inclination": "30 deg", "speed": "2 m/s", "spring stiffness": "100 kN/m",
    "current speed": "0.8 m/s",
    "axial stiffness": "50 MN", "mass per length": "4.5 kg/m", "rope diameter": "28 mm", "breaking load": "500 kN",
    "flow speed": "15 m/s", "radius of a sheave or drum": "300 mm", "bearing radius": "50 mm", "groove angle": "45 deg",
    "fleet angle": "2 deg", "surge or sway": "2 m", "heave": "1.5 m", "roll or pitch": "3 deg", "yaw": "3 deg",
    "significant wave height": "2 m", "peak period": "8 s", "water density": "1025 kg/m^3", "stroke": "4 m",
    "hole diameter": "8.5 in", "bit radius": "4.25 in", "eccentricity": "5 mm", "depth": "3000 m",
    "radius of curvature": "300 m", "shear modulus": "80 GPa", "pipe density": "7850 kg/m^3", "slip speed": "1 mm/s",
    "block position": "30 m", "rate of penetration": "15 m/h", "hook load": "1000 kN", "weight on bit": "100 kN",
    "bit torque": "5 kN m", "specific energy": "60 MPa", "wear flat": "1.2 mm",
}  # fmt: skip
"""Name of a quantity -> how one is written; what is not among them has the example of its unit."""

RATES = {"m": "speed", "m/s": "acceleration", "rad": "angular speed", "rad/s": "angular acceleration"}
"""Unit of a function of time -> row of its rate of change; those of others are not looked at."""


def rate_of(unit: str) -> str:
    """Row of the rate of change of a function of time whose value has a unit."""
    return RATES.get(unit, "rate of change")


def in_range(row: Range) -> str:
    """The range in words: ``0.004 to 2 m``."""
    assert row.low is not None and row.high is not None
    if row.low == 0.0:
        return f"up to {sized(row.high, row.unit)}"
    low, high = sized(row.low, row.unit), sized(row.high, row.unit)
    same = row.unit and low.endswith(f" {row.unit}") and high.endswith(f" {row.unit}")
    return f"{low.removesuffix(f' {row.unit}') if same else low} to {high}"


def sized(value: float, unit: str) -> str:
    """A number in SI for people: ``206.8 GPa``; four digits, and prefixes for forces and stresses."""
    if unit in ("N", "Pa", "N m", "N/m"):
        for factor, letter in ((1e9, "G"), (1e6, "M"), (1e3, "k")):
            if factor <= abs(value) < 1e4 * factor:
                value, unit = value / factor, letter + unit
                break
    text = f"{value:.0f}" if 1e3 <= abs(value) < 1e6 else f"{value:.4g}"
    return f"{text} {unit}".strip()
