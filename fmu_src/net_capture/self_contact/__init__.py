"""Contact of the net's threads with each other: which pairs may touch, where they are nearest, and what pushes them.

Nodes alone know of masses and threads of tension; without this part, a net folded over itself goes through itself.
"""
