"""Forces along the hole as groups of the solver: the wall with friction, mud and eccentric sections, of lumps and of
a beam.
"""
