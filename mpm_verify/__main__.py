"""`python -m mpm_verify`: the command `verify`."""

from mpm_verify.verify.main import run

run()
