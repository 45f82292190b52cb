"""What a scene is: its data, where each key was written, what may be wrong with one, and the values it can hold."""
