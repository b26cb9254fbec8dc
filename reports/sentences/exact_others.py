"""Words on the exactness battery of a solver of somebody else: what each test holds, and what it points to."""

from mpm_verify.cases.exact.others.names import Cause, Left

HEADINGS = {
    "rigid": "Bodies that move without strain",
    "affine": "One step of a strained body",
    "path": "Stress along a path of F",
}
HELD = {
    "translate": "a body without forces moves on through the cells: x, v, and F = I, σ = 0",
    "throw": "free fall and throw under a constant force",
    "throw_growing": "free fall under a force that grows in time",
    "sums": "a strained, shaken body: its centre of mass falls freely; σ and V are those of the F that is written",
    "keep": "no force: each particle keeps a velocity of its own for a step",
    "rest": "a uniform stress at rest: nothing moves inside",
    "affine_unstrained": "an affine velocity from F = I: x, v, F = I + dt grad v, and its σ",
    "affine_strained": "an affine velocity from a sheared and turned F: x, v, (I + dt grad v) F, and its σ",
    "turn": "a rigid turn of a strained body under its centripetal force",
    "force": "a force that is affine in X, of a strained body",
    "divergence_x": "a stress that is affine in x accelerates all particles alike",
    "divergence_y": "a stress that is affine in y accelerates all particles alike",
    "path_shear": "σ, zz too, one step from a shear of 0.6",
    "path_press": "σ, zz too, one step from a turned compression, det F = 0.67",
    "path_stretch": "σ, zz too, one step from a turned extension, det F = 1.55",
}
PARTS = {
    Cause.OWN_TIME: "dt, the number of steps, which step is written, or the update of x",
    Cause.OWN_FORCE: "the body force (sign, size, time level, taken at X), or the level of v at the start",
    Cause.OWN_SUMS: "the sums over the nodes, weights whose gradients do not add to nothing, damping, or nodes that "
    "are left out or held",
    Cause.OWN_FLIP: "the fraction of FLIP, or a damping; for PIC, APIC and blends give --flip no",
    Cause.OWN_INNER: "the forces of the stress at the nodes: volume, units, sign",
    Cause.OWN_GRADIENT: "the gradient of the velocity and the update of F: order of factors, transpose, how often",
    Cause.OWN_STRESS: "the stress of the constitutive model: constants, sign, plane strain, and the F that it is of",
    Cause.OWN_VOLUME: "the volume that is written: V0 det F",
    Cause.OWN_NUMBERS: "the numbers of the particles: X is not that of the id",
}
REASONS = {
    Left.NO_COLUMN: "the answer has no such column",
    Left.LEVEL: "it is exact on another time level than that of the answer, or is not known",
    Left.STRESS_FIRST: "a stress that is updated first acts in the first step",
    Left.NO_FLIP: "--flip no was given",
    Left.NOT_AFFINE: "the stress of this material is not affine in such states",
}
