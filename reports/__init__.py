"""Tables, figures and one HTML page from stored results; never runs a solver."""
