"""Operations counted in C++ text."""

import pytest
from bench_tools import made

from liegen.bench import symforce_cpp
from liegen.bench.operations import counted
from liegen.bench.peers import PUBLISHED, tasks
from liegen.bench.wrenfold_cpp import operations

TEXT = """
/** a * b = c; */
template <typename Scalar>
void F(const Eigen::Matrix<Scalar, 4, 1>& a, Scalar* const out = nullptr) {
  // x = a * b;
  const Scalar _tmp0 = a(0, 0) * a(1, 0) - a(2, 0);
  const Scalar _tmp1 = -_tmp0 + 2 * std::pow(_tmp0, Scalar(2));
  const Scalar _tmp2 = (Scalar(1) / Scalar(2)) * std::acos(_tmp1) / std::sqrt(_tmp0);
  if (out != nullptr) {
    _out(0, 0) = std::min<Scalar>(_tmp1, -(_tmp2 - 1));
  }
}
"""


def test_text_by_hand():
    assert counted(TEXT) == {
        "acos": 1, "add": 1, "compare": 1, "div": 1, "mul": 4, "neg": 2, "sqrt": 1, "sub": 2,
    }  # fmt: skip


def test_powers_count_as_products():
    text = "void F(Scalar a) {\n  b = std::pow(a, Scalar(N));\n}\n"
    products = {power: counted(text.replace("N", str(power)))["mul"] for power in (2, 3, 4, 7)}
    assert products == {2: 1, 3: 2, 4: 2, 7: 4}


def test_comments_of_wrenfold():
    assert operations("  // add: 3\n  // call: 2\n  // total: 5\n") == {"add": 3, "call": 2}


@pytest.mark.parametrize("task", tasks(PUBLISHED[6:8]), ids=lambda t: t.name)
def test_symforce_counts_about_the_same(task):
    """Its own total counts a power as one, and some signs not at all."""
    for variant in made(symforce_cpp.variants, task):
        text = variant.sources["generated.h"]
        total = int(text.partition("// Total ops: ")[2].split()[0])
        assert abs(sum(counted(text).values()) - total) < 0.3 * total
