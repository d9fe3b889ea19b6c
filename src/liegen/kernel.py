"""``Kernel``: everything that is known of a derived factor, a frozen value that emission and checks read."""

from __future__ import annotations

from dataclasses import dataclass, field

from liegen.errors import Site
from liegen.names import jacobian_name
from liegen.program import Program


@dataclass(frozen=True)
class Stored:
    """A named value on a manifold: ``storage`` names its scalars (``qx`` to ``z`` for SE3).

    ``dim`` is its tangent's size. ``shape`` is that of its array: (size,), or (rows, columns) for a matrix,
    whose storage is row-major.
    """

    name: str
    manifold: str
    storage: tuple[str, ...]
    dim: int
    shape: tuple[int, ...] = field(default=(), kw_only=True)

    def __post_init__(self) -> None:
        object.__setattr__(self, "shape", self.shape or (len(self.storage),))

    @property
    def size(self) -> int:
        """Number of stored scalars."""
        return len(self.storage)


@dataclass(frozen=True)
class Argument(Stored):
    """A parameter. ``meaning`` describes it where no manifold does.

    ``named``: a call gives it by name also where there are no variables. ``default``: the stored numbers
    that stand for it where a call in Python leaves it out.
    """

    variable: bool
    meaning: str = ""
    named: bool = False
    default: tuple[float, ...] | None = None

    @property
    def default_text(self) -> str:
        """The default as a tuple of numbers in Python, of rows for a matrix; empty where there is none."""
        return "" if self.default is None else repr(_nested(self.default, self.shape))


@dataclass(frozen=True)
class Output(Stored):
    """A named result; its Jacobians are ``dim`` rows by each variable's ``dim`` columns."""

    @property
    def laid_out(self) -> bool:
        """Whether a matrix stands for an element of another manifold: its order is that of its layout."""
        return len(self.shape) > 1 and self.dim != self.size


@dataclass(frozen=True)
class PassCount:
    """Operations left after a pass: a row of the table that ``explain`` prints."""

    name: str
    operations: int


@dataclass(frozen=True)
class Kernel:
    """A derived factor.

    ``value`` computes the outputs; ``jacobians`` the outputs, then for each output its Jacobian by each
    variable, as ports named ``res_D_x`` of shape (output dim, variable dim). Both read all arguments, in
    order, as ports of shape (size,), and carry the same requirements. Without variables both are one program,
    and its arguments are positional. ``in_place``: the array of an output may be that of an argument.
    """

    name: str
    doc: str
    site: Site
    arguments: tuple[Argument, ...]
    outputs: tuple[Output, ...]
    formula: tuple[str, ...]  # lines such as "res = z.local(x.between(y))"
    jacobian_formulas: tuple[str, ...]  # lines such as "res_D_y = Jr^-1(res)"
    conventions: tuple[str, ...]  # one line per manifold that occurs: storage, tangent, retract
    value: Program
    jacobians: Program
    passes: tuple[PassCount, ...]
    frames: tuple[str, ...] = ()  # lines such as "res: tangent vector in B; noise in B"
    in_place: bool = False
    noise: tuple[str, ...] = ()  # how residual and Jacobians are whitened and weighed by a loss

    @property
    def variables(self) -> tuple[Argument, ...]:
        """The arguments that get Jacobians."""
        return tuple(a for a in self.arguments if a.variable)

    @property
    def given(self) -> tuple[Argument, ...]:
        """The arguments that get none."""
        return tuple(a for a in self.arguments if not a.variable)

    @property
    def positional(self) -> tuple[Argument, ...]:
        """The arguments without a name in a call: the variables; without any, all that are not ``named``."""
        return self.variables or tuple(a for a in self.arguments if not a.named)

    @property
    def keywords(self) -> tuple[Argument, ...]:
        """The arguments that a call names."""
        return self.given if self.variables else tuple(a for a in self.arguments if a.named)

    def jacobian_name(self, output: Output, variable: Argument) -> str:
        """``res_D_x``."""
        return jacobian_name(output.name, variable.name)


def _nested(numbers: tuple[float, ...], shape: tuple[int, ...]) -> tuple[object, ...]:
    if len(shape) == 1:
        return numbers
    size = len(numbers) // shape[0]
    return tuple(_nested(numbers[k * size : (k + 1) * size], shape[1:]) for k in range(shape[0]))
