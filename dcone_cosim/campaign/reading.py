"""Reads a campaign from TOML; every mistake is told at once, with file, line, key and the nearest name.

title = "..."          scene = "table1-capture"      seed = 1
sampler = "monte-carlo"                              until = "95 % within 1 %"   # or n = 1000
record = ["capture.t_capture"]                       success = "captured"
[set.capture.ejection] number = 4                    values of the scene for all cases
[[dispersion]]  key = "..."  distribution = "normal"  deviation = "0.03 m/s"
[[correlation]] between = ["...", "..."]  coefficient = 0.5
"""

from __future__ import annotations

import math
import re
import tomllib
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

from dcone_cosim.campaign import distributions
from dcone_cosim.campaign.outcomes import WORDS
from dcone_cosim.campaign.spec import (
    ADAPTIVE,
    GRID,
    MONTE_CARLO,
    SAMPLERS,
    SUBSET,
    Correlation,
    Dispersion,
    Judged,
    Spec,
    Success,
    Until,
)
from dcone_cosim.campaign.toml_text import as_toml, flat
from dcone_cosim.errors import InputError
from dcone_cosim.scene.expected import number_and_unit
from dcone_cosim.scene.mistakes import Mistake, Mistakes, Places, SceneError, unknown
from dcone_cosim.scene.toml_lines import Path as KeyPath
from dcone_cosim.scenes.reading import read_text
from dcone_cosim.units import by_name, named

KEYS = (
    *("title", "scene", "seed", "sampler", "n", "until", "most", "jitter", "record", "success", "set"),
    *("dispersion", "correlation", "indices", "factor_of_safety", "too_near", "judged_after", "by"),
)
OF_DISPERSION = ("key", "distribution", "values", "weights", "points", "together", "within")
OF_DISCRETE = ("key", "keys", "name", "names", "distribution", "values", "weights", "together")
OF_CORRELATION = ("between", "coefficient")
OF_SUCCESS = ("figure", "above", "below", "outcome")
MOST = 1_000_000
"""Cases of a campaign."""
MOST_FACTOR = 100.0
"""Largest factor of safety: beyond, it is a number that was meant for something else."""
_UNTIL = re.compile(r"\s*(\d+(?:\.\d*)?)\s*%\s*within\s*(\d+(?:\.\d*)?)\s*%\s*")
_TEXT = "expected a text"


class Reader:
    """Takes a document apart and notes what is wrong with it."""

    def __init__(self, text: str, source: str, cases: int | None = None) -> None:
        self.places = Places(source, text)
        self.wrong = Mistakes()
        try:
            self.document: Mapping[str, Any] = tomllib.loads(text)
        except (tomllib.TOMLDecodeError, RecursionError, ValueError) as error:
            raise InputError(f"{source} is not valid TOML, or cut short: {error}") from None
        if cases is not None:
            self.document = {key: value for key, value in self.document.items() if key != "until"} | {"n": cases}

    def told(self, name: str) -> Spec:
        """The campaign; a `SceneError` lists every mistake."""
        document = self.document
        self._known((), document, KEYS)
        sampler = document.get("sampler", MONTE_CARLO)
        if sampler not in SAMPLERS:
            self._unknown(("sampler",), sampler, "expected a sampler", SAMPLERS)
        spec = Spec(
            name=name,
            title=self._text(("title",), document.get("title", name)),
            scene=self._text(("scene",), document.get("scene")),
            places=self.places,
            seed=self._whole(("seed",), document.get("seed", 0), 0, 2**31 - 1),
            sampler=sampler if isinstance(sampler, str) else "",
            n=None if "n" not in document else self._whole(("n",), document["n"], 1, MOST),
            until=self._until(document.get("until")),
            most=self._whole(("most",), document.get("most", 100_000), 2, MOST),
            jitter=self._truth(("jitter",), document.get("jitter", False)),
            record=self._texts(("record",), document.get("record", [])),
            success=replace(self._success(document.get("success")), judged=self._judged()),
            dispersions=tuple(self._dispersions(document.get("dispersion", []))),
            correlations=tuple(self._correlations(document.get("correlation", []))),
            settings=tuple(self._settings(document.get("set", {}))),
            indices=self._texts(("indices",), document.get("indices", [])),
            factor_of_safety=self._factor(document.get("factor_of_safety", 2.0)),
            by=self._texts(("by",), document.get("by", [])),
        )
        self._together(spec)
        self.end()
        return spec

    def end(self) -> None:
        if self.wrong:
            raise SceneError(self.wrong, self.places)

    def _together(self, spec: Spec) -> None:
        """What goes together."""
        if not self.document.get("dispersion", []) and not spec.jitter:
            self._miss(("dispersion",), "expected at least one [[dispersion]], or jitter = true")
        if spec.until is not None and spec.sampler != MONTE_CARLO:
            why = f'needs sampler = "{MONTE_CARLO}": only independent cases may be stopped at any number'
            self._say(("until",), spec.until.text, why)
        if spec.until is not None and spec.n is not None:
            self._say(("n",), spec.n, "expected one of n and until")
        if spec.sampler != GRID and {"n", "until"}.isdisjoint(self.document):
            self._miss(("n",), 'expected how many cases, or until = "95 % within 1 %"')
        if spec.sampler == SUBSET and not spec.success.figure:
            text = 'expected success = { figure = "capture.enclosure.at_capture", above = 0.9 }: '
            self._miss(("success",), text + f'sampler = "{SUBSET}" needs a figure with a bound')
        discrete = [one.key for one in spec.dispersions if one.distribution == distributions.DISCRETE]
        for place, key in enumerate(spec.by):
            if key not in discrete:
                self._unknown(("by", place), key, "expected the key, or the name, of a discrete dispersion", discrete)
        if spec.by and spec.sampler != MONTE_CARLO:
            self._say(("by",), list(spec.by), f'needs sampler = "{MONTE_CARLO}": its cases alone are independent')
        if spec.sampler == SUBSET and spec.success.figure and spec.success.outcome:
            self._say(("success", "outcome"), spec.success.outcome, f'sampler = "{SUBSET}" goes by the figure alone')
        if spec.sampler in (ADAPTIVE, SUBSET) and spec.jitter and spec.sampler == ADAPTIVE:
            self._say(("jitter",), True, f'sampler = "{ADAPTIVE}" maps two or three values; leave it out')

    # ---- parts

    def _until(self, given: Any) -> Until | None:
        if given is None:
            return None
        match = _UNTIL.fullmatch(given) if isinstance(given, str) else None
        said = 'expected such as "95 % within 1 %": the confidence of an interval, and half its width'
        if match is None:
            self._say(("until",), given, said)
            return None
        confidence, within = float(match[1]) / 100.0, float(match[2]) / 100.0
        if not (0.5 <= confidence < 1.0 and 0.0 < within < 0.5):
            self._say(("until",), given, f"{said}; 50 to 99.999 %, and less than 50 %")
            return None
        return Until(confidence, within, given)

    def _success(self, given: Any) -> Success:
        if given is None:
            return Success()
        if isinstance(given, str):
            if given not in WORDS:
                self._unknown(("success",), given, "expected an outcome", WORDS)
            return Success(outcome=given, text=given, said=True)
        if not isinstance(given, Mapping):
            self._say(("success",), given, 'expected an outcome such as "captured", or a table with figure and bound')
            return Success()
        self._known(("success",), given, OF_SUCCESS)
        figure = self._text(("success", "figure"), given.get("figure"))
        if len({"above", "below"} & given.keys()) != 1:
            self._miss(("success", "above"), "expected one of above and below")
            return Success()
        side = "above" if "above" in given else "below"
        bound, unit = self._quantity(("success", side), given[side])
        outcome = given.get("outcome", "")
        if "outcome" in given and outcome not in WORDS:
            self._unknown(("success", "outcome"), outcome, "expected an outcome", WORDS)
        text = f"{figure} {side} {given[side]}{f', {outcome}' if outcome else ''}"
        return Success(outcome, figure, bound, side == "above", text, unit, given[side], said=True)

    def _judged(self) -> Judged:
        """When an outcome is judged, and what is too near."""
        found = {}
        for key, field, unit, example in (("too_near", "too_near", "m", "4 m"), ("judged_after", "after", "s", "5 s")):
            if key in self.document:
                value, given = self._quantity((key,), self.document[key])
                if by_name(given).dimension != by_name(unit).dimension or not value > 0.0:
                    self._say((key,), self.document[key], f'expected such as "{example}"')
                else:
                    found[field] = value
        return Judged(**found)

    def _settings(self, given: Any) -> Iterator[str]:
        """The table `set` as the settings of a command line."""
        if not isinstance(given, Mapping):
            self._say(("set",), given, "expected a table with values of the scene, such as [set.capture.ejection]")
            return
        yield from (f"{key}={value}" for key, value in flat(given))

    def _dispersions(self, given: Any) -> Iterator[Dispersion]:
        for place, table in self._tables("dispersion", given):
            path: KeyPath = ("dispersion", place)
            word = table.get("distribution")
            own = "name" if word == distributions.DISCRETE and "keys" in table else "key"
            key = self._text((*path, own), table.get(own))
            if not isinstance(word, str):
                self._missing(
                    (*path, "distribution"), word, f"expected one of {', '.join(distributions.KINDS)}, discrete"
                )
                continue
            if word == distributions.DISCRETE:
                yield self._discrete(path, key, table)
                continue
            kind = distributions.KINDS.get(word) or distributions.of_scipy(word)
            if kind is None:
                said = "expected a distribution: one of these, or a continuous one of scipy.stats"
                self._unknown((*path, "distribution"), word, said, distributions.like(word))
                continue
            parameters = (*kind.needs, *kind.may)
            self._known(path, table, (*OF_DISPERSION, *parameters))
            for name in ("values", "weights"):
                if name in table:
                    self._say((*path, name), table[name], "only a discrete distribution has them")
            told = {name: table[name] for name in (*parameters, "within") if name in table}
            points = self._whole((*path, "points"), table["points"], 2, MOST) if "points" in table else 0
            together = self._number((*path, "together"), table.get("together", 0.0))
            yield Dispersion(path, key, word, told, points=points, together=together)

    def _discrete(self, path: KeyPath, key: str, table: Mapping[str, Any]) -> Dispersion:
        self._known(path, table, OF_DISCRETE)
        keys = self._texts((*path, "keys"), table.get("keys", []))
        values = table.get("values")
        if not isinstance(values, list) or len(values) < 2:
            self._missing((*path, "values"), values, "expected a list of two values or more")
            values = []
        weights = table.get("weights", [1.0] * len(values))
        good = isinstance(weights, list) and all(
            isinstance(w, int | float) and not isinstance(w, bool) for w in weights
        )
        if not good or len(weights) != len(values):
            self._say((*path, "weights"), table.get("weights"), "expected a number for each value")
            weights = [1.0] * len(values)
        try:
            if weights:
                distributions.chooser(weights)
        except distributions.Unfit as error:
            self._say((*path, "weights"), table.get("weights"), str(error))
        together = self._number((*path, "together"), table.get("together", 0.0))
        texts, settings = self._values(path, table, key, keys, values)
        weights = [float(w) for w in weights]
        return Dispersion(path, key, distributions.DISCRETE, {}, texts, weights, 0, together, keys, settings)

    def _values(
        self, path: KeyPath, table: Mapping[str, Any], key: str, keys: Sequence[str], values: Sequence[Any]
    ) -> tuple[list[str], list[tuple[str, ...]]]:
        """What the values of a discrete dispersion are called, and the settings that they mean; none where those follow
        from key and text."""
        if "name" in table and not keys:
            self._say((*path, "name"), table["name"], "goes with keys: several keys have one name")
        names = list(self._texts((*path, "names"), table.get("names", [])))
        if names and (len(names) != len(values) or len({*names}) < len(names)):
            self._say((*path, "names"), names, "expected a name for each value, each once")
        if not keys:
            texts = [as_toml(value) for value in values]
            return (names, [(f"{key}={text}",) for text in texts]) if names else (texts, [])
        if len(names) != len(values):
            self._say((*path, "names"), names, "expected a name for each value, each once: several keys have no text")
        settings = []
        for place, value in enumerate(values):
            if not isinstance(value, list) or len(value) != len(keys):
                self._say((*path, "values", place), value, f"expected a list with a value for each of {len(keys)} keys")
                continue
            settings.append(tuple(f"{one}={as_toml(each)}" for one, each in zip(keys, value, strict=True)))
        return names, settings

    def _correlations(self, given: Any) -> Iterator[Correlation]:
        for place, table in self._tables("correlation", given):
            path: KeyPath = ("correlation", place)
            self._known(path, table, OF_CORRELATION)
            between = self._texts((*path, "between"), table.get("between", []))
            if len(between) != 2 or between[0] == between[-1]:
                self._say((*path, "between"), table.get("between"), "expected two keys of dispersions")
                continue
            coefficient = self._number((*path, "coefficient"), table.get("coefficient"))
            if not -1.0 < coefficient < 1.0:
                self._say((*path, "coefficient"), coefficient, "expected a number between -1 and 1")
            yield Correlation(path, (between[0], between[1]), coefficient)

    # ---- values

    def _tables(self, name: str, given: Any) -> Iterator[tuple[int, Mapping[str, Any]]]:
        if not isinstance(given, list):
            self._say((name,), given, f"expected [[{name}]], one or several")
            return
        for place, table in enumerate(given):
            if isinstance(table, Mapping):
                yield place, table
            else:
                self._say((name, place), table, "expected a table")

    def _quantity(self, path: KeyPath, given: Any) -> tuple[float, str]:
        """A number in SI with the name of the unit that it was given in: a bare one is a pure number."""
        number, name = math.nan, ""
        if isinstance(given, int | float) and not isinstance(given, bool):
            number = float(given)
        elif isinstance(given, str):
            number, name = number_and_unit(given) or (math.nan, "")
        unit = named(name) if name else by_name("1")
        if not math.isfinite(number) or unit is None:
            self._missing(path, given, 'expected a finite number, or one with its unit such as "24 m"')
            return 0.0, "1"
        return unit.to_si(number), unit.name

    def _known(self, path: KeyPath, table: Mapping[str, Any], known: Sequence[str]) -> None:
        for key in table:
            if key not in known:
                self.wrong.append(unknown((*path, key), table[key], "is not known here", key, known))

    def _unknown(self, path: KeyPath, given: Any, said: str, known: Any) -> None:
        self.wrong.append(unknown(path, given, said, str(given), list(known)))

    def _say(self, path: KeyPath, given: Any, said: str) -> None:
        self.wrong.append(Mistake(path, given, said))

    def _miss(self, path: KeyPath, said: str) -> None:
        self.wrong.append(Mistake(path, None, said))

    def _missing(self, path: KeyPath, given: Any, said: str) -> None:
        self.wrong.append(Mistake(path, given, said))

    def _text(self, path: KeyPath, given: Any) -> str:
        if not isinstance(given, str) or not given.strip():
            self._missing(path, given, _TEXT)
            return ""
        return given

    def _texts(self, path: KeyPath, given: Any) -> tuple[str, ...]:
        if not isinstance(given, list) or not all(isinstance(one, str) and one for one in given):
            self._say(path, given, "expected a list of texts")
            return ()
        return tuple(given)

    def _truth(self, path: KeyPath, given: Any) -> bool:
        if not isinstance(given, bool):
            self._say(path, given, "expected true or false")
        return given is True

    def _whole(self, path: KeyPath, given: Any, least: int, most: int) -> int:
        if isinstance(given, bool) or not isinstance(given, int) or not least <= given <= most:
            self._say(path, given, f"expected a whole number, {least:,} to {most:,}")
            return least
        return given

    def _number(self, path: KeyPath, given: Any) -> float:
        if isinstance(given, bool) or not isinstance(given, int | float) or not math.isfinite(given):
            self._missing(path, given, "expected a number")
            return 0.0
        return float(given)

    def _factor(self, given: Any) -> float:
        """A factor of safety: a line that is to bear less than its tug would be none."""
        path: KeyPath = ("factor_of_safety",)
        if isinstance(given, int | float) and not isinstance(given, bool) and not 1.0 <= given <= MOST_FACTOR:
            self._say(path, given, f"expected a number from 1 to {MOST_FACTOR:g}")
            return 1.0
        return self._number(path, given)


def read(path: Path, cases: int | None = None) -> Spec:
    """The campaign of a file."""
    return parse(read_text(path), path.stem, str(path), cases)


def parse(text: str, name: str, source: str, cases: int | None = None) -> Spec:
    """A campaign from its text; `source` names it in messages, `cases` takes the place of its `n` or `until`."""
    return Reader(text, source, cases).told(name)
