"""The bit as a scene gives it: hanging off bottom, or on the rock with laws of its torque and of how fast it drills."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field, model_validator

from tautline.scene.choices.words import word
from tautline.scene.model import Model, Switch, Whole
from tautline.scene.refusal import fault
from tautline.scene.values.quantity import quantity

MOST_BLADES = 20
NeverLess = Annotated[float, quantity("N", nonnegative=True, of="weight on bit")]


class Rock(Model):
    """The bottom of the hole: `stiffness` N/m and `damping` N s/m, between bit and rock."""

    stiffness: Annotated[float, quantity("N/m", positive=True, of="contact stiffness")] = 2.5e7
    damping: Annotated[float, quantity("N s/m", nonnegative=True, of="damping coefficient")] = 0.0


class Torque(Model):
    """Torque on the bit, N m, at a weight on bit of `weight` N, and in proportion to it.

    kinetic + (static - kinetic) exp(-speed / decay), decay in rad/s; at rest what holds the bit, up to `static`.
    """

    static: Annotated[float, quantity("N m", nonnegative=True, of="bit torque")]
    kinetic: Annotated[float, quantity("N m", nonnegative=True, of="bit torque")]
    decay: Annotated[float, quantity("rad/s", positive=True, of="rotary speed")] | None = None
    weight: Annotated[float, quantity("N", positive=True, of="weight on bit")] | None = None

    @model_validator(mode="after")
    def _falls(self) -> Torque:
        if self.static < self.kinetic:
            cause = f"smaller than kinetic = {self.kinetic:g}"
            raise fault("static", cause, "what holds a bit at rest is at least what resists it turning: swap the two?")
        return self


class Penetration(Model):
    """Rate of penetration: `rate` m/s at `weight` N and `speed` rad/s, elsewhere times a power of each.

    rate ((W - threshold) / (weight - threshold))^weight_exponent (Omega / speed)^speed_exponent, zero below the
    threshold N and for a bit that turns backwards.
    """

    rate: Annotated[float, quantity("m/s", positive=True, of="rate of penetration")] = Field(examples=["15 m/h"])
    weight: Annotated[float, quantity("N", positive=True, of="weight on bit")] | None = None
    speed: Annotated[float, quantity("rad/s", positive=True, of="rotary speed")] = Field(examples=["120 rpm"])
    threshold: NeverLess = 0.0
    weight_exponent: Annotated[float, quantity("", positive=True, at_most=3.0, of="exponent")] = 1.0
    speed_exponent: Annotated[float, quantity("", positive=True, at_most=3.0, of="exponent")] = 1.0


class Cutting(Model):
    """A drag bit after Detournay and Defourny (1992): cutting and the friction of worn flats.

    Intrinsic specific energy Pa; contact strength Pa and wear flat m (length in all), whose product times the radius is
    the weight that worn flats can take; `friction` mu of the flats, `bit_constant` gamma, `inclination` zeta of the
    cutting force; radius m, half of the hole's diameter where not given. With a number of `blades` each cuts what the
    one before it has left, a delay ago (Richard, Germay and Detournay 2007); else the depth of cut is that of steady
    drilling.
    """

    specific_energy: Annotated[float, quantity("Pa", positive=True, of="specific energy")] = Field(examples=["120 MPa"])
    contact_strength: Annotated[float, quantity("Pa", nonnegative=True, of="specific energy")] = Field(
        0.0, examples=["60 MPa"]
    )
    wear_flat: Annotated[float, quantity("m", nonnegative=True, of="wear flat")] = Field(0.0, examples=["1.2 mm"])
    friction: Annotated[float, quantity("", nonnegative=True, of="friction factor")] = 0.6
    bit_constant: Annotated[float, quantity("", positive=True, of="number of the bit")] = 1.0
    inclination: Annotated[float, quantity("", positive=True, of="number of the bit")] = 0.6
    radius: Annotated[float, quantity("m", positive=True, of="bit radius")] | None = Field(None, examples=["4.25 in"])
    blades: Annotated[Whole, Field(ge=1, le=MOST_BLADES)] | None = None


class Bit(Model):
    """The lower end; `force` in N along the string, positive downhole, and on bottom `weight` on bit at the start, N.

    `slip_speed` rad/s is where the torque of an explicit run, which does not know rest, is in full.
    """

    on_bottom: Switch = False
    lateral: Annotated[Literal["free", "pinned"], word("free", "pinned")] = "free"
    force: Annotated[float, quantity("N", of="force")] = 0.0
    weight: NeverLess | None = Field(None, examples=["100 kN"])
    rock: Rock = Rock()
    torque: Torque | None = Field(None, examples=["{static: 6 kN m, kinetic: 4 kN m}"])
    penetration: Penetration | None = Field(None, examples=["{rate: 15 m/h, speed: 120 rpm}"])
    cutting: Cutting | None = Field(None, examples=["{specific_energy: 120 MPa}"])
    slip_speed: Annotated[float, quantity("rad/s", positive=True, of="rotary speed")] = 0.1

    @property
    def load(self) -> float:
        """Force on the string's end at the start, N, positive downhole."""
        return self.force - (self.weight or 0.0 if self.on_bottom else 0.0)

    @model_validator(mode="after")
    def _drills(self) -> Bit:
        if not self.on_bottom:
            return self
        if self.weight is None:
            raise fault("weight", "is missing", "a bit on the bottom needs its weight on bit, such as `weight: 100 kN`")
        for key in ("torque", "penetration"):
            if self.cutting is not None and getattr(self, key) is not None:
                cause = "is given together with `cutting`, which tells the torque and the rate of penetration"
                raise fault(key, cause, f"remove `cutting`, or `{key}`")
            law = getattr(self, key)
            if law is not None and law.weight is None and self.weight == 0.0:
                cause = "is missing: the bit's own weight is 0 at the start"
                raise fault((key, "weight"), cause, f"give the weight on bit at which this {key} holds")
        drilled = self.penetration
        if drilled is not None and drilled.threshold >= (drilled.weight or self.weight):
            cause = f"not below {drilled.weight or self.weight:g} N, the weight at which the rate holds"
            raise fault(("penetration", "threshold"), cause, "give the weight below which the bit does not drill")
        if self.cutting is not None and self.cutting.blades is not None and self.rock.damping > 0.0:
            cause = "blades cut the rock without a damper"
            raise fault(("rock", "damping"), cause, "remove it, or `cutting.blades`")
        return self
