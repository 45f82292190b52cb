"""Several FMUs stepped together: how they are wired, how values pass between them, how long their steps are."""
