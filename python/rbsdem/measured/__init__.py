"""Measured tests: files, drawings, predictions."""
