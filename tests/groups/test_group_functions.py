"""The functions of a group module: which there are, what they cost, and that their matrices are right."""

from __future__ import annotations

import json

import numpy as np
import pytest
from module_tools import MATRIX_GROUPS, linear
from scipy.linalg import expm, expm_frechet

from liegen.emit import render
from liegen.errors import DefinitionError
from liegen.manifolds import SE3, SO2
from liegen.modules import every_function, group_functions, groups
from liegen.verify import reference
from liegen.verify.reference import tangent
from liegen.verify.reference.matrix import mp
from liegen.verify.reference.spaces import GROUPS

OPERATIONS = ["compose", "inverse", "between", "act", "transform_to", "exp", "log", "retract", "local"]
MATRICES = ["adjoint", "ad", "Jr", "Jl", "Jr_inv", "Jl_inv"]
FUNCTIONS = every_function()
NAMES = list(groups())


def random_element(group: str, rng) -> np.ndarray:
    n = {"SO2": 2, "SE2": 2, "Sim2": 2}.get(group, 4)
    unit = rng.normal(size=n)
    unit /= np.linalg.norm(unit)
    rest = rng.normal(size={"SE2": 2, "SE3": 3, "Sim2": 3, "Sim3": 4}.get(group, 0))
    rest[-1:] = np.exp(rest[-1:]) if group.startswith("Sim") else rest[-1:]
    return np.concatenate([unit, rest])


@pytest.mark.parametrize("group", NAMES)
def test_names(group):
    made = [f.name for f in group_functions(groups()[group])]
    acts = group in MATRIX_GROUPS  # groups without an action on vectors lack its functions
    names = [name for name in (*OPERATIONS, *MATRICES) if acts or name not in ("act", "transform_to")]
    assert made == [f"{group.lower()}_{name}" for name in names]


def test_every_group_has_a_module():
    assert {"SO2", "SE2", "SO3", "SE3"} <= set(NAMES)
    assert not [name for name in NAMES if name.startswith("R")]


@pytest.mark.parametrize("group", NAMES)
def test_operations_have_jacobians_and_matrices_have_none(group):
    for f in group_functions(groups()[group]):
        kernel = f.kernel
        blocks = [port for port in kernel.jacobians.outputs if port.name != "out"]
        if f.name.partition("_")[2] in OPERATIONS:
            (output,) = kernel.outputs
            assert [b.name for b in blocks] == [f"out_D_{a.name}" for a in kernel.arguments]
            assert [b.shape for b in blocks] == [(output.dim, a.dim) for a in kernel.arguments]
        else:
            dim = groups()[group].form.dim
            assert not blocks
            assert kernel.value.outputs[0].shape == (dim, dim)


# against matrices and SciPy


@pytest.mark.parametrize("group", list(MATRIX_GROUPS))
def test_adjoint_and_ad_are_those_of_the_matrices(group):
    rng, reals, name = np.random.default_rng(1), MATRIX_GROUPS[group], group.lower()
    for _ in range(5):
        x, d = random_element(group, rng), rng.normal(size=reals.dim)
        X, D = reals.element(x), reals.hat(d)
        conjugated = linear(reals, lambda E, X=X: X @ E @ np.linalg.inv(X))
        bracket = linear(reals, lambda E, D=D: D @ E - E @ D)
        np.testing.assert_allclose(np.asarray(FUNCTIONS[f"{name}_adjoint"](x)), conjugated, atol=1e-13)
        np.testing.assert_allclose(np.asarray(FUNCTIONS[f"{name}_ad"](d)), bracket, atol=1e-13)


@pytest.mark.parametrize("group", list(MATRIX_GROUPS))
@pytest.mark.parametrize("length", [0.0, 1e-9, 0.3, 2.0, 5.0])
def test_jacobians_are_those_of_the_matrix_exponential(group, length):
    """exp(-D) dexp(D)[E] = hat(Jr e) and dexp(D)[E] exp(-D) = hat(Jl e), by SciPy's Frechet derivative."""
    rng, reals, name = np.random.default_rng(2), MATRIX_GROUPS[group], group.lower()
    d = rng.normal(size=reals.dim)
    d *= length / np.linalg.norm(d)
    D = reals.hat(d)
    right = linear(reals, lambda E: expm(-D) @ expm_frechet(D, E, compute_expm=False))
    left = linear(reals, lambda E: expm_frechet(D, E, compute_expm=False) @ expm(-D))
    for matrix, expected in (("Jr", right), ("Jl", left)):
        mine = np.asarray(FUNCTIONS[f"{name}_{matrix}"](d))
        inverse = np.asarray(FUNCTIONS[f"{name}_{matrix}_inv"](d))
        np.testing.assert_allclose(mine, expected, atol=1e-12)
        np.testing.assert_allclose(inverse @ expected, np.eye(reals.dim), atol=1e-12)


ANGLES = [0.0, 1e-320, 1e-160, 1e-12, 1e-8, 1e-3, 1.0, np.pi - 1e-8, np.pi, np.pi + 1e-8, 4.0]
ANGLES += [2 * np.pi - 1e-3, 2 * np.pi + 1e-3, 7.0, 3 * np.pi, 20.0, 100.0]


#: The coefficients of similarities are those of a turn at most.
PAIRS = [
    (G, a) for G in ("SO3", "SE2", "SE3", "Sim2", "Sim3") for a in ANGLES if a < 2 * np.pi or G[:3] != "Sim"
]


@pytest.mark.parametrize(("group", "angle"), PAIRS)
def test_inverse_jacobians_at_any_tangent_vector(group, angle):
    """2e-14 max(1, s), and what four units in the last place of the angle change near a pole."""
    rng, space = np.random.default_rng(3), GROUPS[group]
    form = groups()[group].form
    turns = np.array(["rad" in name for name in form.tangent])
    unit = rng.normal(size=form.dim) * turns
    d = np.where(turns, unit / np.linalg.norm(unit) * angle, rng.normal(size=form.dim))
    moved = np.where(turns, d * (1 + 4 * np.finfo(float).eps), d)
    for name, function in (("Jr_inv", tangent.right), ("Jl_inv", tangent.left)):
        with mp.workdps(reference.DIGITS):
            exact, other = (
                np.array(tangent.inverted(function(space, tuple(map(mp.mpf, v.tolist())))), dtype=float)
                for v in (d, moved)
            )
        computed = np.asarray(FUNCTIONS[f"{group.lower()}_{name}"](d))
        bound = 2e-14 * max(1.0, np.abs(exact).max()) + np.abs(exact - other).max()
        assert np.abs(computed - exact).max() <= bound


def test_retract_takes_a_product_with_the_exponential():
    x, d = np.array([0, 0, 0.6, 0.8, 1, 2, 3.0]), np.array([0.1, -0.2, 0.3, 1, 2, 3])
    moved = FUNCTIONS["se3_retract"](x, d)
    X = MATRIX_GROUPS["SE3"]
    np.testing.assert_allclose(X.element(np.asarray(moved)), X.element(x) @ expm(X.hat(d)), atol=1e-14)
    np.testing.assert_allclose(np.asarray(FUNCTIONS["se3_local"](x, moved)), d, atol=1e-14)


def test_batches_and_wrong_calls():
    assert np.asarray(FUNCTIONS["se3_Jr"](np.zeros((4, 6)))).shape == (4, 6, 6)
    assert np.asarray(FUNCTIONS["se3_Jr"](d=np.zeros(6))).shape == (6, 6)
    with pytest.raises(DefinitionError, match=r"call it as se3_Jr\(d\)"):
        FUNCTIONS["se3_Jr"]()


# costs


def constants(program, name: str) -> np.ndarray:
    """Entries of an output that are constants of the program, NaN for the others."""
    k = next(i for i, port in enumerate(program.outputs) if port.name == name)
    code = [program.code[i] for i in program.results[k]]
    values = [ins.value if ins.op == "const" else np.nan for ins in code]
    return np.array(values).reshape(program.outputs[k].shape)


@pytest.mark.parametrize("group", NAMES)
@pytest.mark.parametrize("name", ["compose", "between"])
def test_the_derivative_by_the_right_factor_is_the_identity_and_costs_nothing(group, name):
    program = FUNCTIONS[f"{group.lower()}_{name}"].kernel.jacobians
    np.testing.assert_array_equal(constants(program, "out_D_y"), np.eye(groups()[group].form.dim))
    assert program.operations_of(["out", "out_D_y"]) == program.operations_of(["out"])
    assert program.operations_of(["out_D_y"]) == 0


@pytest.mark.parametrize("name", OPERATIONS)
def test_jacobians_of_plane_rotations_by_tangents_cost_nothing(name):
    kernel = FUNCTIONS[f"so2_{name}"].kernel
    free = kernel.jacobians.operations - kernel.value.operations
    assert free == (2 if name in ("act", "transform_to") else 0)  # R and J R p: two signs


def test_blocks_of_pose_matrices_are_shared_and_zero_blocks_are_constants():
    for name, zero in (("adjoint", (0, 1)), ("Jr", (0, 1)), ("Jr_inv", (0, 1)), ("ad", (0, 1))):
        program = FUNCTIONS[f"se3_{name}"].kernel.value
        entries = np.array(program.results[0]).reshape(2, 3, 2, 3).swapaxes(1, 2)
        np.testing.assert_array_equal(entries[0, 0], entries[1, 1])
        known = constants(program, "out").reshape(2, 3, 2, 3).swapaxes(1, 2)
        np.testing.assert_array_equal(known[zero], np.zeros((3, 3)))


#: Operations of the value and with all Jacobians, not to be exceeded. Written out: Ad of SE(3) is a rotation
#: matrix of 24 (12 products, 12 sums) and a product with [t]x of 27 (18 products, 9 differences); ad only
#: changes signs.
MOST = {
    "so3_compose": (28, 52), "so3_adjoint": (24, 24), "so3_ad": (3, 3), "so3_Jr": (57, 57),
    "so3_Jr_inv": (54, 54), "se3_compose": (61, 112), "se3_inverse": (33, 84), "se3_between": (61, 112),
    "se3_act": (42, 69), "se3_exp": (80, 168), "se3_log": (90, 157), "se3_retract": (141, 280),
    "se3_local": (151, 236), "se3_adjoint": (51, 51), "se3_ad": (6, 6), "se3_Jr": (149, 149),
    "sim3_compose": (74, 150), "sim3_between": (75, 151), "sim3_exp": (171, 522), "sim3_log": (221, 532),
    "sim3_local": (296, 667), "sim3_adjoint": (63, 63), "sim3_Jr": (438, 438), "sim3_Jr_inv": (380, 380),
    "se3_Jr_inv": (126, 126), "se2_compose": (14, 21), "se2_adjoint": (2, 2), "se2_ad": (2, 2),
}  # fmt: skip


@pytest.mark.parametrize("name", list(MOST))
def test_operations(name):
    kernel = FUNCTIONS[name].kernel
    value, both = MOST[name]
    assert kernel.value.operations <= value
    assert kernel.jacobians.operations <= both


@pytest.mark.parametrize("group", NAMES)
def test_left_jacobians_cost_what_right_ones_do(group):
    for name in ("J{}", "J{}_inv"):
        right, left = (FUNCTIONS[f"{group.lower()}_{name.format(side)}"].kernel.value for side in "rl")
        sign_of_lambda = group.startswith("Sim") and name == "J{}"  # exp(-lambda) and exp(lambda)
        assert right.operations == left.operations + sign_of_lambda


def test_the_manifest_tells_the_operations():
    kernels = [f.kernel for f in group_functions(SE3)]
    files = render(kernels, ["c"], package="lie", regenerate="-")
    facts = json.loads(files["lie.json"])["factors"]
    compose = FUNCTIONS["se3_compose"].kernel
    assert facts["se3_compose"]["jacobians"]["operations_added_by"] == {
        "out_D_x": compose.jacobians.operations - compose.value.operations,
        "out_D_y": 0,
    }
    assert "jacobians" not in facts["se3_adjoint"]
    assert facts["se3_adjoint"]["value"]["operations"] == FUNCTIONS["se3_adjoint"].kernel.value.operations


def test_functions_are_made_once():
    assert group_functions(SO2) is group_functions(SO2)
