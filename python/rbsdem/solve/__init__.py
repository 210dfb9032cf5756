"""Analyses of a structure, their settings and cases."""
