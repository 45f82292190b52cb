"""A run as one page that opens from disk without a network: a replay to turn and scrub, charts to zoom into, figures.

told       answer, loads, figures and ledger in words and tables     packing    arrays as a page holds them
page       the page of a run, or its replay alone                     scripts    the page's scripts, three.js among them
live       the models in a page, to be simulated anew there           carried    an FMU as a page carries it
knobs      what of them may be moved
commands   `dcone report` and `dcone replay`                          gallery    `dcone gallery`: pages of many scenes
"""
