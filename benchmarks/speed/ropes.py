"""Cable scenes of any number of elements, for the benchmarks."""

from __future__ import annotations


def bar(elements: int, method: str, step: float, end: float) -> str:
    """The axial bar of the thesis' Case 1: EA 1000, rhoA 1, L 1, pulled at its end."""
    nodes = "\n".join(
        f"  - Node7Dof: {{id: {i}, xyz: [{i / elements!r}, 0, 0], xyz_d: [1, 0, 0], "
        f"BC: [{int(i == 0)}, 1, 1, 0, 1, 1, 1]}}"
        for i in range(elements + 1)
    )
    force = f"  - PointForce: {{id: 0, nodes7: [{elements}], force: [1, 0, 0], timeInterval: [0, 1e9]}}"
    return _scene(nodes, elements, 0.0, force, 1000.0, method, step, end)


def rope(elements: int, method: str, step: float, end: float, flow: str | None = None) -> str:
    """A rope that hangs from one end and swings: EA 1e5, rhoA 1, 1 m an element, released at an angle.

    With ``flow`` it is held at both ends and runs through them: ``shared`` with one free velocity, ``prescribed`` with
    a given one.
    """
    slant = 0.6, -0.8
    nodes = []
    for i in range(elements + 1):
        function = f", BC_functions: [0, 0, 0, 0, 0, 0, {i + 1}]" if flow == "prescribed" else ""
        held = int(i == 0 or (flow is not None and i == elements))
        p = int(flow != "shared")
        nodes.append(
            f"  - Node7Dof: {{id: {i}, xyz: [{slant[0] * i!r}, 0, {slant[1] * i!r}], "
            f"xyz_d: [{slant[0]}, 0, {slant[1]}], BC: [{held}, {held}, {held}, 0, 0, 0, {p}], p: {i}{function}}}"
        )
    extra = []
    if flow == "shared":
        extra = [
            f"  - LinearCoupl: {{id: {i}, sNode: {i}, sDof: 7, f0: {i}, masters: [{{mNode: 0, mDof: 7, factor: 1}}]}}"
            for i in range(1, elements + 1)
        ]
    if flow == "prescribed":
        extra = [
            f"  - Function_VelocityDefined: {{id: {i + 1}, pos0: {i}, timeList: [0, 1e9], velocityList: [1, 1]}}"
            for i in range(elements + 1)
        ]
    return _scene("\n".join(nodes), elements, -9.81, "\n".join(extra), 1.0e5, method, step, end)


def _scene(nodes: str, elements: int, gravity: float, extra: str, stiffness: float, method: str, step: float,
           end: float) -> str:  # fmt: skip
    members = "\n".join(
        f"  - CableALEelement: {{id: {i}, nodes7: [{i}, {i + 1}], EA: {stiffness!r}, EJ: 0, rhoA: 1, cDamp: 0}}"
        for i in range(elements)
    )
    return (
        f"CableModelMaterial: {{Gravity: [0, 0, {gravity}]}}\nCableModel:\n{nodes}\n{members}\n{extra}\n"
        f"GeneralizedAlpha: {{type: {method}, time_step: {step!r}, time_end: {end!r}, plotpoints: {1.0 / end!r}"
        + (", rho_inf: 0.8, eps_energy: 1.0e-6}\n" if method == "G-alpha" else "}\n")
    )
