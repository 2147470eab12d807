"""A clamped bar without gravity that swings under a load across its end, as the root of a scene."""


def swinging_bar(EA, EJ, damping, *, elements, load, **solver):
    """A bar of 2 m and 1 kg/m along x: EA [N], EJ [N m^2] and damping [s] of its line, and the load [N] along z."""
    line = {"id": 0, "nodes7": [0, 1], "elements": elements, "EA": EA, "EJ": EJ, "rhoA": 1.0, "cDamp": damping}
    return {
        "CableModelMaterial": {"Gravity": [0.0, 0.0, 0.0]},
        "CableModel": [
            {"Node7Dof": {"id": 0, "xyz": [0, 0, 0], "BC": [1, 1, 1, 0, 1, 1, 1], "xyz_d": [1, 0, 0]}},
            {"Node7Dof": {"id": 1, "xyz": [2, 0, 0], "BC": [0, 0, 0, 0, 0, 0, 1]}},
            {"CableLine": line},
            {"PointForce": {"id": 0, "nodes7": [1], "force": [0, 0, load]}},
        ],
        "GeneralizedAlpha": {"type": "G-alpha"} | solver,
    }
