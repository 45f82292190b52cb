"""How figures look, and the pictures that more than one kind of phase has."""
