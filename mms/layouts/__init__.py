"""Layouts of particles over a body: a plug-in is a file, called with (solution, exact, dx, ppc, offset)."""
