"""The only place that knows OpenFOAM: case, mesh, fields and process."""
