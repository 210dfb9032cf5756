"""Time against accuracy: which method, step or tolerance a case needs, and which physics.

`compare_methods` measures it; `MethodStudy` holds what was found.
"""
