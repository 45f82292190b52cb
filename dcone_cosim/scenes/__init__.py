"""Scenes: the files that come with the program, and how a scene is read, checked, begun, and described to editors."""
