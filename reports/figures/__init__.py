"""Figures, one a file: each takes a Record and gives matplotlib figures by name, nothing is drawn on a screen."""
