"""modelDescription.xml against the table and the standard: units, bounds, dependencies, what is offered."""

import re
import xml.etree.ElementTree as ET
from dataclasses import replace

import numpy as np
import pytest
from astropy import units
from fmpy import read_model_description

from fmu_src.catalogue import MODELS
from fmu_src.interface import Model, Variable
from fmu_src.packaging import builds, c_header, dependence, description
from tests.conftest import CAPTURE
from tests.packaging import toy
from tests.validating import validate_model_description

INTERFACES = {
    "net": MODELS["net_capture"].interface(CAPTURE),
    "net, all terms": MODELS["net_capture"].interface(CAPTURE | {"gravity": "hill", "nodes": "9"}),
    "tug, locked": MODELS["tethered_deorbit"].interface({"reel": "locked", "thrust": "along_track"}),
    "tug, linear": MODELS["tethered_deorbit"].interface({"reel": "linear"}),
    "tug, commanded": MODELS["tethered_deorbit"].interface({"reel": "commanded"}),
    "reel control": MODELS["reel_control"].interface({}),
    "reel control, motor": MODELS["reel_control"].interface({"motor": "lag"}),
    "toy": toy.INTERFACE,
}


@pytest.fixture(params=list(INTERFACES))
def interface(request):
    return INTERFACES[request.param]


@pytest.fixture
def root(interface):
    return ET.fromstring(description.model_description(interface, interface.model.name, "{guid}", "1.0"))


def scalars(root):
    """Name to (1-based index, attributes, attributes of the type)."""
    rows = root.find("ModelVariables")
    return {row.get("name"): (k, row.attrib, row[0].attrib) for k, row in enumerate(rows, 1)}


def test_it_is_valid(interface, tmp_path):
    """By fmpy's schema and its rules."""
    data = description.model_description(interface, interface.model.name, "{guid}", "1.0")
    builds.pack({"modelDescription.xml": data}, tmp_path / "a.fmu")
    about = read_model_description(str(tmp_path / "a.fmu"), validate=True)
    assert validate_model_description(about) == []


def test_units_are_what_their_names_say(interface, root):
    defined = {u.get("name"): u for u in root.iterfind("UnitDefinitions/Unit")}
    used = {t["unit"] for _, _, t in scalars(root).values() if "unit" in t}
    assert used == set(defined)
    for name, unit in defined.items():
        base = unit.find("BaseUnit")
        product = float(base.get("factor", "1")) * units.dimensionless_unscaled
        for key, power in base.attrib.items():
            if key not in ("factor", "offset"):
                product = product * units.Unit(key) ** int(power)
        assert units.Unit(description.python_unit(name)).is_equivalent(product)
        assert (1.0 * units.Unit(description.python_unit(name))).to_value(product) == pytest.approx(1.0, rel=1e-14)
        for display in unit.iterfind("DisplayUnit"):
            shown = (1.0 * units.Unit(description.python_unit(name))).to_value(display.get("name"))
            assert float(display.get("factor")) == pytest.approx(shown, rel=1e-14)
    shown = {(t.get("unit"), t["displayUnit"]) for _, _, t in scalars(root).values() if "displayUnit" in t}
    assert shown == {(u.get("name"), d.get("name")) for u in defined.values() for d in u.iterfind("DisplayUnit")}


def test_bounds_nominals_and_starts_are_the_tables(interface, root):
    found = scalars(root)
    for name, slot, v, start in interface.scalars():
        if not v.at_interface:
            assert name not in found
            continue
        _, row, typed = found[name]
        assert int(row["valueReference"]) == slot
        if v.kind != "Boolean":
            assert float(typed.get("min", "-inf")) == v.minimum
            assert float(typed.get("max", "inf")) == v.maximum
            assert ("start" in typed) == (v.causality != "output")
            assert v.causality == "output" or float(typed["start"]) == start
        assert float(typed.get("nominal", "0")) == v.nominal
        assert row["description"]


def depends(root, part):
    """Name of every unknown in a part of the structure to the names it depends on; None where none are listed."""
    names = list(scalars(root))
    found = {}
    for unknown in root.iterfind(f"ModelStructure/{part}/Unknown"):
        on = unknown.get("dependencies")
        if on is not None:
            assert len(unknown.get("dependenciesKind", "").split()) == len(on.split())
        listed = None if on is None else {names[int(k) - 1] for k in on.split()}
        found[names[int(unknown.get("index")) - 1]] = listed
    return found


def test_dependencies_are_the_tables(interface, root):
    outputs = {n: v for n, _, v, _ in interface.scalars() if v.causality == "output"}
    parameters = {n for n, _, v, _ in interface.scalars() if v.causality == "parameter"}
    table = {name: {by for by, _ in v.partials} for name, v in outputs.items()}
    at_start = {name: on | set(outputs[name].at_start) for name, on in table.items()}
    assert depends(root, "Outputs") == table
    assert depends(root, "InitialUnknowns") == {name: parameters | on for name, on in at_start.items()}
    indices = [int(u.get("index")) for u in root.iterfind("ModelStructure/Outputs/Unknown")]
    assert indices == sorted(indices)


def test_long_arrays_leave_their_initial_dependencies_out():
    """Which means all parameters and inputs, and keeps the description of a fine net small."""
    long = MODELS["net_capture"].interface(CAPTURE | {"nodes": "400"})
    root = ET.fromstring(description.model_description(long, "net", "{guid}", "1.0"))
    initial = depends(root, "InitialUnknowns")
    assert initial["node[400].position[3]"] is None
    assert "net.side" in initial["mouth.area"]


@pytest.mark.parametrize(
    ("name", "rates", "moving", "direct"),
    [
        ("net", "1", "false", "false"),
        ("tug, locked", "1", "true", "true"),
        ("tug, commanded", "1", "true", "true"),
        ("reel control", "1", "true", "true"),
        ("reel control, motor", "1", "true", "true"),
        ("toy", "1", "true", "true"),
    ],
)
def test_what_is_offered_is_what_the_table_has(name, rates, moving, direct):
    root = ET.fromstring(description.model_description(INTERFACES[name], "x", "{guid}", "1.0"))
    offered = root.find("CoSimulation").attrib
    assert offered["maxOutputDerivativeOrder"] == rates
    assert offered["canInterpolateInputs"] == moving
    assert offered["providesDirectionalDerivative"] == direct
    assert offered["canGetAndSetFMUstate"] == offered["canSerializeFMUstate"] == "true"
    categories = [c.get("name") for c in root.iterfind("LogCategories/Category")]
    assert categories == [*(n for n, _ in description.LOG_CATEGORIES), "logAll"]
    assert all(c.get("description") for c in root.iterfind("LogCategories/Category"))


def test_rates_have_the_dimension_of_a_rate(interface):
    """Unit of a rate is unit of the variable per second; of a partial, output per input."""

    def unit(v):
        return units.dimensionless_unscaled if v.unit == "1" else units.Unit(description.python_unit(v.unit))

    rows = {v.name: v for v in interface.variables}
    pairs = [(unit(rows[v.rate]), unit(v) / units.s) for v in interface.variables if v.rate]
    for v in interface.variables:
        if v.kind == "Real":
            by_inputs = [(unit(rows[held]), unit(v) / unit(rows[by])) for by, held in v.partials]
            # one row may serve inputs of several units in several builds: then it tells none
            pairs += [(told, expected) for told, expected in by_inputs if told != units.dimensionless_unscaled]
    assert pairs
    for told, expected in pairs:
        assert told.is_equivalent(expected, equivalencies=units.dimensionless_angles())
        assert told.to(expected, equivalencies=units.dimensionless_angles()) == pytest.approx(1.0)


def broken(**change):
    """The toy's table with its output y changed."""
    base = tuple(replace(v, **change) if v.name == "y" else v for v in toy.MODEL.base)
    return Model("toy", "", base, {}, (), "none", 1.0, 1.0)


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"rate": "z_rate"}, "y names 'z_rate'"),
        ({"rate": "grid[#].at[#]"}, "of shape ()"),
        ({"rate": "steps"}, "expected a Real"),
        ({"partials": (("gain", "y_by_push"),)}, "y is said to depend on gain"),
        ({"partials": (("push", "nothing"),)}, "y names 'nothing'"),
    ],
)
def test_a_table_that_does_not_fit_is_refused(change, words):
    model = broken(**change)
    interface = replace(toy.INTERFACE, model=model, variables=toy.INTERFACE.variables[:6] + model.base)
    with pytest.raises(ValueError, match=re.escape(words)):
        dependence.rates(interface), dependence.partials(interface)


def test_header_refuses_arrays_it_can_not_name():
    variable = Variable("a[#][#][#]", "1", "output", "deep", shape=(2, 2, 2))
    model = Model("toy", "", (variable,), {}, (), "none", 1.0, 1.0)
    with pytest.raises(ValueError, match="at most two indices"):
        c_header.header(model.interface({}), "toy", "{guid}")


def test_slots_are_counted_alike_everywhere(interface):
    first = dependence.first_slots(interface)
    offsets = {name: offset // 8 for name, (_, offset, *_) in interface.dtype.fields.items()}
    assert sorted(slot for slot, _ in first.values()) == sorted(offsets.values())
    assert list(dependence.names_by_slot(interface)) == [n.removeprefix("@") for n, *_ in interface.scalars()]
    assert np.prod(interface.dtype.itemsize) == 8 * sum(1 for _ in interface.scalars())
