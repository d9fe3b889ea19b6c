"""Functions made of a formula as text, to try the rules of frames."""

from typing import Annotated

import liegen
from liegen import (
    R1,
    R2,
    R3,
    R4,
    R6,
    R9,
    S2,
    SE2,
    SE3,
    SE23,
    SO2,
    SO3,
    Cal3_S2,
    Cal3DS2,
    Gal3,
    NavState,
    cross,
    dot,
    frames,
    function,
    norm,
    outputs,
    stack,
    where,
)

ARGUMENTS = {
    "T_AB": SE3, "T_BC": SE3, "T_AC": SE3, "T_CB": SE3, "T_DC": SE3, "P_AB": SE2, "P_BC": SE2, "P_CB": SE2,
    "R_AB": SO3, "R_BC": SO3, "R_CB": SO3, "Q_AB": SO2, "Q_BC": SO2, "q_AB": SO3, "p_A": R3, "p2_A": R3,
    "p_B": R3, "p_C": R3, "v_A": R3, "v2_A": R3, "v_B": R3, "d_A": R3, "d_B": R3, "t_AB": R3, "l_A": R2,
    "l_B": R2, "u_B": R2, "xi_A": R6, "xi_B": R6, "n_A": S2, "n_B": S2, "m_A": S2, "b_A": SO2, "b_B": SO2,
    "K_IC": Cal3_S2, "D_IC": Cal3DS2, "z_I": R2, "z_J": R2, "x": SE3, "y": SE3, "r": SO3, "q": R3, "w": R3,
    "n": S2,
    "K": Cal3_S2, "s": R1, "xi": R6, "c": R4, "X_AB": NavState, "X_AC": NavState, "X_CB": NavState,
    "E_AB": SE23, "E_BC": SE23, "E_CB": SE23, "G_AB": Gal3, "G_BC": Gal3, "G_CB": Gal3, "zeta_A": R9,
    "zeta_B": R9, "X": NavState,
}  # fmt: skip
NAMESPACE = {"cross": cross, "dot": dot, "norm": norm, "stack": stack, "where": where, "liegen": liegen}
NAMESPACE |= {m.__name__: m for m in (R1, R2, R3, SE2, SE3, SO2, SO3, S2, SE23, NavState, Gal3)}


def made(body, untyped=(), **options):
    """A function of what the body names, with a scalar as its only variable."""
    used = [name for name in ARGUMENTS if name in compile(body, "body", "eval").co_names]
    space = dict(NAMESPACE)
    signature = ", ".join(["k: R1", *(["*"] if used else []), *(f"{u}: manifolds['{u}']" for u in used)])
    manifolds = {k: Annotated[m, frames()] if k in untyped else m for k, m in ARGUMENTS.items()}
    source = f"def made({signature}):\n    return outputs(r={body}, k=k)\n"
    exec(source, space | {"manifolds": manifolds, "outputs": outputs}, space)
    return function(**options)(space["made"])
