"""The liquid's mesh, how it moves, and finite volumes on it, as OpenFOAM's, without OpenFOAM."""
