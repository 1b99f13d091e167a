"""Mechanical models in the formats of others: NASTRAN, FMI and Basilisk."""
