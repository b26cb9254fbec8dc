"""Stopwatch of a run: the wall and processor time and the memory that it took."""

import time
from typing import Any

from mpm_verify.cases.harness.environment import environment
from mpm_verify.cases.harness.memory import forget_peak, peak_memory


class Stopwatch:
    """Wall and processor time since the start, largest memory since it was made."""

    def __init__(self) -> None:
        forget_peak()
        self.start()

    def start(self) -> None:
        """Begin to count time anew."""
        self.begun, self.used = time.perf_counter(), time.process_time()

    @property
    def spent(self) -> tuple[float, float, float]:
        """Wall and processor time in s, and largest memory in MB."""
        return time.perf_counter() - self.begun, time.process_time() - self.used, peak_memory()

    def told(self) -> dict[str, Any]:
        """Fields of a Result: what the run took, and the environment in which it did."""
        wall, cpu, peak = self.spent
        return {"wall_s": wall, "cpu_s": cpu, "peak_memory_mb": peak, "environment": environment()}
