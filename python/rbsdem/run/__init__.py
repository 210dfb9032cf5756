"""Analyses, their results and cases: what is solved, kept and asked of it."""
