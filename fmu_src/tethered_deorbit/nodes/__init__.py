"""A line with mass of its own: nodes between elastic pieces."""
