"""What users of other libraries write, and what it is here: the one table, by the class of the value.

A key lists names, a value is what to write: ``x`` is the value, ``0``, ``1``, ``2`` are the arguments, ``v``
is the first argument, ``cls`` the class. ``:a`` puts parentheses around an operand that needs them. Names are
compared without case and underscores, unless they hold a capital here. They are those of GTSAM, Sophus,
manif, Eigen, NumPy, SciPy, SymPy, CasADi and JAX.
"""

from __future__ import annotations

from collections.abc import Mapping

Words = Mapping[str, str]

_AXES = "R3(1, 0, 0)", "R3(0, 0, 1)"
_YAW = f"atan2(({{x:a}} @ {_AXES[0]})[1], ({{x:a}} @ {_AXES[0]})[0])"
_ROLL = f"atan2({{x:a}}.unrotate({_AXES[1]})[1], {{x:a}}.unrotate({_AXES[1]})[2])"
_PIXELS = "{x:a}.uncalibrate(q), the pixels of q = p[:2] / p[2]; for a parameter alone, make it an argument"

#: Attributes of values, by the classes of the language.
ATTRIBUTES: Mapping[str, Words] = {
    "Vector": {
        "norm length magnitude mag modulus l2norm euclidean": "norm({x})",
        "squarednorm norm2 normsquared sqnorm normsq sqrmagnitude lengthsquared": "dot({x}, {x})",
        "normalized normalize unit normed unitvector normalise normalised hatted": "{x:a} / norm({x})",
        "inner scalarproduct": "dot({x}, {0})",
        "crossproduct": "cross({x}, {0})",
        "distance dist distanceto": "norm({x:a} - {0:a})",
        "T H transpose": "dot({x}, y) for x.T @ y; a vector is no column",
        "x": "{x:a}[0]", "y": "{x:a}[1]", "z": "{x:a}[2]", "w": "{x:a}[3]",
        "u": "{x:a}[0]", "v": "{x:a}[1]",
        "head": "{x:a}[:{0}]", "tail": "{x:a}[-{0}:]", "segment": "{x:a}[{0}:{0} + {1}]",
        "topleft toprows": "{x:a}[:{0}]",
        "size shape ndim rows nrows numel cols dim": "len({x})",
        "mean average": "sum({x}) / len({x})", "sum": "sum({x})",
        "min mincoeff amin": "minimum({x:a}[0], {x:a}[1])",
        "max maxcoeff amax": "maximum({x:a}[0], {x:a}[1])",
        "cwiseproduct mul multiply times": "{x:a} * {0:a}", "cwisequotient div divide": "{x:a} / {0:a}",
        "add plus": "{x:a} + {0:a}", "sub subtract minus": "{x:a} - {0:a}",
        "neg negate": "-{x:a}", "square squared": "{x:a} ** 2", "pow power": "{x:a} ** {0:a}",
        "cwiseabs fabs absolute": "abs({x})", "reciprocal inv": "1 / {x:a}",
        "hat skew skewsymmetric wedge asskew crossmatrix": "cross({x}, y) for hat(x) @ y",
        "append concatenate concat hstack vstack col_join row_join": "stack({x}, {0})",
        "outer": "{x:a} * dot({0}, y) for outer(x, {0}) @ y",
        "clip clamp": "minimum(maximum({x}, {0}), {1})",
        "get at": "{x:a}[{0}]",
        "homogeneous tohomogeneous": "stack({x}, 1.0)",
    },
    "SO2": {
        "angle theta radians yaw heading phi": "{x:a}.log()[0]",
        "c cos": "cos({x:a}.log()[0])", "s sin": "sin({x:a}.log()[0])",
    },
    "SO3": {
        "angle theta magnitude": "norm({x:a}.log())",
        "axis": "{x:a}.log() / norm({x:a}.log())",
        "yaw heading z_angle rpy ypr euler aseuler eulerangles toeuler asyawpitchroll": _YAW,
        "pitch": f"asin(-({{x:a}} @ {_AXES[0]})[2])", "roll": _ROLL,
        "trace": "1 + 2 * cos(norm({x:a}.log()))",
        "r1 col column": f"{{x:a}} @ {_AXES[0]}, the first column", "r2": "{x:a} @ R3(0, 1, 0)",
        "r3": f"{{x:a}} @ {_AXES[1]}", "row": f"{{x:a}}.unrotate({_AXES[0]}), the first row",
        "q quat quaternion toquaternion asquat coeffs xyzw wxyz vec imag w x y z":
            "{x:a}.log(); half of it is the vector of the quaternion, for small angles",
        "vector": "{x:a}.log()",
    },
    "Rotation": {
        "T H transpose conj conjugate conjugated adjugate dagger": "{x:a}.inverse()",
        "R M mat asmatrix tomatrix rotationmatrix torotationmatrix asdcm dcm rot": "{x:a}.matrix()",
        "act apply rotatepoint transform transformpoint rotatevector transformfrom": "{x:a} @ {v:a}",
        "inverserotate derotate applyinverse rotateinverse transformto": "{x:a}.unrotate({v})",
        "asrotvec rotvec torotvec axisangle toaxisangle rotationvector": "{x:a}.log()",
        "rotation so3": "{x}",
        "distance dist geodesic": "norm({x:a}.local({0}))",
    },
    "Pose": {
        "t p trans xyz position pos translate gettranslation point origin location": "{x:a}.translation",
        "R r rot q quat quaternion so3 so2 orientation attitude linear getrotation rotationmatrix "
        "unitquaternion": "{x:a}.rotation",
        "T": "{x:a}.inverse()",
        "x": "{x:a}.translation[0]", "y": "{x:a}.translation[1]", "z": "{x:a}.translation[2]",
        "act transform apply transformpoint map mappoint": "{x:a} @ {v:a}",
        "inversetransform transforminverse actinverse applyinverse": "{x:a}.transform_to({v})",
        "rotate": "{x:a}.rotation @ {v:a}", "unrotate": "{x:a}.rotation.unrotate({v})",
        "matrix asmatrix tomatrix homogeneous mat":
            "{x:a} @ p, or its parts {x:a}.rotation and {x:a}.translation",
        "distance dist": "{x:a}.range({0})", "norm": "norm({x:a}.log())",
        "theta angle yaw heading": "{x:a}.rotation.log()[0]",
        "parameters params coeffs data vec wxyzxyz xyzquat":
            "{x:a}.log(), or its parts {x:a}.rotation and {x:a}.translation",
    },
    "SE3": {
        "theta angle": "norm({x:a}.rotation.log())",
        "yaw heading": _YAW.replace("{x:a}", "{x:a}.rotation"),
    },
    "ExtendedPose": {
        "p t pos translation trans xyz": "{x:a}.position", "v vel": "{x:a}.velocity",
        "R r rot q quat quaternion orientation attitude so3": "{x:a}.rotation",
        "bodyvelocity": "{x:a}.rotation.unrotate({x:a}.velocity)",
        "act transform apply transformfrom transformpoint": "{x:a}.pose @ {v:a}",
        "transformto": "{x:a}.pose.transform_to({v})", "rotate": "{x:a}.rotation @ {v:a}",
        "matrix": "its parts: {x:a}.rotation, {x:a}.position, {x:a}.velocity",
    },
    "Similarity": {
        "s": "{x:a}.scale", "t p trans position pos": "{x:a}.translation",
        "R r rot q quat quaternion so3 rotationmatrix": "{x:a}.rotation",
        "act transform apply transformpoint": "{x:a} @ {v:a}",
        "matrix": "{x:a} @ p, or its parts {x:a}.rotation, {x:a}.translation and {x:a}.scale",
    },
    "S2": {
        "v p n point3 unitvector tovector tovec vec normal asvector coords array": "{x:a}.vector",
        "dot inner dotproduct": "dot({x:a}.vector, {v})", "cross": "cross({x:a}.vector, {v})",
        "x": "{x:a}.vector[0]", "y": "{x:a}.vector[1]", "z": "{x:a}.vector[2]",
        "error errorvector log": "{x:a}.local({0})",
        "distance dist angle": "norm({x:a}.local({0}))", "norm": "norm({x:a}.vector)",
        "basis": "{x:a}.local({0}), which has 2 coordinates in the basis",
        "rotate": "S2.direction({0:a} @ {x:a}.vector)", "neg inverse antipode": "S2.direction(-{x:a}.vector)",
    },
    "Calibration": {
        "K fx fy f cx cy px py skew focal focallength principalpoint matrix": _PIXELS,
        "k1 k2 k3 p1 p2 s u0 v0": _PIXELS,
        "project projection pinhole": "{x:a}.uncalibrate({v:a}[:2] / {v:a}[2])",
        "calibrate undistort unproject": "{x:a}.uncalibrate(q), and compare it with the pixels {v}",
        "distort topixels": "{x:a}.uncalibrate({v})",
    },
    "Condition": {
        "and logicaland all": "{x:a} & {0:a}", "or logicalor any": "{x:a} | {0:a}",
        "not logicalnot": "~{x:a}", "astype float int": "where({x}, 1.0, 0.0)",
        "select where": "where({x}, {0}, {1})",
    },
    "RotationMatrix": {
        "inv inverse": "{x:a}.T", "I": "{x:a}.T", "dot matmul": "{x:a} @ {v:a}",
        "trace": "{x:a}[0, 0] + {x:a}[1, 1] + {x:a}[2, 2]",
        "col": "{x:a}[:, {0}]", "row": "{x:a}[{0}]", "block": "{x:a}[i, j], one entry at a time",
        "flatten reshape ravel vec": "stack({x:a}[0], {x:a}[1], {x:a}[2])",
    },
    "Group": {
        "inv invert inverted reverse": "{x:a}.inverse()",
        "logmap logm tangent vee tolog": "{x:a}.log()",
        "mul multiply times prod product matmul mult": "{x:a} @ {0:a}",
        "adjoint adjointmap adj Ad": "({x:a} @ {cls}.exp({v}) @ {x:a}.inverse()).log() for Ad({x}) {v:a}",
        "interp interpolate slerp lerp": "{x:a} @ {cls}.exp({1:a} * {x:a}.between({0}).log())",
        "pow power": "{cls}.exp({0:a} * {x:a}.log())",
        "lplus": "{cls}.exp({v}) @ {x:a}", "lminus": "({x:a} @ {0:a}.inverse()).log()",
        "normalize normalized normalise renormalize": "{x}",
        "relative relativepose relativeto betweenfactor": "{x:a}.between({0})",
        "norm": "norm({x:a}.log())",
    },
    "Manifold": {
        "localcoordinates unretract logmapto": "{x:a}.local({0})",
        "minus rminus boxminus ominus difference": "{0:a}.local({x})",
        "plus rplus boxplus oplus update updated": "{x:a}.retract({v})",
        "equals isapprox isclose allclose": "norm({x:a}.local({0})) < 1e-9",
    },
    "Value": {
        "diff grad gradient jacobian derivative backward": "the formula alone; liegen derives its Jacobians",
        "real": "{x}",
        "copy clone detach eval evaluate simplify tolist numpy item astype value values asarray": "{x}",
        "ravel flatten reshape squeeze": "{x}",
    },
}  # fmt: skip

#: Attributes of the classes themselves.
OF_CLASSES: Mapping[str, Words] = {
    "Vector": {"ones": "{cls}.identity() + 1"},
    "SO3": {
        "rx rotx fromxradians": "SO3.exp(stack({v}, 0, 0))",
        "ry roty fromyradians pitch": "SO3.exp(stack(0, {v}, 0))",
        "rz rotz fromzradians yaw": "SO3.exp(stack(0, 0, {v}))",
        "fromaxisangle axisangle": "SO3.exp({1:a} * {0:a})",
        "ypr rzryrx rpy fromeuler fromrpy euler fromrpyradians fromypr":
            "SO3.exp(stack(0, 0, yaw)) @ SO3.exp(stack(0, pitch, 0)) @ SO3.exp(stack(roll, 0, 0))",
        "quaternion fromquaternion fromquat fromquaternionxyzw": "SO3.from_storage([x, y, z, w])",
    },
    "SO2": {"fromangle fromradians rot": "SO2.exp({v})"},
    "Pose": {
        "fromrotationandtranslation create fromrt": "{cls}({0}, {1})",
        "fromtranslation trans transx": "{cls}({rotation}.identity(), {v})",
        "fromrotation": "{cls}({v}, 0 * p)",
    },
    "S2": {"frompoint3 fromvector normalize fromunit": "S2.direction({v})"},
    "Group": {
        "expmap exponential expm rodrigues fromrotvec frommrp": "{cls}.exp({v})",
        "logmap log logarithm": "{v:a}.log()",
        "zero zeros eye one unit I id": "{cls}.identity()",
        "frommatrix fromrotationmatrix fromhomogeneous":
            '@factor(layout="4x4") for arguments that are given as matrices',
        "hat wedge": "cross({v}, y) for hat({v}) @ y",
    },
    "Manifold": {"fromarray fromvec fromlist": "{cls}.from_storage({v})"},
}  # fmt: skip

#: Functions, of any module; those of the language itself need no row.
FUNCTIONS: Words = {
    "atan arctan": "atan2({0}, 1)", "arctan2": "atan2({0}, {1})",
    "arcsin": "asin({0})", "arccos": "acos({0})",
    "fabs absolute": "abs({0})", "square sqr sq": "{0:a} ** 2", "cbrt": "exp(log({0}) / 3)",
    "hypot": "norm(stack({0}, {1}))", "reciprocal": "1 / {0:a}", "negative neg": "-{0:a}",
    "sinh": "(exp({0}) - exp(-{0:a})) / 2", "cosh": "(exp({0}) + exp(-{0:a})) / 2",
    "tanh": "1 - 2 / (exp(2 * {0:a}) + 1)", "ln": "log({0})",
    "log10": "log({0}) / log(10)", "log2": "log({0}) / log(2)", "log1p": "log(1 + {0:a})",
    "exp2": "exp({0:a} * log(2))", "expm1": "exp({0}) - 1",
    "cot": "1 / tan({0})", "sec": "1 / cos({0})", "csc": "1 / sin({0})",
    "sign signum sgn copysign": "where({0:a} < 0, -1.0, 1.0)",
    "heaviside step": "where({0:a} < 0, 0.0, 1.0)", "relu": "maximum({0}, 0.0)",
    "deg2rad radians": "{0:a} * (math.pi / 180)", "rad2deg degrees": "{0:a} * (180 / math.pi)",
    "wrap wraptopi wrapangle normalizeangle angdiff remainder mod fmod": "atan2(sin({0}), cos({0}))",
    "clip clamp": "minimum(maximum({0}, {1}), {2})", "sum fsum nansum": "sum({0})",
    "mean average nanmean": "sum({0}) / len({0})",
    "add": "{0:a} + {1:a}", "subtract": "{0:a} - {1:a}", "multiply mul": "{0:a} * {1:a}",
    "divide truedivide div": "{0:a} / {1:a}",
    "inner vdot innerproduct": "dot({0}, {1})", "outer": "{0:a} * dot({1}, y) for outer(x, y) @ y",
    "concatenate concat hstack vstack vertcat horzcat block array matrix vector asarray columnstack rowstack "
    "append dstack ravel vector2 vector3 vector6 point2 point3": "stack({args})",
    "normalize normalized unit normalise": "{0:a} / norm({0})", "length magnitude": "norm({0})",
    "squarednorm sumsq sumsqr": "dot({0}, {0})", "distance dist": "norm({0:a} - {1:a})",
    "skew hat wedge skewsymmetric crossmatrix": "cross({0}, y) for skew({0}) @ y",
    "transpose": "{0:a}.inverse() for a rotation; a vector is no column",
    "inv inverse pinv": "{0:a}.inverse()", "expmap logmap": "SE3.exp(v) or x.log()",
    "select ifelse cond piecewise ifthenelse heavyside": "where({0}, {1}, {2})",
    "logicaland bitwiseand": "{0:a} & {1:a}", "logicalor bitwiseor": "{0:a} | {1:a}",
    "logicalnot invert": "~{0:a}",
    "greater": "{0:a} > {1:a}", "less": "{0:a} < {1:a}", "greaterequal": "{0:a} >= {1:a}",
    "lessequal": "{0:a} <= {1:a}", "equal isclose allclose": "abs({0:a} - {1:a}) < 1e-9",
    "float float32 float64 double int bool asarray copy deepcopy asfarray squeeze atleast1d complex": "{0}",
    "round": "{0:a}, without steps, which have no derivative",
    "maxof fmax": "maximum({0}, {1})", "minof fmin": "minimum({0}, {1})",
    "identity eye": "SE3.identity()", "nantonum": "where({0:a} < 1e9, {0}, 0.0)",
    "diag diagonal diagflat": "{0:a} * y for diag({0}) @ y",
    "trace": "{0:a}[0, 0] + {0:a}[1, 1] + {0:a}[2, 2]",
    "sorted sort": "minimum({0}, {1}) and maximum({0}, {1})",
    "prod product": "{0:a}[0] * {0:a}[1] * {0:a}[2]",
    "floor ceil trunc rint": "{0:a}, without steps, which have no derivative",
    "isnan isfinite isinf": 'require(condition, "why") with the condition under which {0} is finite',
    "einsum tensordot": "dot({1}, {2}), or M @ x with a constant matrix",
    "zeroslike": "{0:a} * 0", "oneslike": "{0:a} * 0 + 1",
    "huber cauchy tukey": '@factor(loss="huber") for a robust loss',
}  # fmt: skip

#: Classes of other libraries.
CLASSES: Mapping[str, str] = {
    "Pose3": "SE3", "Pose2": "SE2", "Rot3": "SO3", "Rot2": "SO2", "Point3": "R3", "Point2": "R2",
    "Vector3": "R3", "Vector2": "R2", "Vector6": "R6", "Vector1": "R1", "Unit3": "S2",
    "Similarity3": "Sim3", "Similarity2": "Sim2", "Scalar": "R1", "Quaternion": "SO3", "Rotation": "SO3",
    "Transform": "SE3", "RigidTransform": "SE3", "Isometry3d": "SE3", "SE3d": "SE3", "SO3d": "SO3",
    "SE2d": "SE2", "SO2d": "SO2", "V3": "R3", "V2": "R2", "V1": "R1", "ExtendedPose3": "SE23",
    "SE_2_3": "SE23", "SE2_3": "SE23", "SGal3": "Gal3", "Cal3S2": "Cal3_S2", "Bundle": "Product",
    "LinearCameraCal": "Cal3_S2", "float": "R1", "int": "R1",
}  # fmt: skip
