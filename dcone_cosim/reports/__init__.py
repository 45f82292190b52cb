"""What a person sees of a run: the summary table, the figures, and what a scene puts into its FMUs."""
