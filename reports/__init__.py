"""Stored results -> tables, figures and one HTML page; never runs a solver."""
