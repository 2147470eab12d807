"""What a person writes: YAML read into validated, frozen models; no compiled code.

`model.Scene` is the base of a scene, `functions` are functions of time, `solver` is how it is solved, `methods` are the
integrators by name. Files are read in `reading`, numbers in `values`. Errors, warnings and preparation start here too.
"""
