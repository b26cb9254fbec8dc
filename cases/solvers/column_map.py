"""Map of the columns of an answer: which columns of which files are meant, in a TOML file that --columns names.

Its content is a parameter of a run, as text, so that another map is another run and a moved file is the same.
"""

import json
import tomllib
from functools import cache
from importlib.util import find_spec
from pathlib import Path, PurePath
from string import Formatter
from typing import Annotated, Any, Literal, get_args

from pydantic import AfterValidator, BaseModel, BeforeValidator, ConfigDict, Field, ValidationError, model_validator

from mpm_verify.cases.harness.invalid import invalid
from mpm_verify.cases.solvers.components import QUANTITIES
from mpm_verify.cases.solvers.levels import FARTHEST, USUAL, Levels
from mpm_verify.solver.plugins import meant

Format = Literal["text", "npz", "mesh", "pvd", "hdf5", "lammps"]
FORMATS: dict[str, Format] = {
    ".csv": "text", ".tsv": "text", ".txt": "text", ".dat": "text", ".npz": "npz", ".vtu": "mesh", ".vtk": "mesh",
    ".pvd": "pvd", ".h5": "hdf5", ".hdf5": "hdf5", ".lammps": "lammps", ".lammpstrj": "lammps", ".dump": "lammps",
}  # fmt: skip
NUMBERS = {"step": 1, "time": 0.5, "index": 1}  # what a name of a file may hold, with an example of each
NUMBERED = ("pvd", "lammps")  # formats whose files say which frame is which
KEEPS = "row"  # id of rows in the order of the particles
NAMES = ("id", *dict.fromkeys(name for d in (2, 3, 1) for q, parts in QUANTITIES[d].items() for name in (q, *parts)))


def lag(value: float) -> float:
    """Steps that a field is behind x. Raises ValueError."""
    if abs(value) > FARTHEST:
        raise ValueError(f"choose steps from -{FARTHEST:g} to {FARTHEST:g}")
    return value


Lag = Annotated[float, AfterValidator(lag)]
Strict = ConfigDict(extra="forbid", frozen=True, strict=True)


class Column(BaseModel):
    """Column of ours: factor times a column of theirs, plus a number, or plus a reference position `X`, `Y` or `Z`."""

    model_config = Strict
    name: str = Field(alias="from", min_length=1)
    factor: float = 1.0
    add: float | Literal["X", "Y", "Z"] = 0.0


def named(value: Any) -> Any:
    """Column as a table, where only its name is given."""
    return {"from": value} if isinstance(value, str) else value


class ColumnMap(BaseModel):
    """Files of an answer and their columns.

    Parameters
    ----------
    files
        Pattern of the files below {out}: with {step}, {time} or {index} a file a frame; or one file, or several with *,
        that say themselves which frame is which.
    format, key
        Format, usually told by the ending; and the key in an HDF5 file, which may hold {step} too.
    frames, first
        Numbers by which a file, or its `frame_column`, counts frames: steps, times, or outputs from `first` on.
    frame_column
        Column of theirs that says which frame a row is of.
    F_order, sigma_order
        Order of an array of F, row or column first; components of an array of sigma, such as xx, yy, zz, xy.
    v_lag, F_lag
        Steps that v, and F with sigma, are behind x, where result.json does not say.
    columns
        Columns by our names.
    """

    model_config = Strict
    files: str
    format: Format = "text"
    key: str = ""
    frames: Literal["step", "time", "index"] = "step"
    first: Literal[0, 1] = 0
    frame_column: str = ""
    F_order: Literal["row", "column"] = "row"
    sigma_order: Annotated[tuple[Literal["xx", "yy", "zz", "xy", "yz", "xz"], ...], Field(strict=False)] = ()
    v_lag: Lag | None = None
    F_lag: Lag | None = None
    columns: dict[str, Annotated[Column, BeforeValidator(named)]]

    @model_validator(mode="before")
    @classmethod
    def usual(cls, content: Any) -> Any:
        """Content with what is left out; refuses names that a map does not have."""
        known(content, tuple(cls.model_fields), "the map")
        files = content.get("files")
        if not isinstance(files, str) or not isinstance(content.get("columns"), dict):
            raise ValueError('it needs files = "out_{step}.csv" and a table [columns] of our names')
        known(content["columns"], NAMES, "[columns]")
        for name, column in content["columns"].items():
            if isinstance(column, dict):
                known(column, ("from", "factor", "add"), f"columns.{name}")
        told = content.get("format") or FORMATS.get(PurePath(files).suffix.lower())
        if told is None:
            raise ValueError(f"files = {files!r} has no known ending; add format, one of {', '.join(get_args(Format))}")
        return {"format": told, "frames": "time" if told == "pvd" else "step", **content}

    @model_validator(mode="after")
    def whole(self) -> "ColumnMap":
        """Refuse a map by which no frame or no particle can be found."""
        check_files(self)
        check_columns(self.columns)
        return self

    @property
    def apart(self) -> bool:
        """Whether each frame has a file or a key of its own."""
        return bool(held(self.files) | held(self.key))

    @property
    def levels(self) -> Levels:
        """Time levels, where result.json does not say."""
        v_lag = USUAL.v_lag if self.v_lag is None else self.v_lag
        return Levels(v_lag, USUAL.F_lag if self.F_lag is None else self.F_lag)


def known(content: Any, allowed: tuple[str, ...], part: str) -> None:
    """Raise ValueError for a key that is not allowed."""
    for key in content if isinstance(content, dict) else ():
        if key not in allowed:
            raise ValueError(f"{part} has {key!r}{meant(key, allowed)}, and may have {', '.join(allowed)}")


def held(text: str) -> set[str]:
    """Names in braces. Raises ValueError for braces that cannot be read."""
    return {name for _, name, _, _ in Formatter().parse(text) if name is not None}


def check_files(given: ColumnMap) -> None:
    """Raise ValueError for files in which no frame can be found."""
    for name, text in (("files", given.files), ("key", given.key)):
        try:
            odd = sorted(held(text) - NUMBERS.keys())
            text.format(**dict.fromkeys(odd, 0), **NUMBERS)
        except (ValueError, IndexError, KeyError) as error:
            raise ValueError(f"{name} = {text!r} cannot be filled in: {str(error).lower()}") from None
        if odd:
            raise ValueError(f"{name} = {text!r} has {{{odd[0]}}}, and may have {{step}}, {{time}} or {{index}}")
    path = PurePath(given.files)
    if path.is_absolute() or ".." in path.parts or not path.parts:
        raise ValueError(
            f"files = {given.files!r} must be below {{out}}; write it as seen from there, dump.{{step}}.csv"
        )
    if given.key and given.format != "hdf5":
        raise ValueError(f"key is for HDF5, and files = {given.files!r} are {given.format}; leave it out")
    if "*" in given.files and held(given.files):
        raise ValueError(f"files = {given.files!r} has * and a number; leave one out")
    if not given.apart and not given.frame_column and given.format not in NUMBERED:
        raise ValueError(f"files = {given.files!r} does not say which frame is which; add {{step}}, or frame_column")
    if given.format == "hdf5" and find_spec("tables") is None:
        raise ValueError("HDF5 is read with the package tables; install it: pip install tables")


def check_columns(columns: dict[str, Column]) -> None:
    """Raise ValueError for columns that name no particle or no position."""
    if "x" not in columns:
        raise ValueError('[columns] has no x, the position; where displacements are written add {add = "X"} to it')
    if not columns.keys() & {"id", "X"}:
        raise ValueError(
            f'[columns] has neither id nor X to tell particles by; id = "{KEEPS}" where rows keep the order of '
            "particles.csv"
        )
    for name, column in columns.items():
        if isinstance(column.add, str) and column.add != name.upper():
            raise ValueError(f"columns.{name}: add = {column.add!r} is for {column.add.lower()}; give a number")


def read(source: str) -> str:
    """Text of a map, the same for all files that say the same, of its file or of such a text. Raises ValueError."""
    name = "the map" if source.startswith("{") else source
    try:
        content = json.loads(source) if source.startswith("{") else tomllib.loads(Path(source).read_text("utf-8-sig"))
        made = ColumnMap.model_validate(content)
    except OSError as error:
        raise ValueError(f"--columns: cannot read {name}: {(error.strerror or str(error)).lower()}") from None
    except ValidationError as error:
        first = error.errors()[0]
        says = invalid(error) if first["loc"] else first["msg"].removeprefix("Value error, ")
        raise ValueError(f"--columns: {name}: {says}") from None
    except ValueError as error:  # of TOML, JSON and of what is no text
        raise ValueError(f"--columns: {name} cannot be read as TOML: {error}") from None
    return json.dumps(made.model_dump(by_alias=True, exclude_unset=True), sort_keys=True)


@cache
def parsed(text: str) -> ColumnMap:
    """Map of such a text."""
    return ColumnMap.model_validate_json(text)
