"""Measured tracks of a shot: read, laid over what was simulated, and values of the scene estimated from them."""
