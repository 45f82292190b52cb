"""What becomes of a scene at the ends of its range, under every scheme: it holds, or it is refused, and says why.

    plan        schemes and extremes of a phase, and the case of each pair
    cost        what a case would take, before it is run
    work        one case: its cost, its run, and those that it is compared with
    judge       stable and accurate, stable, refused or failed
    show        the table
    plot        the map
    page        all of it as one page
    commands    `dcone stability`

Extremes are declared by the parts of a model (`fmu_src.extremes`), what must hold by the kinds of phases
(`phases.phase.Phase.criteria`). An FMU from elsewhere has its macro steps, and the coupling steps where there are any.
"""
