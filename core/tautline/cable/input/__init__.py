"""The thesis' own syntax (Appendix A): models of the file, parts of the scene, and the way from the ones to the
others.
"""
