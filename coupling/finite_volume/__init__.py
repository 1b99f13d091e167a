"""The liquid's mesh and the finite volumes on it, as OpenFOAM has them, without OpenFOAM."""
