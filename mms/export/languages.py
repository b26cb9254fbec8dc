"""Languages that functions are exported in."""

from collections.abc import Sequence
from typing import ClassVar

from mpm_verify.mms.export.language import LABELS, Heading, Language, filled
from mpm_verify.mms.export.notation import KNOWN, Notation
from mpm_verify.mms.export.program import Program

NUMPY = {name: f"np.{name}" for name in KNOWN} | {f"a{name}": f"np.arc{name}" for name in ("sin", "cos", "tan")}


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
        return [*super().given(program), f"return ({names}{',' * (len(program.results) == 1)})"]


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
