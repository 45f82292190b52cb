"""The result store: a folder of rows, each whole or not there, whoever is killed while writing.

    study.json                     what the rows are of; a folder with another one is not touched
    rows/KEY.json                  one row, under the hash of its case
    rows/many-HASH.parquet         many of them: columns `key` and `row`

A row is written under another name in a scratch folder, forced to disk and renamed. Rows are gathered in segments when
there are many. A segment is on the disk before its rows go, is named by the hash of its keys and never changes. So
several processes may write at once: what they write under one name says the same. A row that says that its worker died
never takes the place of another. What is damaged counts as not there, and a file of any other name is left alone.
"""

from __future__ import annotations

import hashlib
import json
import os
import re
from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from contextlib import suppress
from pathlib import Path
from types import TracebackType
from typing import Any

from dcone_cosim import placed
from dcone_cosim.cases.rows import Row
from dcone_cosim.drafts import LITTER, check_folder, to_disk
from dcone_cosim.errors import InputError
from dcone_cosim.run_folder import as_json
from dcone_cosim.scratch import PREFIX, Scratch, clear_left

STUDY, ROWS = "study.json", "rows"
GATHERED = 1000
"""Rows of a segment."""
TOGETHER = 16
"""Rows that come together from which on they are a segment at once: a file less for each costs the disk 4 ms less."""
AT_HAND = 64
"""Segments in memory: rows are asked for about in the order in which they came."""
AT_ONCE = 8
"""Rows that are forced to disk side by side: the system waits for the disk once for all of them."""
_ROW = re.compile(r"([0-9a-f]{64})\.json")
_SEGMENT = re.compile(r"many-[0-9a-f]{64}\.parquet")
TOLD = 5
"""Files of others that a refusal names."""


class Store:
    """The rows in a folder, to be read, and written by this process among others.

    study      what they are of; `refuse(other)` of a folder that is of another says what to tell, "" for the same

    `InputError`, and nothing is touched, for a folder that holds something else.
    """

    def __init__(self, folder: Path, study: Mapping[str, Any]) -> None:
        self.folder = folder
        check_folder(folder)
        if folder.is_dir():
            clear_left(folder)
        self._claim(study)
        self._rows = folder / ROWS
        self._rows.mkdir(exist_ok=True)
        self._scratch = Scratch(folder)
        self._gathered: dict[str, Path] = {}
        self._read: dict[Path, dict[str, str]] = {}
        self._look()

    def _claim(self, study: Mapping[str, Any]) -> None:
        """Write what the folder is of. One that goes on says what this command asks for: more cases, another bound."""
        file = self.folder / STUDY
        if not file.exists():
            others = sorted(p.name for p in self.folder.iterdir()) if self.folder.is_dir() else []
            others = [name for name in others if name not in LITTER and not name.startswith(PREFIX)]
            if others:
                more = f" and {len(others) - TOLD} more" if len(others) > TOLD else ""
                raise InputError(
                    f"{self.folder} holds other files: {', '.join(others[:TOLD])}{more}; choose a new folder with -o"
                )
            self.folder.mkdir(parents=True, exist_ok=True)
            with suppress(FileExistsError):  # another process was first: what it says is looked at now
                self._write(study, placed.put_new)
        told, asked = self._study(file), json.loads(as_json(study))
        reason = unlike(told, asked)
        if reason:
            raise InputError(f"{self.folder} {reason}; choose a new folder with -o")
        if told != asked:
            self._write(study, placed.put)

    def _write(self, study: Mapping[str, Any], put: Callable[[Path, Path], Path]) -> None:
        with Scratch(self.folder) as scratch:
            draft = scratch / STUDY
            draft.write_text(as_json(study) + "\n", encoding="utf-8")
            to_disk(draft)
            put(draft, self.folder / STUDY)

    @staticmethod
    def _study(file: Path) -> Mapping[str, Any]:
        try:
            told = json.loads(file.read_text(encoding="utf-8"))
        except (OSError, ValueError) as error:
            raise InputError(f"{file} cannot be read: {error}; choose a new folder with -o") from None
        if not isinstance(told, dict):
            raise InputError(f"{file} tells of no cases; choose a new folder with -o")
        return told

    def _look(self) -> None:
        """See what there is: rows first, since a row may be moved into a segment meanwhile, and never out of one."""
        self._loose = {match[1] for name in os.listdir(self._rows) if (match := _ROW.fullmatch(name))}
        for name in sorted(os.listdir(self._rows)):
            if _SEGMENT.fullmatch(name):
                path = self._rows / name
                self._gathered |= dict.fromkeys(self._segment(path), path)

    def _segment(self, path: Path) -> dict[str, str]:
        """Texts of the rows of a segment by key; the last few that were read are kept."""
        import pyarrow.parquet

        if path not in self._read:
            found: dict[str, str] = {}
            with suppress(Exception):  # damaged: its rows are not there
                table = pyarrow.parquet.read_table(path)
                found = dict(zip(table["key"].to_pylist(), table["row"].to_pylist(), strict=True))
            self._read[path] = found
            while len(self._read) > AT_HAND:
                del self._read[next(iter(self._read))]
        return self._read[path]

    def get(self, key: str) -> Row | None:
        """The row of this case, None when there is none; what says that a worker died comes after what does not."""
        row = self._get(key)
        if row is None and key in self._loose:  # damaged, or another process has just put it into a segment
            self._look()
            row = self._get(key)
        return row

    def _get(self, key: str) -> Row | None:
        rows = [row for row in (self._loose_row(key), self._gathered_row(key)) if row is not None]
        return next((row for row in rows if row.lasting), rows[0] if rows else None)

    def _loose_row(self, key: str) -> Row | None:
        try:
            row = Row.from_text((self._rows / f"{key}.json").read_text(encoding="utf-8"))
        except (OSError, ValueError):
            return None
        return row if row.key == key else None

    def _gathered_row(self, key: str) -> Row | None:
        path = self._gathered.get(key)
        text = self._segment(path).get(key) if path is not None else None
        with suppress(ValueError):
            return Row.from_text(text) if text is not None else None
        return None

    def put(self, row: Row) -> None:
        """Keep a row. It is on the disk when this returns."""
        self.put_all([row])

    def put_all(self, rows: Sequence[Row]) -> None:
        """Keep several. They are on the disk when this returns, which takes hardly longer than for one."""
        whole = [row for row in rows if row.lasting]
        if len(whole) >= TOGETHER:
            self._write_segment(sorted(whole, key=lambda row: row.key))
            rows = [row for row in rows if not row.lasting]
        if len(rows) > 1:
            with ThreadPoolExecutor(min(len(rows), AT_ONCE)) as pool:
                drafts = list(pool.map(self._draft, rows))
        else:
            drafts = [self._draft(row) for row in rows]
        for row, draft in zip(rows, drafts, strict=True):
            self._place(row, draft)

    def _draft(self, row: Row) -> Path:
        draft = self._scratch.path / f"{row.key}.json"
        draft.write_text(row.as_text() + "\n", encoding="utf-8")
        to_disk(draft)
        return draft

    def _place(self, row: Row, draft: Path) -> None:
        path = self._rows / f"{row.key}.json"
        if row.lasting or (path.exists() and self._loose_row(row.key) is None):
            draft.replace(path)
        else:
            with suppress(FileExistsError):
                placed.put_new(draft, path)
            draft.unlink(missing_ok=True)
        self._loose.add(row.key)
        if len(self._loose) >= GATHERED:
            self.gather()

    def gather_if_many(self, many: int = GATHERED // 10) -> None:
        """Leave few files behind."""
        if len(self._loose) >= many:
            self.gather()

    def gather(self) -> None:
        """Put all rows that lie alone and last into segments, and remove them once these are on the disk."""
        to_disk(self._rows)
        alone = {key: row for key in sorted(self._loose) if (row := self._loose_row(key)) is not None and row.lasting}
        for first in range(0, len(alone), GATHERED):
            part = list(alone.values())[first : first + GATHERED]
            self._write_segment(part)
            for row in part:
                (self._rows / f"{row.key}.json").unlink(missing_ok=True)
        self._loose -= alone.keys()

    def _write_segment(self, rows: list[Row]) -> None:
        import pyarrow as pa
        import pyarrow.parquet

        keys = [row.key for row in rows]
        name = hashlib.sha256("".join(keys).encode()).hexdigest()
        draft, path = self._scratch.path / "segment", self._rows / f"many-{name}.parquet"
        pyarrow.parquet.write_table(
            pa.table({"key": keys, "row": [row.as_text() for row in rows]}), draft, compression="zstd"
        )
        to_disk(draft)
        draft.replace(path)
        to_disk(self._rows)
        self._read.pop(path, None)
        self._gathered |= dict.fromkeys(keys, path)

    def close(self) -> None:
        self._scratch.remove()

    def __enter__(self) -> Store:
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, at: TracebackType | None) -> None:
        self.close()


def unlike(told: Mapping[str, Any], study: Mapping[str, Any]) -> str:
    """How the study that a folder tells of differs from one, in words that follow the folder's name; "" if it does not.

    Both are as read from JSON.
    """
    if told.get("kind") != study["kind"]:
        return f"holds {told.get('kind', 'something else')}, not {study['kind']}"
    if told.get("scene") != study["scene"]:
        return f"holds {study['kind']} of another scene, {told.get('scene')!r}; this is {study['scene']!r}"
    if told.get("code") != study["code"]:
        return (
            f"holds {study['kind']} made by other code, {_spoken(told.get('code'))}; this is {_spoken(study['code'])}, "
            "whose numbers may differ"
        )
    if told.get("varied") != study["varied"]:
        return f"holds {study['kind']} over {_listed(told.get('varied'))}; this is over {_listed(study['varied'])}"
    for name, identity in study["fmus"].items():
        was = told.get("fmus", {}).get(name)
        if was != identity:
            change = f"it was {str(was)[:12]}..., it is {identity[:12]}..."
            return f"holds {study['kind']} with another FMU of the {name}: {change}"
    if told.get("content") != study["content"]:
        return f"holds {study['kind']} of {study['scene']!r} with other values in the scene, or with other settings"
    return ""


def _spoken(code: Any) -> str:
    told = code if isinstance(code, Mapping) else {}
    return f"dcone-cosim {told.get('dcone-cosim', '?')} (sources {str(told.get('sources', '?'))[:8]})"


def _listed(keys: Any) -> str:
    return ", ".join(map(str, keys)) if keys else "no key"
