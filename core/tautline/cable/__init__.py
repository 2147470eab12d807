"""Cables of ALE-ANCF elements, as the thesis' Appendix A writes them: reader, builder, figures."""
