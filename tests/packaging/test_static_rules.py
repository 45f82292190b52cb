"""The model descriptions by the static rules of FMI 2.0 that its schema cannot say, as VDMCheck2 goes through them.

Each rule is a function from the description to its complaints; each has a twin, a description that must be refused.
"""

import re
import xml.etree.ElementTree as ET
from collections import Counter

import pytest

from fmu_src.packaging import description
from tests.packaging.test_description import INTERFACES

COMBINATIONS = {
    ("parameter", "fixed"): ("exact",),
    ("parameter", "tunable"): ("exact",),
    ("calculatedParameter", "fixed"): ("calculated", "approx"),
    ("calculatedParameter", "tunable"): ("calculated", "approx"),
    ("input", "discrete"): (None,),
    ("input", "continuous"): (None,),
    ("output", "constant"): ("exact",),
    ("output", "discrete"): ("calculated", "exact", "approx"),
    ("output", "continuous"): ("calculated", "exact", "approx"),
    ("local", "discrete"): ("calculated", "exact", "approx"),
    ("local", "continuous"): ("calculated", "exact", "approx"),
    ("independent", "continuous"): (None,),
}
"""Permitted values of `initial` for causality and variability; section 2.2.7, tables of combinations."""
DEFAULT_INITIAL = {"parameter": "exact", "calculatedParameter": "calculated", "output": "calculated"}
NAME = r"[A-Za-z_][A-Za-z0-9_]*(\[[0-9]+(,[0-9]+)*\])?"
STRUCTURED = re.compile(rf"{NAME}(\.{NAME})*")
"""Structured names without quotes or der(); section 2.2.9."""


def variables(root):
    """Every variable with its type's element."""
    return [(v, v[0]) for v in root.find("ModelVariables")]


def initial(v):
    return v.get("initial", DEFAULT_INITIAL.get(v.get("causality")))


def head(root):
    """Version, names and GUID; section 2.2.1. Co-simulation alone has no event indicators."""
    identifier = root.find("CoSimulation").get("modelIdentifier")
    return [
        what
        for what, wrong in (
            ("fmiVersion", root.get("fmiVersion") != "2.0"),
            ("guid", not root.get("guid")),
            ("modelName", not root.get("modelName")),
            ("modelIdentifier", not re.fullmatch(r"[A-Za-z_]\w{0,62}", identifier)),
            ("numberOfEventIndicators", root.get("numberOfEventIndicators", "0") != "0"),
            ("variableNamingConvention", root.get("variableNamingConvention") != "structured"),
        )
        if wrong
    ]


def names(root):
    """Unique, and of the structured form that is promised."""
    found = [v.get("name") for v, _ in variables(root)]
    return [n for n, k in Counter(found).items() if k > 1 or not STRUCTURED.fullmatch(n)]


def references(root):
    """A value reference stands for one variable of each type: here are no aliases."""
    return [r for r, k in Counter((t.tag, v.get("valueReference")) for v, t in variables(root)).items() if k > 1]


def combinations(root):
    """Causality, variability and initial that go together; continuous is for Reals alone."""
    wrong = []
    for v, t in variables(root):
        allowed = COMBINATIONS.get((v.get("causality"), v.get("variability")), ())
        at_start = None if v.get("causality") in ("input", "independent") else initial(v)
        if at_start not in allowed or (v.get("causality") == "input" and "initial" in v.attrib):
            wrong.append(v.get("name"))
        if v.get("variability") == "continuous" and t.tag != "Real":
            wrong.append(v.get("name"))
    return wrong


def starts(root):
    """A start value where one is needed, and nowhere else; section 2.2.7."""
    return [
        v.get("name")
        for v, t in variables(root)
        if (v.get("causality") == "input" or initial(v) in ("exact", "approx")) != ("start" in t.attrib)
    ]


def bounds(root):
    """min <= start <= max and a nominal value above zero; section 2.2.3."""
    wrong = []
    for v, t in variables(root):
        if t.tag not in ("Real", "Integer"):
            continue
        low, high = float(t.get("min", "-inf")), float(t.get("max", "inf"))
        if not low <= float(t.get("start", min(max(0.0, low), high))) <= high or not float(t.get("nominal", 1)) > 0.0:
            wrong.append(v.get("name"))
    return wrong


def unit_names(root):
    """Units are defined once, with the display units that are used; section 2.2.2."""
    defined = {u.get("name"): {d.get("name") for d in u.iterfind("DisplayUnit")} for u in root.iter("Unit")}
    counts = Counter(u.get("name") for u in root.iter("Unit"))
    wrong = [name for name, count in counts.items() if count > 1]
    for v, t in variables(root):
        unit, shown = t.get("unit"), t.get("displayUnit")
        if (unit and unit not in defined) or (shown and shown not in defined.get(unit, ())):
            wrong.append(v.get("name"))
    return wrong


def experiment(root):
    """It ends after it begins, in steps; section 2.2.5."""
    said = {k: float(x) for k, x in root.find("DefaultExperiment").attrib.items()}
    good = said.get("startTime", 0.0) < said["stopTime"] and said["stepSize"] > 0.0 and said.get("tolerance", 1.0) > 0.0
    return [] if good else ["DefaultExperiment"]


def categories(root):
    found = [c.get("name") for c in root.iter("Category")]
    return [n for n, k in Counter(found).items() if k > 1 or not n]


def _unknowns(root, part, expected, knowns, kinds):
    """Complaints of one list: which it holds, in order and once, and on what they depend; section 2.2.8."""
    found = root.findall(f"ModelStructure/{part}/Unknown")
    indices = [int(u.get("index")) for u in found]
    wrong = [] if indices == expected else [part]
    for u in found:
        on = [int(k) for k in u.get("dependencies", "").split()]
        kind = u.get("dependenciesKind", "").split()
        if len(kind) != len(on) or set(kind) - kinds or len(set(on)) < len(on) or set(on) - knowns:
            wrong.append(f"{part} {u.get('index')}")
    return wrong


def outputs(root):
    """All outputs, by what is known while stepping: the inputs."""
    rows = list(enumerate((v for v, _ in variables(root)), 1))
    wanted = [k for k, v in rows if v.get("causality") == "output"]
    inputs = {k for k, v in rows if v.get("causality") == "input"}
    return _unknowns(root, "Outputs", wanted, inputs, {"dependent", "constant", "fixed", "tunable", "discrete"})


def initial_unknowns(root):
    """All that is worked out at the start, by what is known then: inputs, and what has an exact start value."""
    rows = list(enumerate((v for v, _ in variables(root)), 1))
    worked_out = [k for k, v in rows if v.get("causality") != "input" and initial(v) in ("calculated", "approx")]
    known = {k for k, v in rows if v.get("causality") == "input" or initial(v) == "exact"}
    return _unknowns(root, "InitialUnknowns", worked_out, known, {"dependent", "constant"})


def of_model_exchange(root):
    """Nothing that is for model exchange, for states, or for event times."""
    wrong = [e.tag for e in root.iter() if e.tag in ("ModelExchange", "Derivatives", "DiscreteStates")]
    return wrong + [v.get("name") for v, t in variables(root) if {"derivative", "reinit"} & set(t.attrib)]


RULES = (
    *(head, names, references, combinations, starts, bounds, unit_names, experiment, categories),
    *(outputs, initial_unknowns, of_model_exchange),
)


def described(name):
    return ET.fromstring(description.model_description(INTERFACES[name], "model", "{guid}", "1.0"))


@pytest.mark.parametrize("rule", RULES)
@pytest.mark.parametrize("name", INTERFACES)
def test_no_description_breaks_a_rule(name, rule):
    assert rule(described(name)) == []


def put(path, key, value):
    """What sets an attribute of the first element at a path, or takes it away."""

    def change(root):
        element = root if path == "." else root.find(path)
        element.attrib.pop(key, None) if value is None else element.set(key, value)

    return change


VARIABLE = "ModelVariables/ScalarVariable"
PARAMETER, INPUT, OUTPUT = (f"{VARIABLE}[@causality='{c}']" for c in ("parameter", "input", "output"))
TWINS = (
    (head, put(".", "fmiVersion", "2.0.4")),
    (head, put(".", "guid", "")),
    (head, put("CoSimulation", "modelIdentifier", "reel-control")),
    (names, put(PARAMETER, "name", "length")),
    (names, put(PARAMETER, "name", "reel length")),
    (references, put(PARAMETER, "valueReference", str(INTERFACES["reel control"].references["length"]))),
    (combinations, put(PARAMETER, "variability", "continuous")),
    (combinations, put(OUTPUT, "variability", "fixed")),
    (combinations, put(INPUT, "initial", "exact")),
    (starts, put(f"{PARAMETER}/Real", "start", None)),
    (starts, put(f"{OUTPUT}/Real", "start", "0.0")),
    (bounds, put(f"{PARAMETER}/Real", "min", "1e9")),
    (bounds, put(f"{INPUT}/Real", "nominal", "0.0")),
    (unit_names, put("UnitDefinitions/Unit", "name", "furlong")),
    (unit_names, put(f"{INPUT}/Real", "displayUnit", "mm")),
    (experiment, put("DefaultExperiment", "stopTime", "0.0")),
    (categories, put("LogCategories/Category", "name", "logAll")),
    (outputs, put("ModelStructure/Outputs/Unknown", "index", "1")),
    (outputs, put("ModelStructure/Outputs/Unknown", "dependencies", "1 3")),
    (outputs, put("ModelStructure/Outputs/Unknown", "dependenciesKind", "dependent")),
    (initial_unknowns, put("ModelStructure/InitialUnknowns/Unknown", "index", "2")),
    (initial_unknowns, put("ModelStructure/InitialUnknowns/Unknown", "dependencies", "1 2 3 4 5 7")),
    (initial_unknowns, put("ModelStructure/InitialUnknowns/Unknown", "dependenciesKind", "fixed")),
    (of_model_exchange, put(f"{OUTPUT}/Real", "derivative", "1")),
)


@pytest.mark.parametrize(("rule", "change"), TWINS)
def test_each_rule_would_be_seen_broken(rule, change):
    root = described("reel control")
    change(root)
    assert rule(root)
