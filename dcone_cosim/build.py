"""The one door to our own models: what a scene may say of them, and their FMUs, built on demand and cached.

    ours.models    what a scene may say of our models, and what they say of it and of a run
    ours.shapes    geometry and masses of our nets and targets
    ours.fmus      their FMUs, built, and written to files
    ours.kept      where built FMUs are kept

No other module of this package knows `fmu_src`: everything else works on an FMU's file and its model description.
"""

from dcone_cosim.ours.fmus import (
    PAGE,
    Furnished,
    ensure,
    platform_names,
    printable,
    shared_with_template,
    with_tables,
    write_fmus,
)
from dcone_cosim.ours.kept import cache_folder, fault, is_ours
from dcone_cosim.ours.models import (
    LEAP_REVOLUTIONS,
    LOOKS_EVERY,
    SETTABLE,
    Refusal,
    air_of,
    all_rows,
    all_tables,
    asked_names,
    asked_variables,
    beside,
    by_tolerance,
    cannot_work,
    cautions,
    cautions_after,
    defaults,
    designed,
    details,
    extremes,
    implied,
    instead,
    is_counted,
    known_variables,
    laid,
    lays,
    lines,
    numerics,
    reference,
    refinements,
    rungs,
    scene_name,
    settable,
    term_rows,
    whole,
    within,
)
from dcone_cosim.ours.shapes import (
    Drawing,
    Surface,
    force_cells,
    hull_corners,
    line_mass,
    masses_after,
    mouth_sides,
    net_drawing,
    shot_frame,
    target_distance,
    target_hinge,
    target_surface,
    target_swing,
    towed_surface,
)
from fmu_src.catalogue import MODELS as CATALOGUE
from fmu_src.cautions import Range
from fmu_src.extremes import Extreme
from fmu_src.implied import Implied
from fmu_src.interface import Group, Interface, Model, Variable
from fmu_src.lines import Line
from fmu_src.net_capture.capacity import FAMILIES
from fmu_src.net_capture.entered import over_time as energy_entered
from fmu_src.packaging.c_header import STATE_HEAD
from fmu_src.packaging.description import Experiment
from fmu_src.tables import Table, from_files
from fmu_src.trade import Rung

__all__ = [
    "CATALOGUE",
    "FAMILIES",
    "LEAP_REVOLUTIONS",
    "LOOKS_EVERY",
    "PAGE",
    "SETTABLE",
    "STATE_HEAD",
    "Drawing",
    "Experiment",
    "Extreme",
    "Furnished",
    "Group",
    "Implied",
    "Interface",
    "Line",
    "Model",
    "Range",
    "Refusal",
    "Rung",
    "Surface",
    "Table",
    "Variable",
    "air_of",
    "all_rows",
    "all_tables",
    "asked_names",
    "asked_variables",
    "beside",
    "by_tolerance",
    "cache_folder",
    "cannot_work",
    "cautions",
    "cautions_after",
    "defaults",
    "designed",
    "details",
    "energy_entered",
    "ensure",
    "extremes",
    "fault",
    "force_cells",
    "from_files",
    "hull_corners",
    "implied",
    "instead",
    "is_counted",
    "is_ours",
    "known_variables",
    "laid",
    "lays",
    "line_mass",
    "lines",
    "masses_after",
    "mouth_sides",
    "net_drawing",
    "numerics",
    "platform_names",
    "printable",
    "reference",
    "refinements",
    "rungs",
    "scene_name",
    "settable",
    "shared_with_template",
    "shot_frame",
    "target_distance",
    "target_hinge",
    "target_surface",
    "target_swing",
    "term_rows",
    "towed_surface",
    "whole",
    "with_tables",
    "within",
    "write_fmus",
]
