"""The rope on either side of a tie: what its elements give together."""

from __future__ import annotations

from collections.abc import Callable

from tautline.cable.input.parts import CableScene


def sides_of(scene: CableScene, give: list[float]) -> Callable[[int], float]:
    """What gives from a node on, up to where the rope is held or tied, branches or ends.

    Parameters
    ----------
    scene : CableScene
    give : list of float
        What each element gives, in the order of the scene.

    Returns
    -------
    callable
        Of a node's id: the sum over the elements of the rope that begins there; the largest where several do, and zero
        where none does.
    """
    ends: dict[int, list[tuple[int, int]]] = {}
    for i, element in enumerate(scene.elements):
        for node, other in (element.nodes, element.nodes[::-1]):
            ends.setdefault(node, []).append((i, other))
    stops = {node.id for node in scene.nodes if all(node.held[:3])} | {node for tie in scene.ties for node in tie.nodes}

    def along(first: int, node: int) -> float:
        total, seen = give[first], {first}
        while node not in stops and len(ends[node]) == 2:
            further = [one for one in ends[node] if one[0] not in seen]
            if not further:
                break
            (at, node) = further[0]
            seen.add(at)
            total += give[at]
        return total

    return lambda node: max((along(*end) for end in ends.get(node, ())), default=0.0)
