"""Tables 1 and 2 of the seed documents' facts: the identities that the axioms' tests leave to be shown."""

import numpy as np
import pytest
import uncertainty_reference as ref
from scipy.linalg import expm
from uncertainty_reference import close

from liegen.manifolds import R3, S2, SE2, SE3, SO2, Cal3_S2

groups = pytest.mark.parametrize("G", ref.GROUPS, ids=lambda G: G.__name__)
poses = pytest.mark.parametrize("G", [SE2, SE3], ids=lambda G: G.__name__)


def elements(G, count=3, seed=5):
    return [G.exp(d) for d in np.random.default_rng(seed).normal(size=(count, G.form.dim))]


def rotation_angles(G):
    return [0] if G is SO2 else [2] if G is SE2 else [] if G is R3 else [0, 1, 2]


@groups
def test_compose_is_associative_and_not_commutative(G):
    """Table 1, compose: (a b) c = a (b c); a b differs from b a, except in SO2 and R^n."""
    a, b, c = elements(G)
    close(a.compose(b).compose(c).matrix(), a.compose(b.compose(c)).matrix(), 4e-15)
    gap = np.max(np.abs(a.compose(b).matrix() - b.compose(a).matrix()))
    assert gap < 1e-15 if G in (R3, SO2) else gap > 0.1


@groups
def test_inverse_and_between(G):
    """Table 1, inverse and between: a a^-1 = a^-1 a = I; a.between(b) = a^-1 b, a (a.between(b)) = b."""
    a, b, _ = elements(G)
    one = np.eye(len(ref.BASIS[G][0]))
    close(a.compose(a.inverse()).matrix(), one, 4e-15)
    close(a.inverse().compose(a).matrix(), one, 4e-15)
    close(a.between(b).matrix(), a.inverse().compose(b).matrix(), 4e-15)
    close(a.compose(a.between(b)).matrix(), b.matrix(), 4e-15)
    close(a.between(a).matrix(), one, 4e-15)


@groups
def test_log_and_exp(G):
    """Table 1, log and Exp: Exp(d) = expm(hat d), Log(Exp(d)) = d below pi, Exp(Log(a)) = a."""
    turning = rotation_angles(G)
    for size in (0.0, 0.3, 2.0, 3.1):
        d = np.random.default_rng(1).normal(size=G.form.dim)
        if turning:
            d[turning] *= size / np.linalg.norm(d[turning])
        close(G.exp(d).matrix(), expm(ref.hat(G, d)), 1e-14)
        close(G.exp(d).log(), d, 1e-14)
    for a in elements(G):
        close(G.exp(a.log()).matrix(), a.matrix(), 4e-15)
    if turning:
        d[turning] *= 4.0 / np.linalg.norm(d[turning])
        short = np.asarray(G.exp(d).log())
        assert np.linalg.norm(short[turning]) == pytest.approx(2 * np.pi - 4.0, abs=1e-14)


@poses
def test_transform_to_is_the_inverse_of_transform_from(G):
    """Table 1, transform_to and transform_from: inverse of each other, and through a product."""
    a, b, _ = elements(G)
    p = np.array([0.4, -1.2, 2.0][: 2 if G is SE2 else 3])
    close(a.transform_to(a.transform_from(p)), p, 6e-15)
    close(a.transform_from(a.transform_to(p)), p, 6e-15)
    close(a.compose(b).transform_from(p), a.transform_from(b.transform_from(p)), 6e-15)
    close(a.compose(b).transform_to(p), b.transform_to(a.transform_to(p)), 6e-15)
    close(a.inverse().transform_from(p), a.transform_to(p), 6e-15)


@groups
def test_local_and_retract(G):
    """Table 2: a.retract(a.local(b)) = b, I.local(a.between(b)) = a.local(b), a I.retract(d) = b."""
    a, b, c = elements(G)
    d = a.local(b)
    one = G.identity()
    close(a.retract(d).matrix(), b.matrix(), 6e-15)
    close(one.local(a.between(b)), d, 4e-15)
    close(a.compose(one.retract(d)).matrix(), b.matrix(), 6e-15)
    # left-invariant: moving both by c changes nothing
    close(c.compose(a).local(c.compose(b)), d, 2e-14)
    # the tangent vector is in the body frame of a: expm on the right
    close(a.matrix() @ expm(ref.hat(G, np.asarray(d))), b.matrix(), 1e-14)
    if G not in (R3, SO2):
        assert np.max(np.abs(expm(ref.hat(G, np.asarray(d))) @ a.matrix() - b.matrix())) > 0.1


@poses
def test_a_translation_added_in_the_world_is_not_left_invariant(G):
    """Table 2: with t <- t + v (SymForce's chart) a (I.retract(d)) is another pose than a.retract(d)."""
    a, _, _ = elements(G)
    k = 2 if G is SE2 else 3
    v = np.linspace(0.5, 1.0, k)
    A = a.matrix()
    in_world, body = A[:k, k] + v, (A @ [*v, 1.0])[:k]  # a.retract(d), a (I.retract(d)) with no rotation in d
    assert np.max(np.abs(in_world - body)) > 0.1


def test_manifolds_that_are_no_groups():
    """Table 2: calibrations and unit vectors have local and retract too; they invert each other."""
    K = Cal3_S2.from_storage([400.0, 410.0, 0.1, 320.0, 240.0])
    L = Cal3_S2.from_storage([390.0, 415.0, 0.0, 322.0, 239.0])
    close(K.retract(K.local(L)), np.asarray(L), 1e-15)
    assert K.form.dim == 5
    n, m = S2.direction([1.0, 2.0, -0.5]), S2.direction([0.3, -1.0, 0.7])
    d = n.local(m)
    close(n.retract(d), np.asarray(m), 4e-15)
    close(np.linalg.norm(d), np.arccos(np.dot(np.asarray(n), np.asarray(m))), 1e-14)
