"""The thesis' own diaphragm, beside ours, to be measured against. Not a model to rely on.

The square grid and the explicit algorithm of chapter 4 and appendices A to G. Every erratum, and
every reading of a damaged listing, is named where it bites, as kept (on purpose, to be shown) or
as repaired.
"""
