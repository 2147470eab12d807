"""What a person writes of a crane: rope, path, bodies, surroundings, and what of it contradicts itself; no compiled
code.

``read``, ``json_schema`` and the models stand in :mod:`crane.scene.scene`.
"""

from crane.scene.scene import CraneScene, json_schema, read

__all__ = ["CraneScene", "json_schema", "read"]
