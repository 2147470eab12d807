"""What a person writes of a well and its string: the hole, the ends, the bit, the catalogue of tubulars; no compiled
code.

``read``, ``json_schema`` and the models stand in :mod:`drillstring.scene.scene`.
"""

from drillstring.scene.scene import DrillstringScene, json_schema, read

__all__ = ["DrillstringScene", "json_schema", "read"]
