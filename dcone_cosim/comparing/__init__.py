"""Two runs side by side: their figures with the differences, the keys in which their scenes differ, their histories.

pairs       what is compared, as plain rows       show      the same on the terminal
comparison  what all that tell of it are given    page      the same as one page
plot        tension and mouth area of both        commands  `dcone compare` from beginning to end
"""
