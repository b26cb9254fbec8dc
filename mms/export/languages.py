"""Languages that functions are exported in: how a function is written, and which file holds them all."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from string import Template
from typing import ClassVar

from mpm_verify.mms.export.notation import KNOWN, Notation
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
NUMPY = {name: f"np.{name}" for name in KNOWN} | {f"a{name}": f"np.arc{name}" for name in ("sin", "cos", "tan")}


def filled(name: str, **values: object) -> str:
    """Text of a template with its values."""
    return Template((TEMPLATES / f"{name}.in").read_text(encoding="utf-8")).substitute(values)


@dataclass(frozen=True)
class Heading:
    """Values that every file of a case has: title, dimension, extent of the body, components of a stress."""

    title: str
    dimension: int
    width: float
    stress: str

    def values(self) -> dict[str, object]:
        """Values by their names in templates."""
        return {"title": self.title, "dimension": self.dimension, "width": repr(self.width),
                "stress_components": self.stress}  # fmt: skip


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


class C(Language):
    """C99 header, which is C++ too."""

    file = "body_force.h"
    notation = Notation()
    opening = "/* {label} */\nstatic inline void mms_{name}({arguments}double t, double values[{size}])\n{{\n"


class Cpp(Language):
    """C++ header: templates of the floating-point type."""

    file = "body_force.hpp"
    notation = Notation("Real({})", power="std::pow({}, {})", functions={name: f"std::{name}" for name in KNOWN})
    opening = "// {label}\ntemplate <class Real>\ninline void {name}({arguments}Real t, Real values[{size}])\n{{\n"
    read = "const Real {name} = {array}[{index}];"
    assign = "const Real {name} = {text};"
    argument = "const Real {array}[{size}], "


class Cuda(Language):
    """Device functions for CUDA and Warp, float or double by a macro; C++ without either."""

    file = "body_force.cuh"
    notation = Notation("MMS_REAL({})", power="pow({}, {})")
    opening = "// {label}\nMMS_DEVICE void mms_{name}({arguments}MMS_REAL t, MMS_REAL values[{size}])\n{{\n"
    read = "const MMS_REAL {name} = {array}[{index}];"
    assign = "const MMS_REAL {name} = {text};"
    argument = "const MMS_REAL {array}[{size}], "


class Fortran(Language):
    """Fortran 2008 module."""

    file = "body_force.f90"
    notation = Notation("{}_dp", power="{}**{}")
    indent = 6
    opening = "   ! {label}\n   subroutine {name}({names}t, values)\n{declared}"
    closing = "   end subroutine\n"
    read = "{name} = {array}({index})"
    assign = "{name} = {text}"
    give = "values({index}) = {text}"
    first = 1
    goes_on = " &"

    def function(self, program: Program) -> str:
        """Text of one subroutine, its variables declared."""
        names = [str(s) for s in (*(s for parts in program.inputs.values() for s in parts if s in program.used),
                                  *(name for name, _ in program.statements))]  # fmt: skip
        arrays = ", ".join([*(f"{name}({len(parts)})" for name, parts in program.inputs.items()), "t"])
        declared = [f"real(dp), intent(in) :: {arrays}", f"real(dp), intent(out) :: values({len(program.results)})"]
        declared += [f"real(dp) :: {', '.join(names[k : k + 10])}" for k in range(0, len(names), 10)]
        opening = self.opening.format(
            label=LABELS[program.name], name=program.name, declared=self.lines(declared),
            names="".join(f"{name}, " for name in program.inputs),
        )  # fmt: skip
        return opening + self.lines(self.statements(program)) + self.closing


class Python(Language):
    """Python module with NumPy."""

    file = "body_force.py"
    notation = Notation(power="{}**{}", functions=NUMPY)
    opening = 'def {name}({arguments}t):\n    """{label}"""\n'
    closing = "\n"
    read = "{name} = np.asarray({array}, dtype=float)[..., {index}]"
    assign = "{name} = {text}"
    argument = "{array}, "
    goes_on = " \\"

    def given(self, program: Program) -> list[str]:
        """Statement that returns the results as one array."""
        results = [f"r{k} = {self.notation(e)}" for k, e in enumerate(program.results)]
        names = ", ".join(f"r{k}" for k in range(len(results)))
        return [*results, f"return _stack([{names}], position, {program.shape})"]


class Julia(Language):
    """Julia module."""

    file = "body_force.jl"
    notation = Notation(power="{}^{}")
    opening = "# {label}\nfunction {name}({arguments}t)\n"
    closing = "end\n"
    read = "{name} = {array}[{index}]"
    assign = "{name} = {text}"
    argument = "{array}, "
    give = "r{index} = {text}"
    first = 1

    def given(self, program: Program) -> list[str]:
        """Statements that return the results as a tuple."""
        names = ", ".join(f"r{k + 1}" for k in range(len(program.results)))
        return [*super().given(program), f"return ({names})"]


class Octave(Language):
    """MATLAB and Octave: a file for each function, of positions in rows and a time or a column of times."""

    file = "octave"
    notation = Notation(times=".*", over="./", power="{}.^{}")
    indent = 0
    opening = "function values = {name}({arguments}t)\n% {label}\n"
    closing = "end\n"
    read = "{name} = {array}(:, {index});"
    assign = "{name} = {text};"
    argument = "{array}, "
    give = "values(:, {index}) = {text};"
    first = 1
    goes_on = " ..."
    fixed: ClassVar[tuple[str, ...]] = ("reference_position", "body_force_at")

    def files(self, programs: Sequence[Program], heading: Heading) -> dict[str, str]:
        """Texts of the files by their names, in a folder of their own."""
        made = {f"{self.file}/{program.name}.m": self.function(program) for program in programs}
        return made | {f"{self.file}/{name}.m": filled(f"{name}.m", **heading.values()) for name in self.fixed}

    def given(self, program: Program) -> list[str]:
        """Statements that give the results, room for all rows first."""
        return [f"values = zeros(size(position, 1), {len(program.results)});", *super().given(program)]


class Infix(Language):
    """Assignments for parsers of expressions, in X, Y and t: no sign in front, no power of a small whole number."""

    file = "body_force_infix.txt"
    notation = Notation(power="{}^{}", minus="0 - ")
    names: ClassVar[tuple[str, ...]] = ("body_force",)

    def files(self, programs: Sequence[Program], heading: Heading) -> dict[str, str]:
        """Text of the file: a line for each assignment, the components of the force last."""
        lines = []
        for program in (program for program in programs if program.name in self.names):
            lines += [f"{name} = {self.notation(e)}\n" for name, e in program.statements]
            lines += [f"b{axis} = {self.notation(e)}\n" for axis, e in zip("xyz", program.results, strict=False)]
        return {self.file: "".join(lines)}


LANGUAGES: dict[str, Language] = {
    "c": C(), "cpp": Cpp(), "cuda": Cuda(), "fortran": Fortran(), "python": Python(), "julia": Julia(),
    "octave": Octave(), "infix": Infix(),
}  # fmt: skip
