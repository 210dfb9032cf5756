"""Sections of reinforced concrete: moment-curvature, springs of a column, figures.

Concrete, steel, bars and ties make a `RectangularSection` or a `CircularSection`; its
`moment_curvature`, `diagram`, `springs` and `column` do the rest. Strains and axial loads are
positive in compression, y is positive to the face that a positive curvature puts in tension.
"""
