"""The only place that knows OpenFOAM: case, fields, processes, pipes, and its own solver."""
