"""Small kernels written by hand: what derivation would give, without derivation."""

from __future__ import annotations

import random
from collections.abc import Sequence
from dataclasses import dataclass, field

from liegen.errors import Site
from liegen.kernel import Argument, Kernel, Output, PassCount
from liegen.program import Instruction, Port, Program, Requirement
from liegen.program.program import ARITY, CONDITIONS

SE2 = ("c", "s", "x", "y")


@dataclass
class Code:
    """Appends instructions; inputs first, in order."""

    inputs: tuple[Port, ...]
    code: list[Instruction] = field(default_factory=list)

    def __post_init__(self) -> None:
        total = sum(port.size for port in self.inputs)
        self.code.extend(Instruction("input", (), float(k)) for k in range(total))

    def __call__(self, op: str, *args: int) -> int:
        self.code.append(Instruction(op, args))
        return len(self.code) - 1

    def const(self, value: float) -> int:
        self.code.append(Instruction("const", (), value))
        return len(self.code) - 1

    def program(
        self,
        name: str,
        outputs: Sequence[tuple[str, tuple[int, ...], Sequence[int]]],
        *requirements: Requirement,
    ) -> Program:
        ports = tuple(Port(n, shape) for n, shape, _ in outputs)
        results = tuple(tuple(indices) for _, _, indices in outputs)
        return Program(name, self.inputs, ports, tuple(self.code), results, requirements).validate()


def kernel(
    name: str,
    doc: str,
    arguments: Sequence[Argument],
    outputs: Sequence[Output],
    programs: tuple[Program, Program],
    formula: Sequence[str],
    jacobian_formulas: Sequence[str] = (),
) -> Kernel:
    conventions = tuple(dict.fromkeys(f"{a.manifold}: stored as {', '.join(a.storage)}" for a in arguments))
    return Kernel(
        name, doc, Site("factors.py", 7), tuple(arguments), tuple(outputs), tuple(formula),
        tuple(jacobian_formulas), conventions, *programs, (PassCount("lowered", programs[1].operations),),
    )  # fmt: skip


def between_r2() -> Kernel:
    """y - x - z: every Jacobian entry is a constant."""
    arguments = [Argument(n, "R2", ("x", "y"), 2, v) for n, v in (("x", True), ("y", True), ("z", False))]

    def program(with_jacobians: bool) -> Program:
        c = Code(tuple(Port(a.name, (2,)) for a in arguments))
        res = [c("sub", c("sub", 2 + i, i), 4 + i) for i in range(2)]
        outputs = [("res", (2,), res)]
        if with_jacobians:
            zero, one, minus = c.const(0.0), c.const(1.0), c.const(-1.0)
            outputs += [
                ("res_D_x", (2, 2), [minus, zero, zero, minus]),
                ("res_D_y", (2, 2), [one, zero, zero, one]),
            ]
        return c.program("between_r2", outputs)

    doc = "Difference of two points.\n\nz is the position of y seen from x, metres."
    return kernel(
        "between_r2", doc, arguments, [Output("res", "R2", ("x", "y"), 2)], (program(False), program(True)),
        ["res = z.local(x.between(y))"], ["res_D_x = -I", "res_D_y = I"],
    )  # fmt: skip


def bearing_range() -> Kernel:
    """Range and bearing of a point p seen from a pose x: sqrt, atan2, a select, a requirement, a matrix."""
    arguments = [
        Argument("x", "SE2", SE2, 3, True), Argument("p", "R2", ("x", "y"), 2, True),
        Argument("z", "R2", ("x", "y"), 2, False),
    ]  # fmt: skip

    def program(with_jacobians: bool) -> Program:
        c = Code((Port("x", (4,)), Port("p", (2,)), Port("z", (2,))))
        co, si, tx, ty, px, py, z0, z1 = range(8)
        dx, dy = c("sub", px, tx), c("sub", py, ty)
        bx = c("add", c("mul", co, dx), c("mul", si, dy))
        by = c("sub", c("mul", co, dy), c("mul", si, dx))
        squared = c("add", c("mul", bx, bx), c("mul", by, by))
        distance = c("sqrt", squared)
        angle = c("sub", c("atan2", by, bx), z0)
        pi, two_pi = c.const(3.141592653589793), c.const(6.283185307179586)
        wrapped = c("select", c("lt", pi, angle), c("sub", angle, two_pi), angle)
        wrapped = c("select", c("le", wrapped, c("neg", pi)), c("add", wrapped, two_pi), wrapped)
        outputs = [("res", (2,), [wrapped, c("sub", distance, z1)])]
        if with_jacobians:
            ax, ay = c("neg", c("div", by, squared)), c("div", bx, squared)
            rx, ry = c("div", bx, distance), c("div", by, distance)

            def turned(u: int, v: int) -> list[int]:
                return [
                    c("sub", c("mul", u, co), c("mul", v, si)),
                    c("add", c("mul", u, si), c("mul", v, co)),
                ]

            rows = [[c("neg", ax), c("neg", ay), c.const(-1.0)], [c("neg", rx), c("neg", ry), c.const(0.0)]]
            outputs += [("res_D_x", (2, 3), [*rows[0], *rows[1]])]
            outputs += [("res_D_p", (2, 2), [*turned(ax, ay), *turned(rx, ry)])]
        near = c("lt", c.const(0.01), squared)
        front = c("and", c("lt", c.const(0.0), bx), c("not", c("lt", c.const(100.0), bx)))
        return c.program(
            "bearing_range", outputs,
            Requirement(near, "the point is where the sensor is"),
            Requirement(front, "the point is out of sight"),
        )  # fmt: skip

    return kernel(
        "bearing_range", "Bearing (radians) and range (metres) of p in the frame of x.", arguments,
        [Output("res", "R2", ("x", "y"), 2)], (program(False), program(True)),
        ["q = x.transform_to(p)", "res = (atan2(q[1], q[0]), norm(q)) - z"],
    )  # fmt: skip


def wheel_step() -> Kernel:
    """Two outputs, R of one number and v of two, by a scalar w and a vector u."""
    arguments = [
        Argument("w", "R1", ("x",), 1, True), Argument("u", "R2", ("x", "y"), 2, True),
        Argument("dt", "R1", ("x",), 1, False), Argument("bias", "R3", ("x", "y", "z"), 3, False),
    ]  # fmt: skip

    def program(with_jacobians: bool) -> Program:
        c = Code((Port("w", (1,)), Port("u", (2,)), Port("dt", (1,)), Port("bias", (3,))))
        w, ux, uy, dt, b = 0, 1, 2, 3, 5
        turn = c("mul", c("sub", w, b), dt)
        co, si = c("cos", turn), c("sin", turn)
        v = [c("sub", c("mul", co, ux), c("mul", si, uy)), c("add", c("mul", si, ux), c("mul", co, uy))]
        outputs = [("R", (1,), [turn]), ("v", (2,), v)]
        if with_jacobians:
            zero = c.const(0.0)
            v_w = [c("neg", c("mul", v[1], dt)), c("mul", v[0], dt)]
            outputs += [("R_D_w", (1, 1), [dt]), ("R_D_u", (1, 2), [zero, zero])]
            outputs += [("v_D_w", (2, 1), v_w), ("v_D_u", (2, 2), [co, c("neg", si), si, co])]
        return c.program("wheel_step", outputs)

    outputs = [Output("R", "R1", ("x",), 1), Output("v", "R2", ("x", "y"), 2)]
    return kernel(
        "wheel_step", 'Turn by (w - bias_y) dt, radians; the text "*/ /* \\" is harmless.',
        arguments, outputs,
        (program(False), program(True)), ["R = (w - bias[1]) * dt", "v = rotate(R, u)"],
    )  # fmt: skip


def random_kernel(seed: int, length: int = 150) -> Kernel:
    """Any exactly rounded operation on anything earlier, constants and conditions included."""
    rng = random.Random(seed)
    arguments = [Argument("a", "R3", ("x", "y", "z"), 3, True), Argument("b", "R2", ("x", "y"), 2, False)]

    def program(outputs: Sequence[tuple[str, tuple[int, ...]]]) -> Program:
        c = Code((Port("a", (3,)), Port("b", (2,))))
        numbers = [*range(5), *(c.const(v) for v in (-2.0, 0.5, 0.0, -0.0, 1e-5, 3e20))]
        truths = [c("lt", 0, 1)]
        ops = sorted({*CONDITIONS, "add", "sub", "mul", "div", "neg", "sqrt", "abs", "select"})
        for _ in range(length):
            op = rng.choice(ops)
            pool = truths if op in {"and", "or", "not"} else numbers
            args = [rng.choice(pool[-12:] if rng.random() < 0.7 else pool) for _ in range(ARITY[op])]
            if op == "select":
                args[0] = rng.choice(truths)
            (truths if op in CONDITIONS else numbers).append(c(op, *args))
        sizes = [Port("", shape).size for _, shape in outputs]
        chosen = [
            (n, shape, rng.sample(numbers[11:], k)) for (n, shape), k in zip(outputs, sizes, strict=True)
        ]
        return c.program("anything", chosen)

    programs = program([("res", (4,))]), program([("res", (4,)), ("res_D_a", (4, 3))])
    return kernel(
        "anything", "Random.", arguments, [Output("res", "R4", ("0", "1", "2", "3"), 4)], programs, ["?"]
    )


def examples() -> list[Kernel]:
    """The kernels of the golden files."""
    return [between_r2(), bearing_range(), wheel_step()]
