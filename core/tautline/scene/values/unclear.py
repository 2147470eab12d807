"""Names of units that stand for one thing here and for another there: they are refused, with what to write instead.

pint gives each of them one meaning, that of the USA or of a physicist, and a number that is a tenth wrong looks right.
Names that only one meaning fits are units all the same: `bbl` is the barrel of the oilfield, `gal` its gallon.
"""

from __future__ import annotations

_TON = "may be the tonne of 1000 kg, or a ton of 2000 lb or 2240 lb; write t for tonnes, or the mass in lb"
_TON_FORCE = "may be the weight of 1000 kg, of 2000 lb or of 2240 lb; write tf for that of 1000 kg, or the force in kip"
_HUNDREDWEIGHT = "may be 100 lb or 112 lb; write the mass in lb"
_BRITISH = "is larger by a fifth in Britain than in the USA; write the volume in l, or in gal, the US gallon"
_MIL = "may be a thousandth of an inch, of a radian, or a part of a turn; write thou for the length, mrad for the angle"
SEVERAL = {
    **dict.fromkeys(("ton", "tons"), _TON),
    **dict.fromkeys(("tonf", "tonsf"), _TON_FORCE),
    **dict.fromkeys(("cwt", "hundredweight", "hundredweights"), _HUNDREDWEIGHT),
    **dict.fromkeys(("pint", "pints", "pt", "quart", "quarts", "qt"), _BRITISH),
    **dict.fromkeys(("mil", "mils"), _MIL),
}
"""Name in small letters -> what it may be, and what to write."""
OTHER_NAMES = {
    **dict.fromkeys(("mt", "mts"), "is a megatonne by its letters; write t for the tonne of 1000 kg"),
    "te": "is no unit of the SI; write t for the tonne of 1000 kg",
    **dict.fromkeys(("metric_ton", "metric_tons"), "is written t here, the tonne of 1000 kg"),
    **dict.fromkeys(("short_ton", "short_tons"), "is 2000 lb; write the mass in lb"),
    **dict.fromkeys(("long_ton", "long_tons"), "is 2240 lb; write the mass in lb"),
    **dict.fromkeys(("ton_force", "tons_force"), _TON_FORCE),
    "metric_ton_force": "is written tf here, the weight of 1000 kg",
    "short_ton_force": "is the weight of 2000 lb; write the force in kip: 2 for each",
    "long_ton_force": "is the weight of 2240 lb; write the force in kip: 2.24 for each",
}
"""The same of names that one industry has for a unit, and that are another unit or none by their letters."""


TIMES = {"k": "a thousand", "M": "a million"}
"""Prefixes that are read before a name of several units: what was not clear is not clear so many times."""


def unclear(name: str) -> str:
    """What is unclear of a name of a unit, and what to write, as the rest of a sentence; empty of any other name."""
    if own := SEVERAL.get(name.lower(), "") or OTHER_NAMES.get(name.lower(), ""):
        return own
    rest = SEVERAL.get(name[1:].lower(), "") if name[:1] in TIMES else ""
    return f"would be {TIMES[name[:1]]} times '{name[1:]}', and that {rest}" if rest else ""


def several(name: str) -> str:
    """What a name that means units of different sizes may be, without what to write; empty of any other name."""
    return SEVERAL.get(name.lower(), "").partition("; ")[0]
