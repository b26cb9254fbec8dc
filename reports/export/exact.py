"""Exactness battery as JSON, what any study of Examinations has."""

from mpm_verify.reports.export.examined import more

__all__ = ["more"]
