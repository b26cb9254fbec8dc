"""Numbers as sentences have them: two digits, and no more exponents than are needed."""


def figure(value: float) -> str:
    """Number with two digits, and no exponent but for small numbers."""
    if abs(value) < 1e-12:
        return "0"
    return f"{float(f'{value:.2g}'):.0f}" if abs(value) >= 10 else f"{value:.2g}"


def percent(part: float) -> str:
    """Fraction as per cent: 0 %, 3.1 %, 160 %."""
    return f"{figure(100 * part)} %"


def span(low: float, high: float) -> str:
    """Span such as `1.98 to 2.03`, or `2.00` where both are written alike."""
    ends = f"{low:.2f}", f"{high:.2f}"
    return ends[0] if ends[0] == ends[1] else " to ".join(ends)
