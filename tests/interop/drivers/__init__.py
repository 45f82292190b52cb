"""One program per tool: each runs an FMU by that tool's own means, in a process of its own.

A driver reads jobs from a file and writes what the tool found to another:
`python -m tests.interop.drivers.NAME jobs.json found.json`. It knows nothing of this project but the `Job`.
"""
