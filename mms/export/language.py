"""Language that functions are exported in: how a function is written, and which file holds them all."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from string import Template
from typing import ClassVar

from mpm_verify.mms.export.notation import Notation
from mpm_verify.mms.export.program import Program

TEMPLATES = Path(__file__).absolute().parent / "templates"
WIDTH = 108  # of a line of code, without its indent
LABELS = {
    "body_force": "body force per mass, of the reference position and the time",
    "displacement": "displacement u, of the reference position and the time",
    "velocity": "velocity v, of the reference position and the time",
    "deformation": "deformation gradient F row by row, of the reference position and the time",
    "stress": "Cauchy stress, of the reference position and the time",
    "newton_step": "step of Newton's method from a guessed reference position to that of the current position goal",
}


def filled(name: str, **values: object) -> str:
    """Text of a template with its values."""
    return Template((TEMPLATES / f"{name}.in").read_text(encoding="utf-8")).substitute(values)


@dataclass(frozen=True)
class Heading:
    """Values that every file of a case has: title, dimension, extent of the body, components of a stress.

    `listed` are the components of a deformation gradient where they are no square matrix, row by row.
    """

    title: str
    dimension: int
    width: float
    stress: str
    listed: tuple[str, ...] = ()

    def values(self) -> dict[str, object]:
        """Values by their names in templates."""
        named, shape = f"as {', '.join(self.listed)}", f"{len(self.listed)}), {', '.join(self.listed)}"
        return {"title": self.title, "dimension": self.dimension, "width": repr(self.width),
                "stress_components": self.stress, "gradient": named if self.listed else "row by row",
                "gradient_shape": shape if self.listed else f"{self.dimension}, {self.dimension})"}  # fmt: skip


class Language:
    """Language with arrays of components; a subclass says what differs.

    Attributes
    ----------
    file
        File of the export, and of the template.
    notation
        Notation of expressions.
    indent
        Spaces before a statement.
    opening, closing
        Patterns of the lines around the statements of a function.
    read, assign, give
        Patterns of a statement: a component of an argument, a subexpression, a component of the result.
    first
        Index of the first component.
    goes_on
        End of a line that goes on in the next one.
    """

    file: ClassVar[str]
    notation: ClassVar[Notation]
    indent: ClassVar[int] = 4
    opening: ClassVar[str]
    closing: ClassVar[str] = "}\n"
    read: ClassVar[str] = "const double {name} = {array}[{index}];"
    assign: ClassVar[str] = "const double {name} = {text};"
    give: ClassVar[str] = "values[{index}] = {text};"
    argument: ClassVar[str] = "const double {array}[{size}], "
    first: ClassVar[int] = 0
    goes_on: ClassVar[str] = ""

    def files(self, programs: Sequence[Program], heading: Heading) -> dict[str, str]:
        """Texts of the files by their names."""
        functions = "\n".join(map(self.function, programs))
        return {self.file: filled(self.file, functions=functions, **heading.values())}

    def function(self, program: Program) -> str:
        """Text of one function."""
        opening = self.opening.format(
            label=LABELS[program.name], name=program.name, size=len(program.results), arguments=self.arguments(program)
        )
        return opening + self.lines(self.statements(program)) + self.closing

    def arguments(self, program: Program) -> str:
        """Arguments that are arrays, as they are declared."""
        return "".join(self.argument.format(array=name, size=len(parts)) for name, parts in program.inputs.items())

    def statements(self, program: Program) -> list[str]:
        """Statements of a function: components of its arguments that it reads, subexpressions, results."""
        return [*self.unpacked(program), *self.assigned(program), *self.given(program)]

    def unpacked(self, program: Program) -> list[str]:
        """Statements that read the components of the arguments."""
        return [
            self.read.format(name=symbol, array=name, index=k + self.first)
            for name, symbols in program.inputs.items()
            for k, symbol in enumerate(symbols)
            if symbol in program.used
        ]

    def assigned(self, program: Program) -> list[str]:
        """Statements that give subexpressions their names."""
        return [self.assign.format(name=name, text=self.notation(e)) for name, e in program.statements]

    def given(self, program: Program) -> list[str]:
        """Statements that give the results."""
        texts = map(self.notation, program.results)
        return [self.give.format(index=k + self.first, text=text) for k, text in enumerate(texts)]

    def lines(self, statements: Sequence[str]) -> str:
        """Lines of the statements, indented, long ones broken after a plus or minus."""
        return "".join(self.broken(statement) for statement in statements)

    def broken(self, statement: str) -> str:
        """Line of a statement, or lines where it is long."""
        space, rest, found = " " * self.indent, statement, []
        while len(rest) > WIDTH:
            cut = max(rest.rfind(" + ", 0, WIDTH), rest.rfind(" - ", 0, WIDTH))
            if cut < 0:
                break
            found.append(rest[: cut + 2] + self.goes_on)
            rest = "    " + rest[cut + 3 :]
        return "".join(f"{space}{line}\n" for line in [*found, rest])
