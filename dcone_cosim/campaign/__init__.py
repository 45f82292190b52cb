"""Campaigns: a scene whose values are uncertain, run until its probabilities are known.

    reading         a campaign file into a `Spec`, every mistake told at once with its line
    distributions   what a value may be drawn from      making      the inputs of a dispersion, SI
    inputs          the numbers that are drawn          applied     held against the scene before anything is run
    sampling        points of the unit cube by case number, and how they are correlated
    shots           a case as little data; what a worker does with it
    cluster         what runs them: dask, here or elsewhere, or plain processes
    engine          the loop: nothing lost, nothing twice, in the order of case numbers
    stopping        when an interval is narrow enough    rare        subset sampling
    maps            points put where the boundary is     sensitivity what the spread comes from
    outcomes        how a case came out                  answers     probabilities, percentiles, with their intervals
    explained       the spread of figures                worst       cases worth looking at
    commands        from the file to the folder          page, plot, show

It stands on `cases`: their store, their runner, their workers.
"""
