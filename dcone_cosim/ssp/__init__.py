"""System Structure and Parameterization (SSP) 1.0: a phase as a package for other tools, and theirs run here.

An .ssp is a zip archive: `SystemStructure.ssd` says which FMUs there are, how they are connected and with which values
they start; the FMUs lie in `resources/`. The subset written and read is what OMSimulator, libcosim and ecos have in
common:

- one flat system of FMI 2.0 co-simulation FMUs, no nested systems, no connectors of the system itself
- connectors Real, Integer and Boolean of the kinds input, output and parameter
- connections from an output to an input, with a linear transformation at most
- values inline or in an .ssv file, with a prefix and a mapping of names
- start and stop time, and a step size in the annotation of libcosim (osp) or OMSimulator (oms)

What is outside of it is refused by element and line. Prefixes matter: libcosim and ecos look for `ssd:`, `ssc:`, `ssv:`
and `osp:` literally, and libcosim takes an attribute of a list, a namespace among them, for an item of it. So all
namespaces stand at the root.

    markup.py     names of the format             writing.py    the XML of a phase
    export.py     packages of a scene             package.py    the archive, read safely
    parsing.py    XML by the schema               values.py     parameter sets and mappings
    matching.py   XML against the FMUs            planning.py   times, steps and options of the phase
    system.py     from a package to a scene
"""
