"""Words of a campaign of planted defects: the certificate as pages quote it, kinds, and what was not noticed."""

from mpm_verify.cases.detect.certificate import Certificate, stored
from mpm_verify.cases.detect.rates import Rate, Row

KINDS = {
    "order": "order of accuracy",
    "robustness": "robustness",
    "judge": "judge and report",
    "placebo": "placebo",
    "all": "all",
    "listed": "from the lists that were there before",
    "not listed": "not from them",
    "mms --quick and exact": "noticed by verify mms --quick and verify exact alone",
    "as FAIL": "of those noticed, with a FAIL",
}
MAKERS = {
    "constant": "a wrong constant",
    "formula": "a wrong formula",
    "index": "a wrong index",
    "physics": "wrong physics",
    "port": "a port from another code",
    "refactoring": "a refactoring",
    "time": "a wrong time level",
}
FEW = 4  # names in a sentence


def quoted() -> str:
    """Sentence of the stored certificate for a page; empty where there is none."""
    found = stored()
    return quote(found) if found else ""


def quote(found: Certificate) -> str:
    """Sentence on a campaign, what it noticed and when: `Checks like these noticed 146 of 150 planted mistakes ...`."""
    missed = found.missed[:FEW] + [f"{len(found.missed) - FEW} more"] * (len(found.missed) > FEW)
    rest = f"; not: {', '.join(missed)}" if missed else ""
    part = f" ({found.done} of {found.copies} copies)" if found.done < found.copies else ""
    state = "" if found.current else ", of an earlier state of the code"
    return (
        f"Checks like these noticed {found.noticed} of {found.planted} planted mistakes ({', '.join(found.methods)})"
        f"{rest}. {found.alarms} of {found.placebos} placebos raised an alarm. Campaign of {found.date}{part}, "
        f"examined {found.examined}{state}; verify detect repeats it."
    )


def name(rate: Rate) -> str:
    """Name of a rate."""
    return KINDS.get(rate.name) or MAKERS.get(rate.name) or rate.name


def said(row: Row) -> str:
    """Words for what noticed a defect, or why nothing did."""
    if row.equivalent:
        return f"nothing can see it: {row.equivalent}" + (
            f"; noticed by {', '.join(row.changed)}" if row.changed else ""
        )
    if not row.changed:
        return "not noticed"
    return f"{', '.join(f'{check} {outcome}' for check, outcome in row.changed.items())}" + (
        f" ({row.evidence})" if row.evidence else ""
    )
