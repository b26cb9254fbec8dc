"""Words of benchmarks: the statement of a problem, which is the docstring of its file."""

from inspect import cleandoc, getmodule

from mpm_verify.cases.benchmark.problem import Problem


def statement(problem: Problem) -> list[str]:
    """Statement of a problem: its paragraphs and formulas, and where it is published."""
    blocks = cleandoc(getattr(getmodule(type(problem)), "__doc__", "") or "").split("\n\n")
    texts: list[str] = []
    for block in blocks:
        formula = all(line.startswith("    ") for line in block.splitlines())
        texts += [line.strip() for line in block.splitlines()] if formula else [" ".join(block.split())]
    return [*texts, *([f"Source: {problem.source}."] if problem.source else [])]
