"""An FMU file: unpacked once, checked, and read for what it offers.

Whatever is wrong with a file is one `FmuError` that names it. Its binary is not loaded here, since that runs its code:
`component` and `isolation` make instances of it.
"""

from __future__ import annotations

import errno
import hashlib
import math
import re
import xml.etree.ElementTree as ET
import zipfile
from collections.abc import Container
from functools import cached_property
from pathlib import Path
from types import TracebackType
from typing import Any

import fmpy

from dcone_cosim.errors import FmuError
from dcone_cosim.files import regular
from dcone_cosim.fmu.steppable import VariableInfo
from dcone_cosim.names import did_you_mean
from dcone_cosim.scratch import Scratch
from dcone_cosim.units import Unit, by_name, read_units

EXPECTED = "expected FMI 2.0 co-simulation"
XML = "modelDescription.xml"
LARGEST = 2 * 2**30
"""Bytes of an FMU, unpacked; also as it lies in an SSP package."""
MOST = 20_000
"""Entries of an FMU or of an SSP package: to unpack so many takes some seconds, and again in every run."""
LOCAL_HEADER = b"PK\x03\x04"
"""What a zip file begins with."""


class Archive:
    """An FMU file, unpacked to a temporary folder that `close` removes.

    folder       an FMU that is unpacked already, which `close` leaves alone
    tolerance    that the FMU's own solver is told, None for none; that of its default experiment if not given
    within       a folder that the file is in and `close` removes
    remarks      what its user should know of what its instances did, each sentence once
    """

    def __init__(
        self, path: Path, folder: Path | None = None, tolerance: float | None = None, within: Scratch | None = None
    ) -> None:
        self.path, self._within = path, within
        self.remarks: dict[str, None] = {}
        self._unpacked: Scratch | None = None
        self.folder: Path | None = folder
        try:
            if self.folder is None:
                self._unpacked = _unpack(path)
                self.folder = self._unpacked.path
            self.description, root = _description(path, self.folder)
            self.variables = _variables(path, self.description, _relative(root))
            _check_binary(path, self.folder, self.library)
            self.tolerance = self._default_tolerance() if tolerance is None else tolerance
        except BaseException:
            self.close()
            raise

    def _default_tolerance(self) -> float | None:
        experiment = self.description.defaultExperiment
        try:
            told = float(experiment.tolerance) if experiment is not None and experiment.tolerance is not None else 0.0
        except ValueError:
            return None
        return told if 0.0 < told < math.inf else None

    @cached_property
    def sha256(self) -> str:
        return hashlib.sha256(self.path.read_bytes()).hexdigest()

    @property
    def guid(self) -> str:
        return str(self.description.guid)

    @property
    def identifier(self) -> str:
        return str(self.description.coSimulation.modelIdentifier)

    @property
    def library(self) -> Path:
        """Its binary for this platform."""
        assert self.folder is not None
        return self.folder / "binaries" / str(fmpy.platform) / f"{self.identifier}{fmpy.sharedLibraryExtension}"

    @property
    def can_save(self) -> bool:
        return _flag(self.description.coSimulation.canGetAndSetFMUstate)

    @property
    def can_serialise(self) -> bool:
        """Whether its state can be written to a file, and taken up in another process."""
        return self.can_save and _flag(self.description.coSimulation.canSerializeFMUstate)

    @property
    def can_interpolate(self) -> bool:
        return _flag(self.description.coSimulation.canInterpolateInputs)

    @property
    def can_vary_step(self) -> bool:
        """Whether its steps may differ in length."""
        return _flag(self.description.coSimulation.canHandleVariableCommunicationStepSize)

    def variable(self, name: str, instance: str) -> VariableInfo:
        """The variable of that name; an unknown one is an error that names the nearest."""
        try:
            return self.variables[name]
        except KeyError:
            hint = did_you_mean(name, self.variables)
            raise FmuError(f"{instance}: {self.path.name} has no variable {name!r}{hint}") from None

    def remark(self, sentence: str) -> None:
        self.remarks[sentence] = None

    def close(self) -> None:
        for scratch in (self._unpacked, self._within):
            if scratch is not None:
                scratch.remove()
        self.folder = None

    def __enter__(self) -> Archive:
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, at: TracebackType | None) -> None:
        self.close()


def _flag(value: Any) -> bool:
    return value is True or str(value).lower() in ("true", "1")


def _unpack(path: Path) -> Scratch:
    """Unpack into a new folder, after a look at every name in it."""
    _check_file(path)
    folder: Scratch | None = None
    try:
        with zipfile.ZipFile(path) as content:
            names = content.namelist()
            if len(names) > MOST:
                raise FmuError(f"{path}: it has {len(names):,} entries; at most {MOST:,} are unpacked")
            for name in names:
                _check_name(path, name)
            size = sum(entry.file_size for entry in content.infolist())  # unpacking stops at what is declared here
            if size > LARGEST:
                raise FmuError(f"{path}: unpacked it has {size:,} bytes; at most {LARGEST:,} are unpacked")
            folder = Scratch.temporary()
            content.extractall(folder.path)
    except BaseException as error:
        if folder is not None:
            folder.remove()
        if isinstance(error, RuntimeError):  # encrypted, or packed by a method that is not known
            raise FmuError(f"{path}: not a readable FMU ({error})") from None
        # zipfile answers damage with a dozen kinds of error, a seek to nowhere among them
        of_system = isinstance(error, OSError) and error.errno not in (None, errno.EINVAL)
        if isinstance(error, Exception) and not (of_system or isinstance(error, FmuError)):
            raise FmuError(
                f"{path}: a damaged FMU; the file is cut short or was changed on its way ({error})"
            ) from None
        raise
    return folder


def _check_file(path: Path) -> None:
    if not path.exists():
        try:
            beside = [p.name for p in path.parent.iterdir() if p.suffix == ".fmu"]
        except OSError:
            beside = []
        raise FmuError(f"{path}: no such file{did_you_mean(path.name, beside)}")
    if path.is_dir():
        raise FmuError(f"{path}: a folder; expected an FMU, a file that ends in .fmu")
    try:
        with regular(path).open("rb") as file:
            head = file.read(4)
    except OSError as error:
        raise FmuError(f"{path}: cannot be read ({error.strerror})") from None
    if not head:
        raise FmuError(f"{path}: empty; expected an FMU")
    if head[:2] != LOCAL_HEADER[:2]:
        raise FmuError(f"{path}: not a readable FMU: an FMU is a zip file, and this is not one")


def _check_name(path: Path, name: str) -> None:
    parts = re.split(r"[/\\]", name)
    if ".." in parts or name.startswith("/") or re.match(r"[A-Za-z]:", name):
        raise FmuError(f"{path}: refused: its entry {name!r} would be written outside its own folder")
    if "\\" in name:
        raise FmuError(f"{path}: not a readable FMU: its entry {name!r} has a backslash; FMI 2.0 asks for /")


def _description(path: Path, folder: Path) -> tuple[Any, ET.Element]:
    """The model description, once it is known to be one of FMI 2.0 co-simulation, and its XML."""
    file = folder / XML
    if not file.is_file():
        found = sorted(p.relative_to(folder).as_posix() for p in folder.rglob("*") if p.name.lower() == XML.lower())
        if found:
            raise FmuError(f"{path}: no {XML} at its top; there is {found[0]}")
        raise FmuError(f"{path}: not an FMU: it has no {XML}")
    try:
        root = ET.parse(file).getroot()
    except ET.ParseError as error:
        raise FmuError(f"{path}: its {XML} is not valid XML ({error})") from None
    version = root.get("fmiVersion")
    if root.tag != "fmiModelDescription" or version is None:
        told = ", without an fmiVersion" if version is None else f", fmiVersion {version}"
        raise FmuError(f"{path}: its {XML} is not that of an FMU: it begins with <{root.tag}>{told}")
    if version != "2.0":
        raise FmuError(f"{path}: this is FMI {version}; {EXPECTED}")
    try:
        description = fmpy.read_model_description(str(folder), validate=False)
    except Exception as error:
        raise FmuError(f"{path}: its {XML} does not follow FMI 2.0 ({type(error).__name__}: {error})") from None
    about = description.coSimulation
    if about is None:
        kind = "for model exchange only" if description.modelExchange is not None else "neither of its kinds"
        raise FmuError(f"{path}: this is FMI 2.0 {kind}; {EXPECTED}")
    if not about.modelIdentifier or not description.guid:
        raise FmuError(f"{path}: its {XML} has no modelIdentifier or no guid")
    if re.search(r"[/\\:\0]", about.modelIdentifier) or about.modelIdentifier in (".", ".."):
        raise FmuError(f"{path}: refused: its modelIdentifier {about.modelIdentifier!r} is a path; expected a name")
    return description, root


def _relative(root: ET.Element) -> frozenset[str]:
    """Names of the variables whose values are differences, by themselves or by their declared type; fmpy 0.3 hands on
    neither for certain."""
    of_types = {
        row.get("name", "")
        for row in root.iterfind("TypeDefinitions/SimpleType")
        if (real := row.find("Real")) is not None and _flag(real.get("relativeQuantity"))
    }
    return frozenset(
        row.get("name", "")
        for row in root.iterfind("ModelVariables/ScalarVariable")
        if (real := row.find("Real")) is not None
        and (_flag(own) if (own := real.get("relativeQuantity")) is not None else real.get("declaredType") in of_types)
    )


def _variables(path: Path, description: Any, relative: Container[str]) -> dict[str, VariableInfo]:
    """Its variables by name. Several may share a value reference; a name can be there only once."""
    units = read_units(description.unitDefinitions, str(path))
    found: dict[str, VariableInfo] = {}
    for v in description.modelVariables:
        if v.name in found:
            raise FmuError(f"{path}: its {XML} has two variables named {v.name!r}")
        kind = "Integer" if v.type == "Enumeration" else v.type
        name = (v.unit or (v.declaredType.unit if v.declaredType is not None else "") or "") if kind == "Real" else ""
        unit = units.get(name) or by_name(name)
        label = unit.si_name
        if v.name in relative:
            unit = unit.of_differences()
        found[v.name] = VariableInfo(
            v.name,
            int(v.valueReference),
            kind,
            label,
            v.causality or "local",
            v.description or "",
            unit,
            v.variability or "",
            v.initial or "",
            _number(path, v.name, "start", v.start, kind, unit),
            *_bounds(path, v, kind, unit),
        )
    return found


def _number(path: Path, name: str, what: str, text: Any, kind: str, unit: Unit) -> float | None:
    """A number of the model description in SI; None for none, or for a text."""
    if text is None or kind == "String":
        return None
    if kind == "Boolean":
        return float(_flag(text))
    try:
        value = float(text)
    except ValueError:
        raise FmuError(f"{path}: {what} of its variable {name!r} is {text!r}, no number") from None
    return unit.to_si(value)


def _bounds(path: Path, v: Any, kind: str, unit: Unit) -> tuple[float, float]:
    low = _number(path, v.name, "min", v.min, kind, unit)
    high = _number(path, v.name, "max", v.max, kind, unit)
    bounds = (-math.inf if low is None else low, math.inf if high is None else high)
    return (min(bounds), max(bounds)) if unit.factor < 0.0 else bounds


def _check_binary(path: Path, folder: Path, library: Path) -> None:
    """There is a binary for this platform, under the name the model description says."""
    if library.is_file():
        return
    here, wanted = library.parent, library.name
    if here.is_dir():
        there = sorted(p.name for p in here.iterdir())
        listed = ", ".join(there) or "nothing"
        raise FmuError(f"{path}: binaries/{fmpy.platform} has no {wanted}, the name its {XML} says; it has {listed}")
    platforms = sorted({p.parent.name for p in (folder / "binaries").glob("*/*") if p.is_file()})
    offers = f"it has binaries for {', '.join(platforms)}" if platforms else "it has no binary at all"
    if any((folder / "sources").glob("*.c")):
        offers += ", and C sources, which have to be compiled first"
    raise FmuError(f"{path}: no binary for {fmpy.platform}, this computer; {offers}")
