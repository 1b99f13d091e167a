"""Partitioned fluid-structure interaction of spherical elastomeric diaphragm tanks."""
