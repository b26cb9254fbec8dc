"""Tiny solver of `verify example python toy` with F advanced without the spin of L: python symmetric.py CASE OUT."""

import runpy
import sys
from pathlib import Path

TINY = Path(__file__).resolve().parents[3] / "cases/mms/external/examples/python/solver.py.in"
RIGHT = 'F = F + dt * np.einsum("pka,pkb->pab", velocity[i], dN) @ F\n'
SYMMETRIC = """L = np.einsum("pka,pkb->pab", velocity[i], dN)
    D, W = (L + L.transpose(0, 2, 1)) / 2, (L - L.transpose(0, 2, 1)) / 2
    F = F + dt * (D + dt * (D @ W - W @ D)) @ F
"""
text = TINY.read_text(encoding="utf-8")
assert text.count(RIGHT) == 1, "the tiny solver has changed"
changed = Path(sys.argv[2]) / "symmetric_solver.py"
changed.write_text(text.replace(RIGHT, SYMMETRIC), encoding="utf-8")
sys.argv[0] = str(changed)
runpy.run_path(str(changed), run_name="__main__")
