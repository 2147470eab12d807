"""Numbers as they are written: units, which can be computed with, which are plausible, and how people read them.

A key takes its type from `quantity`; what is printed in a system of units comes from `systems` and `printed`.
"""
