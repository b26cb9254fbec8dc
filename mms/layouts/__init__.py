"""How particles are spread over a body: a plug-in is a file, called with (solution, exact, dx, ppc, offset)."""
