"""Extremes, their criteria, and the command that tries them."""
