"""The language of expressions: what it means, and that nothing else gets through."""

from __future__ import annotations

import math
import operator
import pickle

import pytest
from hypothesis import given
from hypothesis import strategies as st

from modelgen.errors import ExpressionError
from modelgen.scene.expression import (
    MAX_DEPTH,
    MAX_LENGTH,
    Cubic,
    Name,
    Number,
    evaluate,
    parse_expression,
)
from modelgen.scene.expression_algebra import expression_of

VALUES = {"u": 0.37, "v": -1.25, "k_1": 2.5}

HOSTILE = [
    "__import__('os').system('true')",
    "().__class__.__bases__",
    "(1).__class__",
    "u.real",
    "u[0]",
    "lambda: 0",
    "[u for u in v]",
    "{u}",
    "f'{u}'",
    "'text'",
    "open(u)",
    "eval(u)",
    "exec(u)",
    "__builtins__",
    "sin.__call__(u)",
    "sin(cos)",
    "sin(*u)",
    "sin(u, x=v)",
    "min(**u)",
    "u if v else 1",
    "u and v",
    "not u",
    "u < v < 1",
    "u == v",
    "u := v",
    "u; v",
    "u @ v",
    "u // v",
    "u % v",
    "u << 9999999999",
    "~u",
    "u ^ 2",
    "9**9**9**9",
    "10**9999999",
    "u**99999999999",
    "1e999",
    "1j",
    "True",
    "None",
    "...",
    "1" * 400,
    "0x" + "f" * 400,
    "u(v)",
    "(sin)(u)()",
    "await u",
    "yield",
    "\0",
    "u\0v",
    "u #\n+ v",
    "\\",
    "ｓｉｎ(u)",
    "sin(u",
    "1if u else 2",
    "",
    "   ",
    "\n",
    "(" * 900,
    "-" * 1900 + "u",
    "sin(" * 300 + "u" + ")" * 300,
    "*".join(["u"] * 900),
    "u" * 5000,
    "1/0",
    "sqrt(-1)",
    "log(0)",
    "(-8)**(1/3)",
    "exp(exp(99))",
]


@pytest.mark.parametrize("text", HOSTILE)
def test_a_hostile_text_is_refused_with_what_was_found_and_what_is_allowed(text: str) -> None:
    with pytest.raises(ExpressionError) as caught:
        parse_expression(text, VALUES)
    error = caught.value
    assert error.found
    assert error.allowed
    assert "\n" not in str(error)
    assert "\0" not in str(error)


@given(st.one_of(st.text(max_size=80), st.text(alphabet="uv12.e_+-*/(), sincoxp\n", max_size=60)))
def test_any_text_is_parsed_or_refused_and_nothing_else(text: str) -> None:
    try:
        expression = parse_expression(text, VALUES)
    except ExpressionError:
        return
    assert expression.names <= VALUES.keys()


UNARY = {
    "sin": math.sin, "cos": math.cos, "tan": math.tan, "asin": math.asin, "acos": math.acos,
    "atan": math.atan, "sinh": math.sinh, "cosh": math.cosh, "tanh": math.tanh, "exp": math.exp,
    "log": math.log, "sqrt": math.sqrt, "abs": abs, "sign": lambda x: float((x > 0) - (x < 0)),
}  # fmt: skip
BINARY = {"atan2": math.atan2, "min": min, "max": max}
OPERATORS = {"+": operator.add, "-": operator.sub, "*": operator.mul, "/": operator.truediv, "**": math.pow}

Pair = tuple[str, float]  # a text and its value, found without the parser


def _apply(function, *args: float) -> float:  # type: ignore[no-untyped-def]
    try:
        return float(function(*args))
    except (ValueError, ZeroDivisionError, OverflowError):
        return math.nan


def _extend(pairs: st.SearchStrategy[Pair]) -> st.SearchStrategy[Pair]:
    def call(name: str, args: list[Pair]) -> Pair:
        function = UNARY.get(name) or BINARY[name]
        return f"{name}({', '.join(text for text, _ in args)})", _apply(function, *(x for _, x in args))

    def binary(op: str, a: Pair, b: Pair) -> Pair:
        return f"({a[0]}) {op} ({b[0]})", _apply(OPERATORS[op], a[1], b[1])

    return st.one_of(
        st.builds(call, st.sampled_from(list(UNARY)), st.lists(pairs, min_size=1, max_size=1)),
        st.builds(call, st.sampled_from(list(BINARY)), st.lists(pairs, min_size=2, max_size=2)),
        st.builds(binary, st.sampled_from(["+", "-", "*", "/"]), pairs, pairs),
        st.builds(lambda a, n: binary("**", a, (str(n), float(n))), pairs, st.integers(-3, 4)),
        st.builds(lambda a: (f"-({a[0]})", -a[1]), pairs),
    )


LEAVES = st.one_of(
    st.sampled_from([*VALUES.items(), ("pi", math.pi), ("e", math.e)]),
    st.floats(0, 1e3, allow_subnormal=False).map(lambda x: (repr(x), x)),
)


@given(st.recursive(LEAVES, _extend, max_leaves=12))
def test_a_valid_expression_has_the_value_that_arithmetic_gives(pair: Pair) -> None:
    text, expected = pair
    try:
        value = evaluate(parse_expression(text, VALUES), VALUES)
    except ExpressionError as error:
        assert "finite value" in error.found  # noqa: PT017  one of its parts has none
        return
    assert value == expected


@pytest.mark.parametrize(
    ("text", "value"),
    [
        ("-u**2", -(0.37**2)),
        ("2**-1", 0.5),
        ("2**3**2", 512.0),
        ("8/4/2", 1.0),
        ("1 - 2 - 3", -4.0),
        ("+u", 0.37),
        ("k_1*u +\n v", 2.5 * 0.37 - 1.25),
        ("sign(0*u)", 0.0),
        (".5e1", 5.0),
    ],
)
def test_precedence_and_signs_are_those_of_arithmetic(text: str, value: float) -> None:
    assert evaluate(parse_expression(text, VALUES), VALUES) == pytest.approx(value, rel=1e-15)


def test_a_name_of_the_user_goes_before_the_constant() -> None:
    assert parse_expression("e", ["e"]).names == {"e"}
    assert parse_expression("e", []).tree == Number(math.e)


@pytest.mark.parametrize(
    ("text", "position", "fragments"),
    [
        ("1 + sinn(u)", 4, ["'sinn'", "column 5", "did you mean 'sin'"]),
        ("  u + w", 6, ["'w'", "known names: k_1 u v pi e"]),
        ("u^2", 1, ["'^'", "write ** for a power"]),
        ("atan2(u)", 0, ["'atan2' with 1", "it takes 2"]),
        ("u**65", 3, ["exponent 65"]),
        ("2(u)", 0, ["a call"]),
        ("sin + 1", 0, ["without (...)"]),
        ("u +", 3, ["not an expression"]),
    ],
)
def test_a_refusal_says_where_and_what(text: str, position: int, fragments: list[str]) -> None:
    with pytest.raises(ExpressionError) as caught:
        parse_expression(text, VALUES)
    assert caught.value.position == position
    for fragment in fragments:
        assert fragment in str(caught.value)


def test_length_and_depth_have_limits_that_are_reached() -> None:
    longest = "u" + " " * (MAX_LENGTH - 1)
    assert parse_expression(longest, "u").names == {"u"}
    deepest = "-" * (MAX_DEPTH - 1) + "u"
    assert parse_expression(deepest, "u").names == {"u"}
    for text in (longest + " ", "-" + deepest):
        with pytest.raises(ExpressionError):
            parse_expression(text, "u")


@given(st.lists(st.tuples(st.sampled_from("+-"), st.integers(-9, 9)), min_size=1, max_size=2000))
def test_a_sum_may_be_as_long_as_the_text(terms: list[tuple[str, int]]) -> None:
    """Of whole numbers, so that the value does not depend on the order of additions."""
    text = "u" + "".join(f"{sign}({value}*u)" for sign, value in terms)
    assert len(text) < MAX_LENGTH
    total = 1 + sum(value if sign == "+" else -value for sign, value in terms)
    assert evaluate(parse_expression(text, "u"), {"u": 3.0}) == 3.0 * total


@pytest.mark.parametrize("values", [{}, {"u": 0.0}, {"u": -1.0}])
def test_evaluation_is_finite_or_an_error(values: dict[str, float]) -> None:
    with pytest.raises(ExpressionError):
        evaluate(parse_expression("log(u)", ["u"]), values)


def test_errors_and_expressions_survive_pickling() -> None:
    expression = parse_expression("sin(u)/2", ["u"])
    assert pickle.loads(pickle.dumps(expression)) == expression
    with pytest.raises(ExpressionError) as caught:
        parse_expression("u^2", ["u"])
    copy = pickle.loads(pickle.dumps(caught.value))
    assert (str(copy), copy.position) == (str(caught.value), 1)


@given(
    st.integers(1, 9).flatmap(lambda n: st.lists(st.floats(-2, 2), min_size=5 * n + 1, max_size=5 * n + 1)),
    st.floats(-3, 5),
    st.sampled_from((0, 1, 2)),
)
def test_a_piecewise_cubic_has_the_value_of_its_sum(numbers: list[float], x: float, order: int) -> None:
    pieces = (len(numbers) - 1) // 5
    knots = {f"k_{i}": float(i) + abs(numbers[i]) / 4 for i in range(pieces + 1)}
    columns = [numbers[pieces + 1 + k * pieces : pieces + 1 + (k + 1) * pieces] for k in range(4)]
    cubic = Cubic(Name("t"), "x", pieces, order)
    values = knots | cubic.numbers(*columns)
    assert cubic.value(x, values) == evaluate(expression_of(cubic.tree()), values | {"t": x})
