"""Tests of the program; what of them is long evidence is asked for by `pytest -m evidence`."""

import os
import sys

# A run starts some hundred interpreters, which load the bytecode that the first of them has made.
sys.dont_write_bytecode = False
os.environ.pop("PYTHONDONTWRITEBYTECODE", None)
