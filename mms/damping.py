"""Local damping inside a manufactured problem: the body force with which damped motion is the exact one.

At each node the damping takes a fraction alpha of the unbalanced force f against the velocity, component by component:
m a = f - alpha |f| sign(v), see solver/damping.py. As alpha < 1, a has the sign of f, and so f = m a / (1 - alpha s)
with s = sign(a v). In the limit of small cells and steps this asks for the body force per mass

    b = a / (1 - alpha sign(a v)) - Div P / rho0      in each component, v at the time level that the step has it at

b is as smooth as the motion where a passes zero, and jumps by 2 alpha a / (1 - alpha^2) where the motion turns, v = 0.
A step whose v is that of the wrong side has an error of this size, so v has to be that of half a step earlier.
"""

from dataclasses import replace

import sympy as sp

from mpm_verify.mms.derive import Fields, fractions, inner_symbol


def damped(fields: Fields, alpha: float, t_velocity: sp.Expr, exact: bool = False) -> Fields:
    """Fields of the same motion with the body force that local damping needs.

    Parameters
    ----------
    fields
        Expressions of a motion without damping.
    alpha
        Fraction of the unbalanced force, from 0 to below 1.
    t_velocity
        Time level of the velocity against which the force of time t is damped: a symbol, or t less half a step.
    exact
        Whether alpha becomes the fraction that it is.

    Returns
    -------
    Fields
        With another b, and with the velocity at `t_velocity` among the inner symbols.
    """
    inner, b = dict(fields.inner), []
    fraction = fractions(alpha) if exact else sp.Float(alpha)
    for X, v, force in zip(fields.X, fields.v, fields.b, strict=True):
        a = sp.Symbol(f"a{X}", real=True)
        if inner[a] == 0:  # nothing moves in this direction
            b.append(force)
            continue
        before = inner_symbol(inner, v.xreplace({fields.t: t_velocity}), f"before_v{X}")
        s = sp.sign(a) * sp.sign(before)
        b.append(force + a * fraction * s / (1 - fraction * s))
    return replace(fields, inner=inner, b=b)
