"""Time levels that a case gives another solver, by force: to find those that its step needs."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace

from mpm_verify.mms.derive import Fields
from mpm_verify.solver.state import Floats


@dataclass(frozen=True)
class Start:
    """Time levels: v at -dt/2 (half) or 0 (zero), F and sigma at 0 (now) or -dt (before), b of a step (start, end)."""

    v: str
    F: str
    b: str

    def particles(self, columns: Mapping[str, Floats]) -> dict[str, Floats]:
        """Columns of the particles in which each field has one level, under all its names."""
        found = dict(columns)
        for name in columns:
            plain, half, before = name.split("_")[0], f"{name}_half", f"{name}_before"
            if half in columns:
                found[name] = found[half] = columns[half if self.v == "half" else plain]
            if before in columns:
                found[name] = found[before] = columns[before if self.F == "before" else plain]
        return found

    def fields(self, fields: Fields, dt: float) -> Fields:
        """Fields whose time is that of the body force, dt later where it is that of the end of a step."""
        if self.b == "start":
            return fields
        later = {fields.t: fields.t + dt}
        inner = {symbol: e.xreplace(later) for symbol, e in fields.inner.items()}
        return replace(fields, inner=inner, b=[e.xreplace(later) for e in fields.b])

    def force(self, force: Callable[[Floats, float], Floats], dt: float) -> Callable[[Floats, float], Floats]:
        """Body force as a function of the time of a step's start."""
        return force if self.b == "start" else lambda X, t: force(X, t + dt)


def named(text: str) -> Start | None:
    """Start of a name such as half.now.start; None of the empty one: the case as it is."""
    return Start(*text.split(".")) if text else None
