"""The syntax of the thesis' Appendix A: models of what stands in a file, each item checked by itself."""
