"""What the store keeps of this case: the Study and the Result of the harness."""

from mpm_verify.cases.harness.study import Result, Study

RECORDS = Study, Result
