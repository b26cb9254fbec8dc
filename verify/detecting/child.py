"""Entry of a child: ask each check of a package that may be planted, and write a line for each as it is done."""

import json
import time
from pathlib import Path
from typing import Any


def main(request: dict[str, Any]) -> None:
    """Ask the checks of a request, see cases/detect/server.py; what one raises is its answer."""
    from mpm_verify.verify.detecting.checks import CHECKS, Subject

    subject = Subject(request["method"], Path(request["sound"]), Path(request["work"]), bool(request["keep"]))
    with Path(request["answers"]).open("a", encoding="utf-8") as file:
        for name in request["checks"]:
            started = time.process_time()
            try:
                outcome, evidence = CHECKS[name](subject)
            except Exception as error:
                outcome, evidence = "ERROR", f"{type(error).__name__}: {str(error)[:120]}"
            line = {"check": name, "outcome": outcome, "evidence": evidence, "seconds": time.process_time() - started}
            file.write(json.dumps(line) + "\n")
            file.flush()
