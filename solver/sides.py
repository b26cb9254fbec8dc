"""Names of the sides of a body: number // 2 is the axis of the normal, number % 2 the lower or the upper one."""

SIDES = ("left", "right", "bottom", "top")
SOLID_SIDES = (*SIDES, "back", "front")
