"""Curves of the element tests that are kept to be drawn, and the lines and points that are drawn beside them."""

from collections.abc import Callable
from math import cos, radians, sin
from typing import Any

import numpy as np

from mpm_verify.cases.element import ubcsand_exact as ubc
from mpm_verify.cases.element.checks import davis_ratio
from mpm_verify.cases.element.study import ElementStudy
from mpm_verify.cases.harness.checks import Curves
from mpm_verify.solver.material.ubcsand import Ubcsand

MARKED = 5e3  # Pa, the confining stress of the reference tables
DRAWN = 400  # points of a curve that are kept
STRENGTH: dict[str, Callable[[Any], tuple[float, float]]] = {  # a and b of t = a + b s, by the name of the material
    "mohr_coulomb": lambda material: (material.c * cos(radians(material.phi)), sin(radians(material.phi))),
    "ubcsand": lambda material: (material.shift * material.eta_f, material.eta_f),
}


def drawn(material: Any, studies: list[ElementStudy], stress: float) -> Curves:
    """Curves, lines and points that the page draws."""
    return curves(studies) | strength(material) | limit(material, stress) | marks(material, studies, stress)


def curves(studies: list[ElementStudy]) -> Curves:
    """Curves by name: columns of `test/NAME` and `exact/NAME` where known; `errors/NAME`: steps, error; `kind/NAME`."""
    kept: Curves = {}
    for one in studies:
        if one.curve:
            every = max(1, len(one.curve["s"]) // DRAWN)
            kept[f"test/{one.test.name}"] = {name: values[::every] for name, values in one.curve.items()}
        if one.truth is not None:
            kept[f"exact/{one.test.name}"] = one.truth
        errors = {"steps": np.array(one.steps, float), "error": np.array(one.errors)}
        kept[f"errors/{one.test.name}"] = errors | {"order": np.array([one.order])}
        kept[f"kind/{one.test.name}"] = {"shear": np.array([float(one.test.shear)])}
    return kept


def strength(material: Any) -> Curves:
    """Line t = a + b s that a soil cannot pass in the plane, where the material has one."""
    if material.name not in STRENGTH:
        return {}
    a, b = STRENGTH[material.name](material)
    return {"strength": {"a": np.array([a]), "b": np.array([b])}}


def limit(material: Any, stress: float) -> Curves:
    """Shear stress that simple shear at constant vertical stress comes to, where it is known."""
    ratio = davis_ratio(material)
    return {} if ratio is None else {"limit/shear_stress": {"tau": np.array([ratio * stress])}}


def marks(material: Any, studies: list[ElementStudy], stress: float) -> Curves:
    """Points of the reference tables on the curves of the material that they are for."""
    if material != Ubcsand() or stress != MARKED:
        return {}
    table = [
        (slip + ubc.elastic_shear(material, s, eta), eta * s, ev)
        for s, eta, slip, ev, _ in ubc.CONSTANT_S
        if s == MARKED and eta
    ]
    found = {"constant_s": table, "biaxial": [(g, (s1 - MARKED) / 2, ev) for _, s1, g, ev, *_ in ubc.BIAXIAL]}
    return {
        f"marks/{name}": dict(zip(("gamma", "t", "ev"), np.array(rows).T, strict=True))
        for name, rows in found.items()
        if name in {one.test.name for one in studies}
    }
