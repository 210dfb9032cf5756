"""The commands of the executable that are written in Python."""
