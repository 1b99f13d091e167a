"""A small tank that sways gently: a run of it takes a fraction of a second."""

from __future__ import annotations

# Ends within [motion]; a test adds its own cloth and times.
SMALL = """\
title = "Small and slow"
[tank]
radius = 0.2
[diaphragm]
material = "AF-E-332"
thickness = 0.0018
[liquid]
name = "water"
fill_fraction = 0.8
[motion]
kind = "sine"
frequency = 2.0
amplitude = 0.002
"""
