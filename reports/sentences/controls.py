"""Negative controls of a study in words: what was spoilt, and what passed all the same."""

from collections.abc import Sequence

from mpm_verify.cases.harness.controls import FEW, NARROW, OFF, PART, Control, ControlCode
from mpm_verify.reports import words

NAMES = {
    ControlCode.LEAK: f"an error of one order less, {words.percent(PART, 0)} of the finest",
    ControlCode.FLOOR: f"a floor, {words.percent(PART, 0)} of the finest error",
    ControlCode.BAND: f"an order {OFF:g} higher, in a band of ±{NARROW:g}",
    ControlCode.NORM: "another norm, half an order higher",
    ControlCode.RECORDED: "errors above the recorded ones",
    ControlCode.FEW_LEVELS: f"the finest {FEW} levels alone",
    ControlCode.LEVEL_MISSING: "the finest level but one left out",
    ControlCode.TIME_STEP: "another error with half the time step",
    ControlCode.CONVERGENCE: "clean second order where none is expected",
}


def name(control: Control) -> str:
    """Phrase on what was spoilt."""
    return NAMES[control.code]


def count(controls: Sequence[Control]) -> str:
    """Count such as `refused 7 of 7`."""
    return f"refused {sum(one.refused for one in controls)} of {len(controls)}"


def sentence(controls: Sequence[Control]) -> str:
    """Sentence on all of them; empty where nothing passed that could be spoilt."""
    if not controls:
        return ""
    passed = "; ".join(name(one) for one in controls if not one.refused)
    loose = f"; NOT refused: {passed}. What passes here says less" if passed else ""
    return f"Negative controls, the same results spoilt: {count(controls)}{loose}."
