"""FMUs as the master sees them: a file, its instances by variable name in SI units, in this process or another."""
