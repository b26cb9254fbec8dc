"""Table in LaTeX for a paper, with the rules of the package booktabs; numbers as they are printed there."""

import re
from collections.abc import Sequence

NUMBER = re.compile(r"([\N{MINUS SIGN}-]?)(\d+(?:\.\d+)?)e([\N{MINUS SIGN}-]?\d+)")
SIGNS = {
    "\\": r"\textbackslash{}", "&": r"\&", "%": r"\%", "$": r"\$", "#": r"\#", "_": r"\_", "{": r"\{", "}": r"\}",
    "~": r"\textasciitilde{}", "^": r"\textasciicircum{}", "<": "$<$", ">": "$>$", "|": "$|$",
    "\N{MINUS SIGN}": "$-$", "\N{EN DASH}": "--", "\N{MULTIPLICATION SIGN}": r"$\times$",
    "\N{PLUS-MINUS SIGN}": r"$\pm$",
    "\N{INFINITY}": r"$\infty$", "\N{RIGHTWARDS ARROW}": r"$\to$", "\N{SQUARE ROOT}": r"$\surd$",
    "\N{DEGREE SIGN}": r"$^\circ$", "\N{LESS-THAN OR EQUAL TO}": r"$\leq$", "\N{GREATER-THAN OR EQUAL TO}": r"$\geq$",
    "\N{SUPERSCRIPT TWO}": "$^2$", "\N{SUPERSCRIPT THREE}": "$^3$",
    "\N{SUBSCRIPT ZERO}": "$_0$", "\N{MIDDLE DOT}": r"$\cdot$",
    "α": r"$\alpha$", "β": r"$\beta$", "γ": r"$\gamma$", "ε": r"$\varepsilon$", "η": r"$\eta$", "θ": r"$\theta$",
    "κ": r"$\kappa$", "λ": r"$\lambda$", "μ": r"$\mu$", "ν": r"$\nu$", "π": r"$\pi$", "ρ": r"$\rho$", "σ": r"$\sigma$",
    "τ": r"$\tau$", "φ": r"$\varphi$", "ψ": r"$\psi$", "Δ": r"$\Delta$", "Σ": r"$\Sigma$",
    "“": "``", "”": "''", "’": "'",
}  # fmt: skip


def booktabs(
    caption: str, head: Sequence[str], rows: Sequence[Sequence[str]], heads: int = 1, texts: Sequence[str] = ()
) -> str:
    """Table environment of LaTeX; what repeats in the first column is written once."""
    kinds = "".join("l" if k < heads or name in texts else "r" for k, name in enumerate(head))
    lines = [r"\begin{table}", rf"\caption{{{text(caption)}}}", rf"\begin{{tabular}}{{{kinds}}}", r"\toprule"]
    lines += [line(head), r"\midrule"]
    before = ""
    for row in rows:
        first = row[0] if heads and row[0] == before else None
        lines.append(line(row if first is None else ("", *row[1:])))
        before = row[0]
    return "\n".join([*lines, r"\bottomrule", r"\end{tabular}", r"\end{table}", ""])


def line(row: Sequence[str]) -> str:
    """Row of a tabular environment."""
    return " & ".join(map(text, row)) + r" \\"


def text(cell: str) -> str:
    """Cell in LaTeX: powers of ten as in print, and what LaTeX would take for its own escaped."""
    found = NUMBER.fullmatch(cell)
    if found:
        sign, digits, exponent = found.groups()
        return rf"${'-' * bool(sign)}{digits}\times10^{{{int(exponent.replace(chr(0x2212), '-'))}}}$"
    return "".join(SIGNS.get(sign, sign) for sign in cell)
