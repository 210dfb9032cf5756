"""Limit states along a response, and values of codes."""
