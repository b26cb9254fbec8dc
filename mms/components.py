"""Names of coordinates, and of the components of a stress by their number."""

AXES = "xyz"
COMPONENTS = {2: ("xx", "yy", "zz", "xy"), 3: ("xx", "yy", "zz", "xy", "yz", "xz")}
