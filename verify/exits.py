"""Exit codes beside 0 pass, 1 fail, 3 inconclusive or nothing judged."""

USAGE, DEFECT, STOPPED = 2, 4, 130
