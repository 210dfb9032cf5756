"""Time against accuracy: which method, step or tolerance a case needs, and which physics.

`trade` measures it; `Trade` holds what was found.
"""
