"""The sizing: what the simulation is for."""
