"""Derive the lumped string's equations and write them as kernels: ``python -m tautline.lumped.derive``.

One generic body, one link and one bending triple are derived symbolically and looped over by the kernels: the
equations of n bodies at once grow beyond use (27 000 operations at n = 12). The generic body is Kane's method
(``sympy.physics.mechanics.KanesMethod``) in the Bishop frame of the nominal curve; link and bending triple are
gradients and Hessians of a stretch and an energy. Tangents (eq. 2.166) are derivatives of the same expressions.

The result, ``generated.py``, is checked in with the hash of this derivation: a run never imports sympy.
"""

from __future__ import annotations

import hashlib
from pathlib import Path

import sympy as sp
from sympy.physics import mechanics as me
from sympy.printing.pycode import PythonCodePrinter

HERE = Path(__file__).parent

# Coordinates of a body: s along the curve, lateral u and v, rotation theta about the tangent.
Q = sp.symbols("s u v th")
V = sp.symbols("sd ud vd thd")
A = sp.symbols("sdd udd vdd thdd")
MASS, J, JT, MA, W, E1, E2 = sp.symbols("m J Jt ma W e1 e2")
K1, K2 = sp.symbols("k1 k2")
G1, G2, G3 = sp.symbols("g1 g2 g3")


def body_by_kane(eccentric: bool) -> tuple[sp.Matrix, sp.Matrix]:
    """Mass matrix (4, 4) and forcing (4, 1) of one body on an arc of constant curvature, eq. 2.159.

    ``ma`` is added mass and inside fluid, which follow the lateral motion only; ``W`` is the buoyed weight in N and
    ``g1, g2, g3`` the components of the downward unit vector in the Bishop frame.
    """
    t = me.dynamicsymbols._t
    q = me.dynamicsymbols("s u v theta")
    w = me.dynamicsymbols("ws wu wv wtheta")
    _, u, v, theta = q
    ws, wu, wv, wtheta = w
    ground = me.ReferenceFrame("N")
    bishop = me.ReferenceFrame("B")
    bishop.set_ang_vel(ground, ws * (K1 * bishop.y - K2 * bishop.x))
    steel = me.ReferenceFrame("R")
    steel.orient_axis(bishop, theta, bishop.z)
    steel.set_ang_vel(bishop, wtheta * bishop.z)

    origin, centre = me.Point("O"), me.Point("P")
    origin.set_vel(ground, 0)
    centre.set_vel(ground, ws * (1 - K1 * u - K2 * v) * bishop.z + wu * bishop.x + wv * bishop.y)
    e1, e2 = (E1, E2) if eccentric else (sp.Integer(0), sp.Integer(0))
    cog = centre.locatenew("C", e1 * steel.x + e2 * steel.y)
    cog.set_vel(ground, centre.vel(ground) + steel.ang_vel_in(ground).cross(cog.pos_from(centre)))
    inertia = me.inertia(steel, JT, JT, J)
    body = me.RigidBody("body", cog, steel, MASS, (inertia, cog))
    weight = (cog, W * (G1 * bishop.x + G2 * bishop.y + G3 * bishop.z))

    rates = [qi.diff(t) - wi for qi, wi in zip(q, w, strict=True)]
    kane = me.KanesMethod(ground, q_ind=list(q), u_ind=list(w), kd_eqs=rates)
    kane.kanes_equations([body], loads=[weight])
    plain = dict(zip([*w, *q], [*V, *Q], strict=True))
    mass = kane.mass_matrix.subs({qi.diff(t): wi for qi, wi in zip(q, w, strict=True)}).subs(plain)
    forcing = kane.forcing.subs({qi.diff(t): wi for qi, wi in zip(q, w, strict=True)}).subs(plain)
    mass += sp.diag(0, MA, MA, 0)
    return mass.applyfunc(sp.trigsimp), forcing.applyfunc(sp.expand)


def along_curve(expression: sp.Expr, coordinate: sp.Symbol) -> sp.Expr:
    """Derivative by a coordinate; along s the frame turns: g1' = -k1 g3, g2' = -k2 g3, g3' = k1 g1 + k2 g2."""
    derivative = sp.diff(expression, coordinate)
    if coordinate is Q[0]:
        turning = ((G1, -K1 * G3), (G2, -K2 * G3), (G3, K1 * G1 + K2 * G2))
        derivative += sum(sp.diff(expression, g) * rate for g, rate in turning)
    return derivative


def chord() -> tuple[sp.Expr, list[sp.Symbol], dict[sp.Symbol, sp.Expr]]:
    """Axial distance of two bodies beyond l0, corrected for their offsets inside the bend.

    It is x2 - x1 - K with the K of docs/lumped_string.md; the turning (Phi1, Phi2) is linear in x on an arc. The
    last of what is returned says how the code calls the turning's values, f1 and f2.
    """
    x1, u1, v1, x2, u2, v2 = coordinates = list(sp.symbols("x1 u1 v1 x2 u2 v2"))
    held = {}
    turning = []
    for i, x in enumerate((x1, x2), start=1):
        for axis in (1, 2):
            start, k, value = sp.symbols(f"p{axis}{i} k{axis}{i} f{axis}{i}")
            turning.append(start + k * x)
            held[start] = value - k * x
    inside = (turning[2] - turning[0]) * (u1 + u2) + (turning[3] - turning[1]) * (v1 + v2)
    return x2 - x1 - inside / 2, coordinates, held


def link_stretch() -> tuple[sp.Expr, list[sp.Symbol]]:
    """Stretch of a link whose chord is ``a`` longer than l0 and off by du, dv; written so that no digit is lost."""
    l0, a, du, dv = sp.symbols("l0 a du dv")
    length = sp.sqrt((l0 + a) ** 2 + du**2 + dv**2)
    return (2 * l0 * a + a**2 + du**2 + dv**2) / (length + l0), [a, du, dv]


def bending_energy() -> tuple[sp.Expr, list[sp.Symbol]]:
    """Energy of the bend between two links, divided by EI / lb (docs/lumped_string.md).

    ``w1..w3`` and ``w4..w6`` are the vectors of the links above and below, in the frame of the hole; ``w7, w8`` is
    how far the hole itself turns from one to the other.
    """
    w = list(sp.symbols("w1:9"))
    upper, lower = sp.Matrix(w[:3]), sp.Matrix(w[3:6])
    bend = lower / sp.sqrt(lower.dot(lower)) - upper / sp.sqrt(upper.dot(upper)) + sp.Matrix([0, w[6], w[7]])
    return bend.dot(bend) / 2, w


class _Printer(PythonCodePrinter):
    """Python code whose functions are bare names, and whose half powers were taken out before."""

    def _print_Pow(self, expr, **kwargs):
        if expr.exp.is_Integer and 1 < expr.exp <= 6:
            # In brackets: a product stands here for a power, which binds tighter.
            return f"({'*'.join([self.parenthesize(expr.base, 60)] * int(expr.exp))})"
        if expr.exp == -1:
            return f"1.0/{self.parenthesize(expr.base, 60)}"
        if expr.exp.is_Integer and expr.exp < 0:
            return f"1.0/({'*'.join([self.parenthesize(expr.base, 60)] * int(-expr.exp))})"
        return super()._print_Pow(expr, **kwargs)

    def _print_Integer(self, expr):
        return f"{expr.p}.0"

    def _print_Rational(self, expr):
        return f"{expr.p}.0/{expr.q}.0" if expr.q != 1 else f"{expr.p}.0"


def _root_powers(expressions: list[sp.Expr]) -> tuple[list[tuple[sp.Symbol, sp.Expr]], list[sp.Expr]]:
    """Name each square root once and write x^(n/2) as a power of it or of one over it: pow() is dear, so is /."""
    names: dict[sp.Expr, tuple[sp.Symbol, sp.Symbol]] = {}

    def half(e: sp.Expr) -> bool:
        return e.is_Pow and e.exp.is_Rational and e.exp.q == 2

    def named(e: sp.Expr) -> sp.Expr:
        number = len(names) + 1
        root, over = names.setdefault(e.base, (sp.Symbol(f"root{number}"), sp.Symbol(f"over{number}")))
        return root**e.exp.p if e.exp > 0 else over ** (-e.exp.p)

    replaced = [e.replace(half, named) for e in expressions]
    return [(root, sp.sqrt(base)) for base, (root, _) in names.items()], replaced


def _function(name: str, arguments: str, doc: str, outputs: list[tuple[str, sp.Expr]], returns: str = "") -> str:
    """Text of one kernel: common subexpressions first, then the outputs."""
    roots, expressions = _root_powers([e for _, e in outputs])
    everything = [base for _, base in roots] + expressions
    common, reduced = sp.cse(everything, symbols=sp.numbered_symbols("c"), optimizations="basic", order="none")
    printer = _Printer({"fully_qualified_modules": False})
    root_of = dict(zip([r for r, _ in roots], reduced[: len(roots)], strict=True))
    lines = [f"@kernel\ndef {name}({arguments}):", f'    """{doc}"""']
    pending, done = list(common), set(root_of)
    for root, value in root_of.items():
        for symbol, expression in [p for p in pending if _reaches(value, p[0], common)]:
            lines.append(f"    {symbol} = {printer.doprint(expression)}")
            pending.remove((symbol, expression))
        lines.append(f"    {root} = {printer.doprint(value)}")
        over = sp.Symbol(str(root).replace("root", "over"))
        if any(e.has(over) for e in [*reduced, *(e for _, e in common)]):
            lines.append(f"    {over} = 1.0/{root}")
    assert done == set(root_of)
    lines += [f"    {symbol} = {printer.doprint(expression)}" for symbol, expression in pending]
    for (target, _), expression in zip(outputs, reduced[len(roots) :], strict=True):
        lines.append(f"    {target} = {printer.doprint(expression)}")
    if returns:
        lines.append(f"    return {returns}")
    return "\n".join(lines) + "\n"


def _reaches(expression: sp.Expr, symbol: sp.Symbol, common: list[tuple[sp.Symbol, sp.Expr]]) -> bool:
    """Whether an expression needs a common subexpression, directly or through others."""
    definitions = dict(common)
    open_symbols, seen = set(expression.free_symbols), set()
    while open_symbols:
        current = open_symbols.pop()
        if current == symbol:
            return True
        if current in definitions and current not in seen:
            seen.add(current)
            open_symbols |= definitions[current].free_symbols
    return False


def _body_kernels(prefix: str, eccentric: bool) -> list[str]:
    mass, forcing = body_by_kane(eccentric)
    force = mass * sp.Matrix(A) - forcing
    inertia = "m, J, Jt, ma, W" + (", e1, e2" if eccentric else "")
    state = f"{inertia}, k1, k2, g1, g2, g3, u, v, th, sd, ud, vd, thd"
    what = "one body on an arc" + (", its centre of gravity off the axis" if eccentric else "")
    energy = sp.Rational(1, 2) * (sp.Matrix(V).T * mass * sp.Matrix(V))[0]
    entries = [(i, j) for i in range(4) for j in range(4)]
    nonzero = [(i, j) for i, j in entries if mass[i, j] != 0]
    stiffness = sp.Matrix(4, 4, lambda i, j: along_curve(force[i], Q[j]))
    damping = sp.Matrix(4, 4, lambda i, j: sp.diff(force[i], V[j]))
    return [
        _function(
            f"{prefix}_residual", f"{state}, sdd, udd, vdd, thdd",
            f"M a - F of {what}, by s, u, v, theta.", [(f"r{i}", force[i]) for i in range(4)], "r0, r1, r2, r3",
        ),
        _function(
            f"{prefix}_mass", f"{inertia}, k1, k2, u, v, th, mass",
            f"Entries of M (4, 4) of {what} that are not always zero.",
            [(f"mass[{i}, {j}]", mass[i, j]) for i, j in nonzero],
        ),
        _function(
            f"{prefix}_tangent", f"{state}, sdd, udd, vdd, thdd, stiffness, damping",
            f"dr/dq and dr/dv (4, 4) of {what}.",
            [(f"stiffness[{i}, {j}]", stiffness[i, j]) for i, j in entries]
            + [(f"damping[{i}, {j}]", damping[i, j]) for i, j in entries],
        ),
        _function(
            f"{prefix}_kinetic_energy", f"{inertia}, k1, k2, u, v, th, sd, ud, vd, thd",
            f"Kinetic energy of {what}, J.", [("energy", energy)], "energy",
        ),
    ]  # fmt: skip


def _gradient_kernels(
    name: str, what: str, arguments: str, value: sp.Expr, coordinates: list[sp.Symbol], held: dict[sp.Symbol, sp.Expr]
) -> list[str]:
    """Two kernels: value with gradient, and what is not always zero of the upper triangle of the Hessian."""

    def code(e: sp.Expr) -> sp.Expr:
        return e.subs(held, simultaneous=True)

    n = len(coordinates)
    gradient = [sp.diff(value, c) for c in coordinates]
    outputs = [("value", code(value))] + [(f"d{i}", code(g)) for i, g in enumerate(gradient)]
    slopes = ", ".join(f"d{i}" for i in range(n))
    pairs = [(i, j) for i in range(n) for j in range(i, n)]
    curvatures = [(f"hessian[{i}, {j}]", code(sp.diff(gradient[i], coordinates[j]))) for i, j in pairs]
    return [
        _function(
            f"{name}_gradient", arguments, f"Return {what}, and its gradient ({n},).", outputs, f"value, ({slopes})"
        ),
        _function(
            f"{name}_hessian", f"{arguments}, hessian",
            f"Upper triangle of the Hessian ({n}, {n}) of {what}, where it is not always zero.",
            [(place, curvature) for place, curvature in curvatures if curvature != 0],
        ),
    ]  # fmt: skip


def _link_and_bend() -> str:
    """One kernel for the gradients of a link and of the bend below it: the length of the link is found once."""
    stretch, by_link = link_stretch()
    energy, by_bend = bending_energy()
    l0, (a, du, dv) = sp.Symbol("l0"), by_link
    upper = dict(zip(by_bend[:3], (l0 + a, du, dv), strict=True))
    outputs = [("value", stretch)] + [(f"d{i}", sp.diff(stretch, c)) for i, c in enumerate(by_link)]
    outputs += [(f"b{i}", sp.diff(energy, c).subs(upper, simultaneous=True)) for i, c in enumerate(by_bend)]
    bent = ", ".join(f"b{i}" for i in range(len(by_bend)))
    return _function(
        "link_and_bend_gradient", "l0, a, du, dv, w4, w5, w6, w7, w8",
        "Return a link's stretch, m, its gradient (3,), and that (8,) of the energy of the bend below over EI / lb.",
        outputs, f"value, (d0, d1, d2), ({bent})",
    )  # fmt: skip


def source() -> str:
    """The whole text of ``generated.py``, without its hash line."""
    parts = ["from tautline.kernels.jit import kernel\nfrom tautline.kernels.lanes import cos, sin, sqrt\n"]
    parts += _body_kernels("body", eccentric=False)
    parts += _body_kernels("eccentric_body", eccentric=True)
    value, coordinates, held = chord()
    arguments = "x1, u1, v1, x2, u2, v2, f11, f21, k11, k21, f12, f22, k12, k22"
    what = "the chord beyond the unstretched length, m"
    parts += _gradient_kernels("chord", what, arguments, value, coordinates, held)
    parts += _gradient_kernels("link_stretch", "the stretch of a link, m", "l0, a, du, dv", *link_stretch(), {})
    arguments = ", ".join(f"w{i}" for i in range(1, 9))
    parts += _gradient_kernels("bend", "the bending energy over EI / lb", arguments, *bending_energy(), {})
    parts.append(_link_and_bend())
    return "\n\n".join(parts)


def digest() -> str:
    """Hash of the derivation: of this file's text."""
    return hashlib.sha256(Path(__file__).read_bytes()).hexdigest()[:16]


def main() -> None:
    """Write ``generated.py``."""
    head = f'"""Written by ``python -m tautline.lumped.derive``: do not edit. Derivation {digest()}."""\n\n'
    (HERE / "generated.py").write_text(head + source(), encoding="utf8")


if __name__ == "__main__":
    main()
