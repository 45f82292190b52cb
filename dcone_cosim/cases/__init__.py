"""Many cases of a scene: a case in, a row out, kept under its hash.

    case        what a case is: a checked scene and a seed, and the hash of all that settles its numbers
    vary        a grid of cases from `--vary`          ensemble    jittered starts
    work        one case run, FMUs kept loaded         workers     processes that do it, one per core
    store       rows on disk, whole or not there       runner      the loop between them: resumes, counts, survives
    table       all rows as one table                  statistics  mean, spread, shares with their intervals

Sweeps and ensembles are its first users. Whatever else runs many cases gives the runner its cases, one by one if each
depends on those before, and any executor with the `submit` of `concurrent.futures`.
"""
