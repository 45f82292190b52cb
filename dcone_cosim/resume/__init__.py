"""Going on from an earlier run: from a state of a phase that it kept, or from a hand-over.

instants      what `--save-at` and `--from` say
differences   what is other in the scene that goes on
begin         what a run goes on from, checked
"""
