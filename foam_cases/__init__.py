"""The cases shipped with the program, as data: one folder each, and the OpenFOAM template."""
