"""The liquid as an incompressible, viscous flow: OpenFOAM on a mesh that follows the diaphragm."""
