"""A process that knows the libraries and nothing of ours: it forks a child for each planted copy, and watches it.

It is executed as a program, so that mpm_verify is imported by the child alone, from the copy. To load NumPy, Numba,
SymPy and pandas takes three seconds, a fork a hundredth of one. One thread computes: a fork of more would hang.

A request is a line of JSON on standard input: `copy` (folder that holds mpm_verify), `entry` (module with
`main(request)`), `answers` (file of the child's lines), `log`, `seconds`, `megabytes`, and what the entry wants. The
answer is a line with `ended`: "" for an end by itself, "hang", or "crash" with `signal`.
"""

import ctypes
import json
import os
import resource
import signal
import sys
import time
from importlib import import_module

LIBRARIES = (
    "numpy",
    "scipy.optimize",
    "scipy.stats",
    "numba",
    "sympy",
    "mpmath",
    "pydantic",
    "pandas",
    "jinja2",
    "matplotlib.figure",
    "meshio",
    "rich.table",
    "typer",
)
PAUSE = 0.02  # seconds
MEGABYTE = 2**20
WAITS = 10  # times its processor time that a child may take on a busy machine
PARENT_ENDS = 1  # PR_SET_PDEATHSIG of Linux: a child ends with the server, however that ends


def child(request: dict) -> None:  # type: ignore[type-arg]
    """Become the child: limits, the copy first on Python's path, and its entry."""
    os.setsid()
    ctypes.CDLL(None).prctl(PARENT_ENDS, signal.SIGKILL)
    resource.setrlimit(resource.RLIMIT_CPU, (request["seconds"], request["seconds"] + 5))
    os.dup2(os.open(os.devnull, os.O_RDONLY), 0)
    log = os.open(request["log"], os.O_WRONLY | os.O_CREAT | os.O_TRUNC)
    os.dup2(log, 1)
    os.dup2(log, 2)
    room = request["megabytes"] * MEGABYTE
    resource.setrlimit(resource.RLIMIT_AS, (room, room))
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
    sys.dont_write_bytecode = True
    sys.path.insert(0, request["copy"])
    one_thread()
    module = import_module(request["entry"])
    if not os.path.abspath(module.__file__ or "").startswith(os.path.abspath(request["copy"]) + os.sep):
        raise RuntimeError(f"{module.__file__} is not in the copy")
    module.main(request)


def one_thread() -> None:
    """Let Numba compile loops for one thread: half of the time that it takes, and the same bits."""
    import numba

    compiled = numba.njit

    def serial(*given, **options):  # type: ignore[no-untyped-def]
        return compiled(*given, **{**options, "parallel": False})

    numba.njit = serial


def watched(pid: int, seconds: float, parent: int) -> dict[str, object]:
    """Wait for a child, and end it with all that it started when its time is over or nobody is left to hear of it.

    `seconds` are of its processor, so that a busy machine makes no catch.
    """
    until = time.monotonic() + WAITS * seconds
    while True:
        done, status, used = os.wait4(pid, os.WNOHANG)
        if done:
            code = os.waitstatus_to_exitcode(status)
            cpu = used.ru_utime + used.ru_stime
            ended = "hang" if code == -signal.SIGXCPU else "crash" if code else ""
            return {"ended": ended, "code": code, "cpu": cpu}
        late, alone = time.monotonic() > until, os.getppid() != parent
        if late or alone:
            os.killpg(pid, signal.SIGKILL)
            _, _, used = os.wait4(pid, 0)
            if alone:
                os._exit(1)
            return {"ended": "hang", "code": 0, "cpu": used.ru_utime + used.ru_stime}
        time.sleep(PAUSE)


def serve() -> None:
    """Answer requests until there are no more."""
    parent = os.getppid()
    for name in LIBRARIES:
        import_module(name)
    for line in sys.stdin:
        request = json.loads(line)
        pid = os.fork()
        if not pid:
            code = 1
            try:
                child(request)
                code = 0
            except BaseException:
                import traceback

                traceback.print_exc()
            finally:
                sys.stdout.flush()
                sys.stderr.flush()
                os._exit(code)
        print(json.dumps(watched(pid, request["seconds"], parent)), flush=True)


if __name__ == "__main__":
    serve()
