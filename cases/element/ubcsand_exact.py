"""Closed forms of UBCSAND in primary loading, compression positive, contraction positive; s and stresses in Pa.

They take the material for its parameters alone. a = Rf/eta_f, k = Gp(s)/s; c = 0 and s above its floor are assumed.
"""

from math import log

import numpy as np
from scipy.integrate import quad
from scipy.optimize import brentq

from mpm_verify.solver.material.ubcsand import Ubcsand

# Oedometric loading from s = 50 Pa by the material: vertical stress, K0, eta, vertical strain, to the digits given.
# Independent of this solver; Table 2 with the default Rf.
OEDOMETRIC = (
    (100.0, 0.774, 0.128, 0.00058),
    (500.0, 0.595, 0.254, 0.00239),
    (1000.0, 0.563, 0.279, 0.00344),
    (2000.0, 0.542, 0.297, 0.00471),
    (5000.0, 0.523, 0.313, 0.00683),
    (10000.0, 0.514, 0.322, 0.00885),
)
# Constant s, Table 2, default Rf: s, eta, plastic shear strain, plastic volume strain, elastic shear strain.
CONSTANT_S = (
    (1e3, 0.25, 0.00503237, 0.00186561, 0.000628),
    (1e3, 0.50, 0.02486067, 0.00391504, 0.001256),
    (1e3, None, 0.02844853, 0.00393832, 0.001297),
    (5e3, 0.25, 0.01321766, 0.00490007, 0.001018),
    (5e3, 0.50, 0.06529725, 0.01028295, 0.002035),
    (5e3, None, 0.07472084, 0.01034411, 0.002103),
    (1e5, 0.40, 0.19849250, 0.05082919, 0.004000),
    (1e5, None, 0.45087874, 0.06241816, 0.005165),
)
# Drained biaxial compression at 5 kPa: eta, vertical stress, gamma, volume strain, vertical and lateral strain.
BIAXIAL = (
    (0.1, 6111.11111, 0.0044620330, 0.0021346378, 0.0032983354, -0.0011636976),
    (0.2, 7500.00000, 0.0111053749, 0.0046706648, 0.0078880198, -0.0032173550),
    (0.3, 9285.71429, 0.0219048003, 0.0077029197, 0.0148038600, -0.0071009403),
    (0.4, 11666.66667, 0.0420140011, 0.0112389473, 0.0266264742, -0.0153875269),
    (0.5, 15000.00000, 0.0897393120, 0.0144467308, 0.0520930214, -0.0376462906),
)
ETA_AT_TWO_PERCENT = 0.30674886089  # s = 5 kPa, total shear strain 0.02


def hardening(material: Ubcsand, s: float) -> float:
    """Hardening k = Gp/s."""
    return float(material.KGp * (s / material.Pa) ** (material.np - 1))


def plastic_shear(material: Ubcsand, s: float, eta: float) -> float:
    """Plastic shear gamma_p at constant s from eta = 0: eta/(1 - a eta) = k gamma_p."""
    return eta / (1 - material.Rf / material.eta_f * eta) / hardening(material, s)


def plastic_volume(material: Ubcsand, s: float, eta: float) -> float:
    """Plastic volume strain eps_v_p on the same path. Raises ValueError for Rf = 0."""
    if not material.Rf > 0:
        raise ValueError("the closed form needs Rf above zero")
    a = material.Rf / material.eta_f
    rest = 1 - a * eta
    return (material.eta_cv * eta / rest - (log(rest) + 1 / rest - 1) / a**2) / hardening(material, s)


def elastic_shear(material: Ubcsand, s: float, eta: float) -> float:
    """Elastic shear gamma_e = t/G."""
    return eta * s / material.moduli(s)[0]


def ratio_at(material: Ubcsand, s: float, gamma: float) -> float:
    """Mobilised ratio eta at a total shear strain, constant s; eta_f beyond the strain that reaches it."""

    def left(eta: float) -> float:
        return plastic_shear(material, s, eta) + elastic_shear(material, s, eta) - gamma

    return material.eta_f if left(material.eta_f) <= 0 else float(brentq(left, 0.0, material.eta_f, xtol=1e-15))


def volume_at(material: Ubcsand, s: float, gamma: float) -> float:
    """Plastic volume strain at a total shear strain, constant s; beyond failure it dilates at a constant rate."""
    eta = ratio_at(material, s, gamma)
    beyond = gamma - elastic_shear(material, s, eta) - plastic_shear(material, s, eta)
    return plastic_volume(material, s, eta) + (material.eta_cv - material.eta_f) * max(0.0, beyond)


def biaxial(material: Ubcsand, s3: float, eta: float) -> tuple[float, float]:
    """Strains gamma and eps_v of drained biaxial compression at constant s3 up to eta <= eta_f, by quadrature."""

    def moduli(e: float) -> tuple[float, float, float, float]:
        s = s3 / (1 - e)
        G, K = material.moduli(s)
        return s3 / (1 - e) ** 2, G, K, 1 / (hardening(material, s) * (1 - material.Rf / material.eta_f * e) ** 2)

    def shear(e: float) -> float:
        rate, G, _, slip = moduli(e)
        return rate / G + slip

    def volume(e: float) -> float:
        rate, G, K, slip = moduli(e)
        return rate / (K + G / 3) + (material.eta_cv - e) * slip

    both = [quad(f, 0.0, eta, epsabs=1e-14, epsrel=1e-12)[0] for f in (shear, volume)]
    return float(both[0]), float(both[1])


def isotropic(material: Ubcsand, s0: float, volume: float) -> float:
    """Mean stress s after compression in the plane by `volume` from s0: ds = (K + G/3) d eps_v, no plastic strain.

    The form is closed where ne = me, as in Table 2. Raises ValueError otherwise.
    """
    if material.ne != material.me:
        raise ValueError("the closed form needs ne = me")
    stiff = (material.KBe + material.KGe / 3) * material.Pa ** (1 - material.ne)
    if material.ne == 1:
        return float(s0 * np.exp(stiff * volume))
    return float((s0 ** (1 - material.ne) + (1 - material.ne) * stiff * volume) ** (1 / (1 - material.ne)))
