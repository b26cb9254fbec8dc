"""Notes of a run on its way in words: what became of a checkpoint."""

from collections.abc import Sequence

from mpm_verify.cases.harness.checkpoint import Note, NoteCode

NOTES = {
    NoteCode.GOES_ON: "{file}: the run goes on from step {step:.0f}",
    NoteCode.DAMAGED: "{file} is damaged and not used; the run begins anew, and {moved} can be deleted",
    NoteCode.FOREIGN: "{file} is of another run or of other sources and not used; the run begins anew, and the file is "
    "now {moved}",
    NoteCode.ELSEWHERE: "{file} was written by another processor or other versions of Python, NumPy, SciPy or Numba, "
    "which give other bits, and is not used; the run begins anew, and the file is now {moved}",
    NoteCode.NOT_WRITTEN: "{file} cannot be written, for want of room perhaps; the run goes on without",
}


def note(note: Note) -> str:
    """Note as a line."""
    return NOTES[note.code].format(file=note.file, moved=note.moved, **note.numbers)


def abandoned(files: Sequence[str]) -> str:
    """Line on checkpoints of no run of the study; empty where there are none."""
    if not files:
        return ""
    one = len(files) == 1
    return (
        f"{', '.join(files)} {'belongs' if one else 'belong'} to no run of this study, perhaps because sources have "
        f"changed, and {'is' if one else 'are'} not used; delete {'it' if one else 'them'} if nobody needs "
        f"{'it' if one else 'them'}"
    )
