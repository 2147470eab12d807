"""A planar lumped drill string in the J-well under the heave chirp: event-accurate Coulomb friction.

Coordinates per body i = 1..n: measured depth s_i and lateral offset u_i along m1 (towards the centre of the arc, so
u > 0 is the high side).  Body 0: s_0(t) prescribed, u_0 = 0.  SI units.  Equations: docs/lumped_string.md.

    m beta^2 s'' = -dU/ds + W g3 beta + 2 m beta k u' s' - c s' + beta_c lambda              beta = 1 - k u
    (m + m_a) u'' = -dU/du + W g1 - m k beta s'^2 - c u' - rho_m C_d (d l)/2 |u'| u' - sgn(u) N
    U = sum EA/(2 l0) (l - l0)^2 + sum EI/(2 lb) |kv|^2,   l^2 = a^2 + b^2,  b = u_{i+1} - u_i,
    a = s_{i+1} - s_i - (Phi(s_{i+1}) - Phi(s_i)) (u_i + u_{i+1})/2
    kv = d_i - d_{i-1} + (0, (Phi(s_{i+1}) - Phi(s_{i-1}))/2),   d = (a, b)/l,   Phi' = k
    N = max(0, k_c (|u| - delta) + d_c sgn(u) u'),   |lambda| <= mu N,   lambda opposes beta_c s',
    beta_c = 1 - k (u + sgn(u) d/2)

W is the buoyed weight per g, g1 = -g sin(inc), g3 = g cos(inc).  `simulate` integrates with RK4 inside each mode
(contact open/closed, stick, slip +/-), finds every change of mode by bisection to 1e-12 s and goes on from there, so
nothing of the friction is regularised.  `simulate_moreau` is a second, different method: first-order semi-implicit
stepping with return mapping of the friction impulse.  Run as a script it writes jwell_bit_history.csv.
"""

from pathlib import Path

import numpy as np
from numba import njit

CSV = Path(__file__).with_name("jwell_bit_history.csv")
TWO_FACTORS = Path(__file__).with_name("jwell_two_factors.csv")
"""Bit displacement with a static factor above the kinetic 0.2."""
STATIC_FACTORS = (0.25, 0.3)
KICK_OFF, RADIUS = 2200.0, 1000.0
WELL_LENGTH = KICK_OFF + RADIUS * np.pi / 2
GRAVITY = 9.81
# columns of the per-body table; MR is an optional rotary inertia about the normal of the plane, 0 here
M, ML, W, KC, DC, DELTA, C, DRAG, D, MU, MR, STATIC = range(12)
L0, EA, EI, LB = range(4)


def jwell(n=12, mu=0.2, rotary=False, static=None):
    """The thesis' J-well: (body table [n+1, 12], link table [n, 4]); EI, LB of row i belong to the node at its top.

    What has come to rest is held up to the factor ``static``, that of what slips where none is given.
    """
    pipe, bha = (0.127, 0.1086), (0.165, 0.0572)
    length = np.append(np.full(n - 1, (WELL_LENGTH - 240.0) / (n - 1)), 240.0)
    od = np.append(np.full(n - 1, pipe[0]), bha[0])
    bore = np.append(np.full(n - 1, pipe[1]), bha[1])
    area = np.pi / 4 * (od**2 - bore**2)
    stiffness = 200e9 * np.pi / 64 * (od**4 - bore**4)
    steel, mud = 7850.0, 1840.0

    def lump(per_length):
        half = 0.5 * per_length * length
        return np.append(half, 0.0) + np.append(0.0, half)

    body = np.zeros((n + 1, 12))
    tributary = lump(np.ones(n))
    d = np.maximum(np.append(od, 0.0), np.append(0.0, od))
    scale = tributary / (length.sum() / 12)
    body[:, M] = lump(steel * area)
    body[:, ML] = body[:, M] + lump(mud * np.pi / 4 * (od**2 + bore**2))
    body[:, W] = body[:, M] * (1 - mud / steel)
    body[:, KC], body[:, DC] = 1e9 * d / 0.165 * scale, 5e6 * d / 0.165 * scale
    body[:, DELTA], body[:, D] = (0.2032 - d) / 2, d
    body[:, C], body[:, DRAG], body[:, MU] = 10.0 * scale, 0.5 * mud * lump(od), mu
    body[:, STATIC] = mu if static is None else static
    body[:, MR] = body[:, M] * tributary**2 / 12 if rotary else 0.0
    link = np.zeros((n, 4))
    link[:, L0], link[:, EA] = length, 200e9 * area
    up, down = slice(0, n - 1), slice(1, n)
    link[1:, LB] = (length[up] + length[down]) / 2
    link[1:, EI] = (length[up] + length[down]) / (length[up] / stiffness[up] + length[down] / stiffness[down])
    return body, link


@njit(cache=True)
def heave(t):
    """Block position and velocity, eq. 2.171 less its value at t = 0."""
    p = 2 * np.pi * (t - 5) / 20 + (t - 5) ** 2 / 400
    p0 = -np.pi / 2 + 25 / 400
    return np.sin(p) - np.sin(p0), np.cos(p) * (np.pi / 10 + (t - 5) / 200)


@njit(cache=True)
def elastic_forces(s, u, link):
    """-dU/ds, -dU/du of every body (0..n) and the tension of the top link."""
    n = len(link)
    k, phi, fs, fu = np.zeros(n + 1), np.zeros(n + 1), np.zeros(n + 1), np.zeros(n + 1)
    a, b, r = np.zeros(n), np.zeros(n), np.zeros(n)
    ga, gb = np.zeros(n), np.zeros(n)  # dU/da, dU/db
    for i in range(n + 1):
        k[i] = 1 / RADIUS if s[i] > KICK_OFF else 0.0
        phi[i] = k[i] * (s[i] - KICK_OFF)
    for i in range(n):
        a[i] = s[i + 1] - s[i] - 0.5 * (phi[i + 1] - phi[i]) * (u[i] + u[i + 1])
        b[i] = u[i + 1] - u[i]
        r[i] = np.hypot(a[i], b[i])
        tension = link[i, EA] / link[i, L0] * (r[i] - link[i, L0])
        ga[i] += tension * a[i] / r[i]
        gb[i] += tension * b[i] / r[i]
    top = link[0, EA] / link[0, L0] * (r[0] - link[0, L0])
    for i in range(1, n):  # bending at node i, between links i-1 and i
        f = link[i, EI] / link[i, LB]
        m0 = f * (a[i] / r[i] - a[i - 1] / r[i - 1])
        m1 = f * (b[i] / r[i] - b[i - 1] / r[i - 1] + 0.5 * (phi[i + 1] - phi[i - 1]))
        for j, sign in ((i, 1.0), (i - 1, -1.0)):
            x = sign * (m0 * b[j] - m1 * a[j]) / r[j] ** 3
            ga[j] += x * b[j]
            gb[j] -= x * a[j]
        fs[i + 1] -= 0.5 * m1 * k[i + 1]
        fs[i - 1] += 0.5 * m1 * k[i - 1]
    for i in range(n):
        mean, turn = 0.5 * (u[i] + u[i + 1]), 0.5 * (phi[i + 1] - phi[i])
        fs[i + 1] -= ga[i] * (1 - k[i + 1] * mean)
        fs[i] += ga[i] * (1 - k[i] * mean)
        fu[i + 1] -= gb[i] - ga[i] * turn
        fu[i] += gb[i] + ga[i] * turn
    return fs, fu, top


@njit(cache=True)
def applied(t, y, body, link):
    """Per body: (force on s without friction, force on u without contact, unclipped contact force, beta_c, mass)."""
    n = len(link)
    s, u = np.zeros(n + 1), np.zeros(n + 1)
    s[0] = heave(t)[0]
    for i in range(n):
        s[i + 1], u[i + 1] = y[0, i], y[1, i]
    fs, fu, top = elastic_forces(s, u, link)
    out = np.zeros((5, n))
    for i in range(1, n + 1):
        p = body[i]
        k = 1 / RADIUS if s[i] > KICK_OFF else 0.0
        inc = k * (s[i] - KICK_OFF)
        beta, vs, vu = 1 - k * u[i], y[2, i - 1], y[3, i - 1]
        side = 1.0 if u[i] >= 0 else -1.0
        weight = p[W] * GRAVITY
        out[0, i - 1] = fs[i] + weight * np.cos(inc) * beta + 2 * p[M] * beta * k * vu * vs - p[C] * vs
        out[1, i - 1] = fu[i] - weight * np.sin(inc) - p[M] * k * beta * vs**2 - p[C] * vu - p[DRAG] * abs(vu) * vu
        out[2, i - 1] = p[KC] * (abs(u[i]) - p[DELTA]) + p[DC] * side * vu
        out[3, i - 1] = 1 - k * (u[i] + side * p[D] / 2)
        out[4, i - 1] = p[M] * beta**2 + p[MR] * k**2
    return out, top


@njit(cache=True)
def rate(t, y, touch, slip, body, link):
    """State derivative in fixed modes, and the worst mode violation of each body (negative = the mode must change)."""
    n = len(link)
    f, _ = applied(t, y, body, link)
    dy, margin = np.zeros((4, n)), np.ones(n)
    for i in range(n):
        dy[0, i], dy[1, i] = y[2, i], y[3, i]
        normal = f[2, i] if touch[i] else 0.0
        limit = body[i + 1, MU] * normal
        force = f[0, i]
        if touch[i] and slip[i] == 0:
            dy[0, i] = 0.0
            margin[i] = min(normal, body[i + 1, STATIC] * normal - abs(force / f[3, i]))
            force = 0.0
        elif touch[i]:
            margin[i] = min(normal, slip[i] * y[2, i])
            force -= slip[i] * f[3, i] * limit
        else:
            margin[i] = -f[2, i]
        dy[2, i] = force / f[4, i]
        dy[3, i] = (f[1, i] - (1.0 if y[1, i] >= 0 else -1.0) * normal) / body[i + 1, ML]
    return dy, margin


@njit(cache=True)
def add(y, h, rate):
    """y + h rate, in a loop (numba compiles it ten times faster than the array expression)."""
    out = np.empty_like(y)
    for i in range(y.shape[0]):
        for j in range(y.shape[1]):
            out[i, j] = y[i, j] + h * rate[i, j]
    return out


@njit(cache=True)
def record(t, y, body, link, row):
    """Fill a row (t, top tension, s.., u.., s'..)."""
    row[0], row[1] = t, applied(t, y, body, link)[1]
    for i in range(3):
        for j in range(y.shape[1]):
            row[2 + i * y.shape[1] + j] = y[i, j]


@njit(cache=True)
def rk4(t, h, y, touch, slip, body, link):
    """One step of the classical Runge-Kutta method in fixed modes."""
    k1, _ = rate(t, y, touch, slip, body, link)
    k2, _ = rate(t + h / 2, add(y, h / 2, k1), touch, slip, body, link)
    k3, _ = rate(t + h / 2, add(y, h / 2, k2), touch, slip, body, link)
    k4, _ = rate(t + h, add(y, h, k3), touch, slip, body, link)
    return add(add(add(add(y, h / 6, k1), h / 3, k2), h / 3, k3), h / 6, k4)


@njit(cache=True)
def choose_modes(t, y, only, touch, slip, body, link):
    """New modes of the bodies flagged in `only`, from the present state; sets s' = 0 of a body that stops."""
    f, _ = applied(t, y, body, link)
    for i in range(len(link)):
        if not only[i]:
            continue
        was_touching, was = touch[i], slip[i]
        touch[i] = f[2, i] > 0
        push = f[0, i] / f[3, i]
        if not touch[i]:
            slip[i] = 1
        elif was_touching and was != 0 and was * y[2, i] > 0:
            slip[i] = was
        elif was_touching or y[2, i] == 0:  # stopped, or stuck until now
            y[2, i] = 0.0
            slip[i] = 0 if abs(push) <= body[i + 1, STATIC] * f[2, i] else (1 if push > 0 else -1)
        else:
            slip[i] = 1 if y[2, i] > 0 else -1


@njit(cache=True)
def simulate(y, end, h, every, body, link):
    """Event-accurate run: records of (t, top link tension, s.., u.., s'..) every `every` steps of h; event count."""
    n = len(link)
    touch, slip = np.zeros(n, np.bool_), np.ones(n, np.int64)
    y = y.copy()
    choose_modes(0.0, y, np.ones(n, np.bool_), touch, slip, body, link)
    steps = round(end / h)
    out = np.zeros((steps // every + 1, 2 + 3 * n))
    events = 0
    for j in range(steps + 1):
        if j % every == 0:
            record(j * h, y, body, link, out[j // every])
        if j == steps:
            break
        t, left = j * h, h
        while left > 1e-13:
            new = rk4(t, left, y, touch, slip, body, link)
            if rate(t + left, new, touch, slip, body, link)[1].min() >= 0:
                y = new
                break
            low, high = 0.0, left
            while high - low > 1e-12:
                mid = 0.5 * (low + high)
                new = rk4(t, mid, y, touch, slip, body, link)
                if rate(t + mid, new, touch, slip, body, link)[1].min() < 0:
                    high = mid
                else:
                    low = mid
            y = rk4(t, high, y, touch, slip, body, link)
            t, left = t + high, left - high
            changed = rate(t, y, touch, slip, body, link)[1] < 0
            choose_modes(t, y, changed, touch, slip, body, link)
            events += 1
    return out, events


@njit(cache=True)
def simulate_moreau(y, end, h, every, body, link):
    """Semi-implicit stepping, friction impulse by return mapping with the new normal force; same records."""
    n = len(link)
    y = y.copy()
    steps = round(end / h)
    out = np.zeros((steps // every + 1, 2 + 3 * n))
    for j in range(steps + 1):
        if j % every == 0:
            record(j * h, y, body, link, out[j // every])
        for i in range(n):
            y[0, i] += h / 2 * y[2, i]
            y[1, i] += h / 2 * y[3, i]
        f, _ = applied((j + 0.5) * h, y, body, link)
        for i in range(n):
            p = body[i + 1]
            side = 1.0 if y[1, i] >= 0 else -1.0
            # implicit in d_c: N = e + d_c side v_new, m (v_new - v) = h (f - side N)
            e = f[2, i] - p[DC] * side * y[3, i]
            v = (y[3, i] + h / p[ML] * (f[1, i] - side * e)) / (1 + h * p[DC] / p[ML])
            normal = e + p[DC] * side * v
            if normal <= 0:
                normal, v = 0.0, y[3, i] + h / p[ML] * f[1, i]
            y[3, i] = v
            stop = -(y[2, i] * f[4, i] + h * f[0, i]) / (h * f[3, i])  # the force that would stop it
            force = min(max(stop, -p[MU] * normal), p[MU] * normal)
            y[2, i] += h * (f[0, i] + f[3, i] * force) / f[4, i]
        for i in range(n):
            y[0, i] += h / 2 * y[2, i]
            y[1, i] += h / 2 * y[3, i]
    return out


def static_start(body, link):
    """Frictionless equilibrium at t = 0: y[0] = s, y[1] = u of bodies 1..n, zero velocities; damped Newton."""
    n = len(link)
    y = np.zeros((4, n))
    y[0] = np.cumsum(link[:, L0]) + 0.1

    def residual(x):
        z = np.zeros((4, n))
        z[:2] = x.reshape(2, n)
        f, _ = applied(0.0, z, body, link)
        side = np.where(z[1] >= 0, 1.0, -1.0)
        return np.concatenate([f[0], f[1] - side * np.maximum(f[2], 0)])

    x, shift, r = y[:2].ravel(), 1e6, None
    for _ in range(2000):
        r = residual(x)
        jac = np.empty((2 * n, 2 * n))
        for j in range(2 * n):
            e = np.zeros(2 * n)
            e[j] = 1e-6
            jac[:, j] = (residual(x + e) - residual(x - e)) / 2e-6
        dx = np.linalg.solve(shift * np.eye(2 * n) - jac, r)
        dx *= min(1.0, 0.01 / np.abs(dx[n:]).max())
        x = x + dx
        shift = shift * 0.7 if shift > 1e-3 else 0.0
        if np.abs(dx).max() < 1e-12:
            break
    y[:2] = x.reshape(2, n)
    return y, np.abs(residual(x)).max()


def initial_state(body, link):
    """The static start with every body moving along s with the block's velocity."""
    y, _ = static_start(body, link)
    y[2] = heave(0.0)[1]
    return y


def run(h=1e-4, end=40.0, n=12, mu=0.2, interval=0.05, rotary=False, method="events", static=None):
    """Records every `interval`: columns t, top link tension, s_1..s_n, u_1..u_n, s'_1..s'_n."""
    body, link = jwell(n, mu, rotary, static)
    y = initial_state(body, link)
    every = round(interval / h)
    if method == "events":
        return simulate(y, end, h, every, body, link)[0]
    return simulate_moreau(y, end, h, every, body, link)


def history(path=CSV):
    """The stored table as {column: array}."""
    lines = [line for line in Path(path).read_text().splitlines() if not line.startswith("#")]
    return dict(zip(lines[0].split(","), np.loadtxt(lines[1:], delimiter=",", unpack=True), strict=True))


def write_two_factors(path=TWO_FACTORS, h=1e-4):
    """Regenerate jwell_two_factors.csv with its own error estimate (about half a minute)."""
    bit = 13
    lines = [
        "Bit displacement, m, of the J-well string under the heave chirp with a static factor of friction above the",
        f"kinetic 0.2. Made by write_two_factors() of {Path(__file__).name}, as jwell_bit_history.csv, at {h:g} s.",
    ]
    columns = []
    for static in STATIC_FACTORS:
        fine, coarse = run(h, static=static), run(2 * h, static=static)
        change = np.abs(fine[:, bit] - coarse[:, bit]).max()
        lines.append(f"Static {static:g}: change from a step of {2 * h:g} s {change:.1e} m.")
        columns.append(fine[:, bit] - fine[0, bit])
    with Path(path).open("w") as f:
        f.writelines(f"# {line}\n" for line in lines)
        f.write("time," + ",".join(f"static_{static:g}" for static in STATIC_FACTORS) + "\n")
        f.writelines(
            f"{t:.2f}," + ",".join(f"{x:.8f}" for x in row) + "\n" for t, *row in zip(fine[:, 0], *columns, strict=True)
        )


def main(path=CSV, h=1e-4):
    """Regenerate jwell_bit_history.csv with its own error estimate (about 20 s)."""
    fine, coarse, other = run(h), run(2 * h), run(h / 4, method="moreau")
    rotary = run(h, rotary=True)
    bit, n = 13, 12
    step_error, method_error = (np.abs(x[:, bit] - fine[:, bit]).max() for x in (coarse, other))
    body, link = jwell()
    y, residual = static_start(body, link)
    lines = [
        "Bit of the J-well string (thesis 2.9.6, n = 12, planar, no rotation) under the heave chirp,",
        "mu_s = mu_k = 0.2, exact Coulomb friction. Independent of Tautline's code.",
        f"Made by main() of tests/references/planar_well_dynamics.py: RK4 at {h:g} s, every stick, slip and",
        "contact change found to 1e-12 s.",
        f"Estimated error of bit_displacement: {max(step_error, 1e-9):.1e} m.",
        f"Change from a step of {2 * h:g} s: {step_error:.1e} m. First-order Moreau stepping, another method,",
        f"at {h / 4:g} s differs by at most {method_error:.1e} m.",
        "Model: no axial damping of links, mud inside, added mass lateral only, buoyed weight, drag and damping on.",
        "bit_displacement has no rotary inertia k^2 m l^2/12 in the axial mass (docs/lumped_string.md);",
        f"bit_displacement_rotary has it, l the tributary length: it differs by up to "
        f"{np.abs(rotary[:, bit] - fine[:, bit]).max():.1e} m.",
        f"Static frictionless start at t = 0 (largest residual {residual:.1e} N); then every s' = "
        f"{start_velocity():.12f} m/s, u' = 0:",
        *(f"  body {i + 1}: s = {y[0, i]:.9f} m, u = {y[1, i]:+.9f} m" for i in range(n)),
        "Columns, SI: time, s of the bit less its start, the same with rotary inertia, effective tension of the",
        "top link, u of the bit (+ = high side)",
    ]
    shift = [x[:, bit] - x[0, bit] for x in (fine, rotary)]
    table = np.column_stack([fine[:, 0], *shift, fine[:, 1], fine[:, 1 + 2 * n]])
    with Path(path).open("w") as f:
        f.writelines(f"# {line}\n" for line in lines)
        f.write("time,bit_displacement,bit_displacement_rotary,top_tension,bit_u\n")
        f.writelines(f"{t:.2f},{d:.10f},{r:.10f},{a:.3f},{x:.10f}\n" for t, d, r, a, x in table)


def start_velocity():
    """Velocity of the whole string at the start [m/s]."""
    return heave(0.0)[1]


if __name__ == "__main__":
    main()
    write_two_factors()
