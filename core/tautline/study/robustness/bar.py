"""An element as the rule of effective length sees it: a bar along which sound runs (eqs 2.141 to 2.151)."""

from __future__ import annotations

from typing import NamedTuple

EFFECTIVE = {
    ("cubic", True): 0.191441,
    ("cubic", False): 0.308607,
    ("bent", True): 0.134222,
    ("bent", False): 0.195180,
    ("linear", True): 0.57735,
    ("linear", False): 0.57735,
    ("lumped", True): 1.0,
    ("lumped", False): 1.0,
}
"""L_eff / L_e by shape and whether an end is free: 2 over the largest root of k x = omega^2 m x of one element with
L_e = EA = rhoA = 1, pinned and free (Table 2.1, v_p/f,1), or pinned at both ends (v_p/p,1), which is what goes on in a
mesh. Cubic elements that bend take three Lobatto points for their axial force, which makes its fastest motion faster
than exact integration does. The linear element has its consistent mass; masses and springs are the rule itself."""


class Bar(NamedTuple):
    """One element, or one of many alike.

    Attributes
    ----------
    name : str
        What and where, for people.
    length : float
        L_e, m.
    speed : float
        Of sound along it, sqrt(EA / rhoA), m/s.
    shape : str
        ``cubic``, ``bent`` (cubic with bending stiffness), ``linear`` (consistent mass) or ``lumped`` (masses and
        springs).
    free_end : bool
        Whether one of its ends is an end of the mesh that may move along it.
    """

    name: str
    length: float
    speed: float
    shape: str
    free_end: bool

    @property
    def effective_length(self) -> float:
        """L_eff, m, the length of the bar of two masses that is as fast."""
        return EFFECTIVE[self.shape, self.free_end] * self.length

    @property
    def fastest(self) -> float:
        """Largest angular frequency, rad/s, eq. 2.142 with L_eff."""
        return 2.0 * self.speed / self.effective_length
