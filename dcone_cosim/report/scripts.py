"""The scripts of a page, all in it: our own modules and three.js, under names of an import map, as data URLs.

three.js is the one file of this project that comes from elsewhere: `templates/three/ORIGIN.toml` says which it is, and
it is held against that before it goes into a page.
"""

from __future__ import annotations

import base64
import hashlib
import json
import re
import tomllib
from functools import cache
from pathlib import Path

from dcone_cosim.errors import InputError

TEMPLATES = Path(__file__).parents[1] / "templates"
SCRIPTS, THREE = TEMPLATES / "scripts", TEMPLATES / "three"
IMPORTED = re.compile(r"""(?:from\s*|import\s*\(?\s*)["']([^"']+)["']""")
OURS = "dcone/"


def import_map(entry: str, more: tuple[str, ...] = ()) -> str:
    """The import map, as JSON, of a module of ours and of all that it imports; `more` are modules imported later."""
    wanted, found = [OURS + entry, *(OURS + one for one in more)], dict[str, str]()
    while wanted:
        name = wanted.pop()
        if name in found:
            continue
        text = three() if name == "three" else script(name.removeprefix(OURS))
        found[name] = "data:text/javascript;base64," + base64.b64encode(text.encode()).decode()
        if name != "three":
            wanted += [one for one in IMPORTED.findall(text) if one == "three" or one.startswith(OURS)]
    return json.dumps({"imports": dict(sorted(found.items()))})


def script(name: str) -> str:
    """The text of a module of ours."""
    return (SCRIPTS / f"{name}.js").read_text(encoding="utf-8")


@cache
def origin() -> dict[str, str]:
    """Which three.js it is: name, version, licence, hash."""
    return {key: str(value) for key, value in tomllib.loads((THREE / "ORIGIN.toml").read_text("utf-8")).items()}


@cache
def three() -> str:
    """three.js; `InputError` where the file is not the one that was taken."""
    path = THREE / Path(origin()["file"]).name
    content = path.read_bytes()
    if hashlib.sha256(content).hexdigest() != origin()["sha256"]:
        raise InputError(
            f"{path} is not three.js {origin()['version']} as it was taken: its hash is another; reinstall"
        )
    return content.decode()
