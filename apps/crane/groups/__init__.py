"""Forces as groups of the solver: spans of rope, bending, friction on sheaves (capstan, efficiency, bearings),
bodies, water, winches.
"""
