"""Capture of a debris by a net shot from a chaser: lumped masses on tension-only threads, contact, and a closing mouth.

The equations are in the README beside this file. Terms never import one another; `model.py` composes them.
"""
