"""Stored results of experiments too long for the suite, each beside the command that makes it again."""
