"""The LaTeX that `explain --latex` and notebooks show: golden strings, parentheses, and that it typesets."""

import re
from pathlib import Path

import pytest
from click.testing import CliRunner
from matplotlib.mathtext import MathTextParser
from test_jacobian_text import CASES_OF_GROUP

from liegen import (
    R1,
    R3,
    S2,
    SE2,
    SE3,
    SE23,
    SO3,
    Cal3_S2,
    R,
    cross,
    dot,
    factor,
    library,
    norm,
    require,
    where,
)
from liegen.cli import app
from liegen.sources import load
from liegen.trace import latex_rows

USER_FACTORS = Path(__file__).parents[1] / "typed" / "user_factors.py"
EVERYTHING = [*load(None), *load(str(USER_FACTORS)), *(f for f, _ in CASES_OF_GROUP)]
FUNCTIONS = list({id(f): f for f in EVERYTHING}.values())


def test_between():
    assert latex_rows(library.between_se3.graph) == (
        r"r &= \mathrm{Log}\left(z^{-1} x^{-1} y\right)",
        r"\frac{\partial r}{\partial x} &= "
        r"-J_r^{-1}\left(r\right)\, \mathrm{Ad}_{\left(x^{-1} y\right)^{-1}}",
        r"\frac{\partial r}{\partial y} &= J_r^{-1}\left(r\right)",
    )
    assert latex_rows(library.between_r3.graph) == (
        r"r &= y - x - z",
        r"\frac{\partial r}{\partial x} &= -I",
        r"\frac{\partial r}{\partial y} &= I",
    )


@factor
def halves(p: R3, *, a: R1, beta_max: R1, z: R1):
    return dot(p, p) / (2 * a) - 2.5e-7 * (2 * p[0]) - dot(p, p) * beta_max / 3 - z


@factor
def extended(q: SO3, p: R3, v: R3, *, rear_left: SE23):
    return rear_left.local(SE23(q, p, v))


def test_like_terms_are_added_and_names_are_symbols():
    assert latex_rows(halves.graph)[-1] == (
        r"\frac{\partial r}{\partial p} &= \frac{1}{a}\, p^{\top} - 5 \cdot 10^{-7}\, I_{[0]} "
        r"- \frac{2}{3}\, \beta_{\mathrm{max}}\, p^{\top}"
    )
    rows = "\n".join(latex_rows(extended.graph))
    assert r"\mathrm{SE23}" in rows
    assert r"\_" not in rows


def test_prior_on_the_sphere():
    assert latex_rows(library.prior_s2.graph) == (
        r"r &= \mathrm{Log}_{z}\left(x\right)",
        r"\frac{\partial r}{\partial x} &= D_{2}\left[\mathrm{Log}\right]\left(z,\, x\right)",
    )


def test_range():
    assert latex_rows(library.range_se3_r3.graph) == (
        r"r &= \left\lVert y - \mathrm{t}_{x} \right\rVert - z",
        r"a &= y - \mathrm{t}_{x}",
        r"\frac{\partial r}{\partial x} &= -\frac{a^{\top}}{\left\lVert a \right\rVert}\, \mathrm{R}_{x}\, "
        r"\begin{bmatrix} 0 & I \end{bmatrix}",
        r"\frac{\partial r}{\partial y} &= \frac{a^{\top}}{\left\lVert a \right\rVert}",
    )


def test_projection():
    by_b = r"D_{2}\left[\mathrm{uncalibrate}\right]\left(K,\, b\right)\, \frac{\partial b}{\partial "
    by_a = (
        r"\frac{1}{a_{[2]}}\, I_{[0:2]}\, \frac{\partial a}{\partial @} - "
        r"\frac{b}{a_{[2]}}\, I_{[2]}\, \frac{\partial a}{\partial @}"
    )
    assert latex_rows(library.projection_cal3_s2.graph) == (
        r"a &= x^{-1} p",
        r"r &= \mathrm{uncalibrate}_{K}\left(\frac{a_{[0:2]}}{a_{[2]}}\right) - z",
        r"\text{requires} &\quad 0 < a_{[2]}",
        r"b &= \frac{a_{[0:2]}}{a_{[2]}}",
        r"\frac{\partial a}{\partial x} &= \begin{bmatrix} \left[a\right]_{\times} & -I \end{bmatrix}",
        r"\frac{\partial a}{\partial p} &= \mathrm{R}_{x}^{\top}",
        r"\frac{\partial b}{\partial x} &= " + by_a.replace("@", "x"),
        r"\frac{\partial b}{\partial p} &= " + by_a.replace("@", "p"),
        r"\frac{\partial r}{\partial x} &= " + by_b + "x}",
        r"\frac{\partial r}{\partial p} &= " + by_b + "p}",
    )


# parentheses


def residual(function):
    return latex_rows(factor(function).graph)[0].removeprefix("r &= ")


def inverse_of_product(x: SE3, y: SE3, *, z: SE3):
    return z.local(x.compose(y).inverse().compose(x.between(y)))


def inverse_twice(x: SO3, y: SO3, *, z: SO3):
    return z.inverse().local(x.inverse().between(y))


def scaled_before_moved(T: SE3, p: R3, k: R1):
    return T @ (k * p)


def scaled_after_moved(T: SE3, p: R3, k: R1):
    return k * (T @ p) - (T @ p) * k


def moved_twice(T_WA: SE3, T_AB: SE3, p: R3):
    return T_WA @ (T_AB @ p)


def seen_from_product(x: SE3, y: SE3, p: R3):
    return (x @ y).transform_to(p - x.translation)


def differences(v: R3, w: R3):
    return v - (w - v) - w


def negated(v: R3, w: R3):
    return -(v + w) - (-v)


def powers(s: R1, v: R3):
    return (1 + s) ** 2 * v + s**2 * s * v


def entries(v: R3, w: R3):
    return v * w + v / (1 + w)


def fractions(s: R1, v: R3):
    return v / (s / 2) / (1 + s)


def products_of_vectors(v: R3, w: R3):
    return cross(v, cross(w, v)) * dot(v - w, v)


def moved_points(x: SE3, d: R3):
    return x.retract([0.1, 0, 0, 0, 0, 0]).translation + norm(x @ d) * d


def on_the_sphere(n: S2, p: R3, *, z: S2):
    return z.local(S2.direction(p).retract(n.local(z)))


def cases(s: R1, v: R3):
    return where((s > 0) & ~(s <= 2), v, -v)[1:] - v[2]


def camera_offset(K: Cal3_S2, *, z: Cal3_S2):
    return z.local(K)


@pytest.mark.parametrize(
    ("function", "expected"),
    [
        (inverse_of_product, r"\mathrm{Log}\left(z^{-1} \left(x y\right)^{-1} x^{-1} y\right)"),
        (
            inverse_twice,
            r"\mathrm{Log}\left(\left(z^{-1}\right)^{-1} \left(x^{-1}\right)^{-1} y\right)",
        ),
        (scaled_before_moved, r"T \left(k\, p\right)"),
        (scaled_after_moved, r"k\, \left(T p\right) - \left(T p\right)\, k"),
        (moved_twice, r"T_{WA} T_{AB} p"),
        (seen_from_product, r"\left(x y\right)^{-1} \left(p - \mathrm{t}_{x}\right)"),
        (differences, r"v - \left(w - v\right) - w"),
        (negated, r"-\left(v + w\right) - \left(-v\right)"),
        (entries, r"v \odot w + v \oslash \left(1 + w\right)"),
        (fractions, r"\frac{\frac{v}{\frac{s}{2}}}{1 + s}"),
        (
            products_of_vectors,
            r"\left(v \times \left(w \times v\right)\right)\, \left(\left(v - w\right)^{\top} v\right)",
        ),
        (
            moved_points,
            r"\mathrm{t}_{x\, \mathrm{Exp}\left(\left(0.1,\, 0,\, 0,\, 0,\, 0,\, 0\right)\right)} + "
            r"\left\lVert x d \right\rVert\, d",
        ),
        (
            on_the_sphere,
            r"\mathrm{Log}_{z}\left(\mathrm{Exp}_{\mathrm{dir}\left(p\right)}\left("
            r"\mathrm{Log}_{n}\left(z\right)\right)\right)",
        ),
        (
            cases,
            r"\left(\begin{cases} v & \text{if } 0 < s \wedge \neg \left(s \leq 2\right) \\ "
            r"-v & \text{otherwise} \end{cases}\right)_{[1:3]} - v_{[2]}",
        ),
        (camera_offset, "K - z"),
    ],
    ids=lambda p: getattr(p, "__name__", ""),
)
def test_parentheses_stand_where_they_must(function, expected):
    assert residual(function) == expected


def square_less_double(s: R1):
    return s**2 + R1(-2.0) * s


def test_squares_are_powers():
    assert latex_rows(factor(powers).graph)[:2] == (r"a &= 1 + s", r"r &= a^{2}\, v + s^{2}\, s\, v")
    assert residual(square_less_double) == r"s^{2} + \left(-2\right)\, s"


# that it typesets


def unpaired(text, opening, closing):
    """Whether closings match openings."""
    depth = 0
    for found in re.finditer(rf"({opening})|({closing})", text):
        depth += 1 if found[1] else -1
        if depth < 0:
            return True
    return depth != 0


def typeset(row):
    """Read by matplotlib, which knows neither alignment nor environments: those become brackets here."""
    text = re.sub(r"\\begin\{(bmatrix|cases)\}", r"\\left[", row)
    text = re.sub(r"\\end\{(bmatrix|cases)\}", r"\\right]", text)
    text = text.replace(r"\\", r";\;").replace("&=", "=").replace("&", r"\;")
    text = text.replace(r"\lVert", r"\Vert").replace(r"\rVert", r"\Vert")
    return MathTextParser("path").parse(f"${text}$")


@pytest.mark.parametrize("function", FUNCTIONS, ids=lambda f: f.name)
def test_it_is_well_formed(function):
    rows = latex_rows(function.graph)
    variables = [p for p in function.graph.parameters if p.variable]
    assert len(rows) >= len(function.graph.outputs) * (1 + len(variables))
    for row in rows:
        assert not unpaired(row, r"(?<!\\)\{", r"(?<!\\)\}"), row
        assert not unpaired(row, r"\\left(?![a-z])", r"\\right(?![a-z])"), row
        begun, ended = (sorted(re.findall(rf"\\{word}\{{(\w+)\}}", row)) for word in ("begin", "end"))
        assert begun == ended, row
        assert len(re.findall(r"(?<!\\)&=|&\\quad", row)) == 1, row
        assert "#" not in row, row
        assert typeset(row).width > 10, row


@pytest.mark.parametrize(
    "wrong", ["a_{[0:2]}_{1}", r"\left(a", r"\frac{a}", r"x^{-1}^{-1}", r"\nosuch x", "{x"]
)
def test_the_checks_see_mistakes(wrong):
    with pytest.raises(ValueError, match="\n"):
        typeset(wrong)


# where it is shown


def test_the_command_prints_it():
    done = CliRunner().invoke(app, ["explain", "between_se3", "--latex"])
    assert done.exit_code == 0
    assert done.output == "\n".join(
        [
            "% between_se3(x: SE3, y: SE3, *, z: SE3) -> res: 6",
            "% Ad(x): adjoint, x Exp(d) = Exp(Ad(x) d) x",
            "% Jr(d), Jr^-1(d): right Jacobian of Exp at d and its inverse",
            r"\begin{aligned}",
            *(f"  {row} \\\\" for row in latex_rows(library.between_se3.graph)[:-1]),
            f"  {latex_rows(library.between_se3.graph)[-1]}",
            r"\end{aligned}",
            "",
        ]
    )


def test_the_command_prints_a_users_factor():
    done = CliRunner().invoke(app, ["explain", "lever_arm_range", str(USER_FACTORS), "--latex"])
    assert done.exit_code == 0
    assert (
        r"  r &= \left\lVert T_{WB}\, \mathrm{lever} - \mathrm{anchor} \right\rVert - z \\"
        in done.output.splitlines()
    )


def test_the_documented_output_is_the_commands():
    shown = (USER_FACTORS.parents[2] / "docs" / "explain.md").read_text(encoding="utf-8")
    printed = CliRunner().invoke(app, ["explain", "between_se3", "--latex"]).output
    assert f"```latex\n{printed}```" in shown
    assert "$$\n" + printed[printed.index("\\begin") :] + "$$" in shown


def test_notebooks_show_it():
    shown = library.between_se2._repr_latex_()
    assert shown.startswith("$$\n\\begin{aligned}\n")
    assert shown.endswith("\n\\end{aligned}\n$$")
    assert all(row in shown for row in latex_rows(library.between_se2.graph))


def test_conditions_have_a_row():
    @factor
    def positive(x: SE2, k: R1):
        require(k > 0, "must be positive & finite_100%")
        return x.translation / k

    rows = latex_rows(positive.graph)
    assert rows[0] == r"r &= \frac{\mathrm{t}_{x}}{k}"
    assert rows[1] == r"\text{requires} &\quad 0 < k"


class R12(R, dim=12):
    """A larger vector."""


def test_entries_of_subscripted_names():
    def picked(c_W: R12):
        return c_W[3:6] + c_W[2]

    assert residual(picked) == "{c_{W}}_{[3:6]} + {c_{W}}_{[2]}"
