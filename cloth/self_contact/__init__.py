"""Contact of a sheet with itself: from overlapping boxes to a step's end without crossings.

``broad_phase`` finds triangles that may meet, ``features`` and ``pairs`` their nodes and edges,
``proximity`` when those meet; ``resolve`` moves them apart, with ``zones`` where that fails, and
``result`` says what touches. ``planes`` carries that into a step's iteration; ``crossing`` looks
for triangles that pierce each other; ``reference`` defines the compiled kernels in NumPy.
"""
