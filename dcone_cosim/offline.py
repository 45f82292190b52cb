"""`--offline`: the promise that nothing is fetched, kept by refusing every connection.

Nothing here needs a network: FMUs are built from what is installed, and those of others are files. The promise covers
this process, and by its environment the tools it starts; what the binary of a foreign FMU does, it does not see.
"""

from __future__ import annotations

import os
import sys
from typing import Any

from dcone_cosim.errors import InputError

NOWHERE = "http://127.0.0.1:9"
"""A proxy that refuses (the discard port): where tools are sent that would reach out."""
PROXIES = ("http_proxy", "https_proxy", "ftp_proxy", "all_proxy")
REACHING_OUT = ("socket.connect", "socket.sendto", "socket.getaddrinfo", "socket.gethostbyname")

_refusing = False
_hooked = False


def _watch(event: str, arguments: tuple[Any, ...]) -> None:
    if not _refusing or event not in REACHING_OUT:
        return
    address = arguments[1] if event in ("socket.connect", "socket.sendto") else arguments[0]
    if event.startswith(("socket.connect", "socket.sendto")) and not isinstance(address, tuple):
        return  # a socket of this machine's file system
    where = address[0] if isinstance(address, tuple) else address
    raise InputError(f"--offline: a connection to {where} was refused; nothing is fetched")


def go_offline() -> None:
    """Refuse every connection of this process from now on, and give what it starts a proxy that leads nowhere."""
    global _refusing, _hooked
    if not _hooked:
        sys.addaudithook(_watch)
        _hooked = True
    _refusing = True
    for name in PROXIES:
        os.environ[name] = os.environ[name.upper()] = NOWHERE
    os.environ["no_proxy"] = os.environ["NO_PROXY"] = ""


def go_online() -> None:
    """Refuse no more; the environment stays."""
    global _refusing
    _refusing = False
