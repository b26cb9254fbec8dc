"""Address of a Dask scheduler, and whether anybody listens there: asked before a study is built."""

import json
import socket
from contextlib import suppress
from pathlib import Path
from urllib.parse import urlsplit

TIMEOUT = 5.0  # s, to reach a scheduler
SOCKETS = ("tcp", "tls")  # protocols that are a socket


def scheduler(given: str) -> str:
    """Address of a scheduler, as given or from its scheduler file, with its protocol. Raises ValueError."""
    path = Path(given)
    if not path.is_file():
        if path.suffix == ".json":
            raise ValueError(f"there is no scheduler file {given}")
        return given if "://" in given else f"tcp://{given}"
    try:
        return str(json.loads(path.read_text())["address"])
    except (OSError, ValueError, KeyError, TypeError) as error:
        raise ValueError(f"{given} is no scheduler file of Dask") from error


def unreachable(given: str) -> ValueError:
    """Error of an address where no scheduler answers."""
    return ValueError(
        f"no Dask scheduler answers at {given} within {TIMEOUT:g} s; give the address that it prints, such as "
        "tcp://10.0.0.1:8786, or its scheduler file"
    )


def check_reachable(given: str) -> None:
    """Raise ValueError where nobody listens at the address of a scheduler."""
    address = scheduler(given)
    try:
        parts = urlsplit(address)
        if parts.scheme not in SOCKETS:
            return
        with suppress(TypeError), socket.create_connection((parts.hostname, parts.port), TIMEOUT):
            return
    except (OSError, ValueError) as error:
        raise unreachable(given) from error
    raise unreachable(given)
