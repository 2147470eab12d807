"""Natural frequencies: lateral of the assembly, torsional and axial of the string, against rotary speed."""
