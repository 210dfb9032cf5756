"""Figures, tables and files of the records."""
