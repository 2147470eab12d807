"""What stands once: a law or a small function that is written twice is sooner or later changed in one place only."""

import ast
from functools import cache
from pathlib import Path

from layers.syntax import tree_of

ROOT = Path(__file__).parents[2]
BY_PROGRAM = "core/tautline/lumped/generated.py"


@cache
def modules():
    """Names and syntax trees of the packages' modules, but for the one that is written by a program."""
    paths = sorted(path for room in ("core", "apps") for path in (ROOT / room).rglob("*.py"))
    told = [(path.relative_to(ROOT).as_posix(), path) for path in paths]
    return {name: tree_of(path) for name, path in told if name != BY_PROGRAM}


@cache
def functions():
    """Modules and nodes of all functions."""
    return [
        (module, node)
        for module, tree in modules().items()
        for node in ast.walk(tree)
        if isinstance(node, ast.FunctionDef)
    ]


def is_compiled(function):
    return any("kernel" in ast.unparse(mark) or "entry" in ast.unparse(mark) for mark in function.decorator_list)


def is_of(node, operation):
    """Whether a node is a sum, or a product, of two."""
    return isinstance(node, ast.BinOp) and isinstance(node.op, operation)


def scalar_product(node):
    """Whether an expression is x[0] y[0] + x[1] y[1] + x[2] y[2]."""
    if not (is_of(node, ast.Add) and is_of(node.left, ast.Add) and is_of(node.right, ast.Mult)):
        return False
    x = next((part.value for part in ast.walk(node) if isinstance(part, ast.Subscript)), None)
    for y in (part.value for part in ast.walk(node) if isinstance(part, ast.Subscript)):
        a, b = ast.unparse(x), ast.unparse(y)
        if ast.unparse(node) == " + ".join(f"{a}[{i}] * {b}[{i}]" for i in range(3)):
            return True
    return False


def whole_expressions(function):
    """Expressions of a function that are no beginning of a longer sum."""
    nodes = list(ast.walk(function))
    begun = {id(node.left) for node in nodes if isinstance(node, ast.BinOp) and isinstance(node.op, ast.Add)}
    return [node for node in nodes if id(node) not in begun]


def test_the_scalar_product_of_compiled_code_is_written_in_one_function():
    found = {
        f"{module}: {function.name}"
        for module, function in functions()
        if is_compiled(function) and any(map(scalar_product, whole_expressions(function)))
    }
    assert found == {"core/tautline/kernels/vector.py: dot"}


def test_the_law_of_strain_is_written_once_for_one_element_and_once_for_four():
    found = [
        function.name
        for module, function in functions()
        if module.startswith("core/tautline/elements/") and "0.5 * (square - 1.0)" in ast.unparse(function)
        for line in ast.unparse(function).splitlines()
        if "0.5 * (square - 1.0)" in line
    ]
    assert sorted(found) == ["_strain_of_four", "strain_of"]


def stated(value):
    """Whether a constant states something that has to be the same everywhere: four names or more, or four digits."""
    if isinstance(value, ast.Tuple):
        parts = value.elts
        return len(parts) > 3 and all(isinstance(part, ast.Constant) and isinstance(part.value, str) for part in parts)
    digits = ast.unparse(value).lower().partition("e")[0]
    return "." in digits and digits.replace(".", "").isdigit() and len(digits.strip("0.")) > 4


def test_a_list_of_names_and_a_number_of_four_digits_are_written_once():
    found = {}
    for module, tree in modules().items():
        for line in tree.body:
            if isinstance(line, ast.Assign) and isinstance(line.targets[0], ast.Name) and stated(line.value):
                found.setdefault((line.targets[0].id, ast.unparse(line.value)), []).append(module)
    assert {name: places for (name, _), places in found.items() if len(places) > 1} == {}


def body_of(function):
    """What a function does, without its docstring."""
    lines = function.body
    told = isinstance(lines[0], ast.Expr) and isinstance(lines[0].value, ast.Constant)
    return "\n".join(ast.unparse(line) for line in lines[told:])


def names_in(node):
    return {part.id for part in ast.walk(node) if isinstance(part, ast.Name)}


def is_of_its_module(function, tree):
    """Whether compiled code uses what its own module defines: it does another thing there than elsewhere."""
    defined = {line.name for line in tree.body if isinstance(line, (ast.FunctionDef, ast.ClassDef))}
    # What dispatches by type is a function as well, and a variable.
    defined |= {
        name
        for line in tree.body
        if isinstance(line, ast.Assign) and any(isinstance(part, ast.Call) for part in ast.walk(line.value))
        for target in line.targets
        for name in names_in(target)
    }
    used = {name for line in function.body for name in names_in(line)}
    return is_compiled(function) and bool(defined & used)


def constants_of(function, tree):
    """Constants of its module that compiled code uses, with their values: others there make it another function."""
    used = {name for line in function.body for name in names_in(line)} if is_compiled(function) else set()
    lines = [line for line in tree.body if isinstance(line, ast.Assign)]
    return [ast.unparse(line) for line in lines if used & {n for target in line.targets for n in names_in(target)}]


def test_no_function_of_a_module_is_written_again_in_another():
    # Of four words or fewer there may be two.
    found = {}
    for module, tree in modules().items():
        for node in tree.body:
            if (
                isinstance(node, ast.FunctionDef)
                and len(body_of(node).split()) > 4
                and not is_of_its_module(node, tree)
            ):
                what = "\n".join([*constants_of(node, tree), body_of(node)])
                found.setdefault(what, {})[module] = node.name
    assert [places for places in found.values() if len(places) > 1] == []


def is_range(node):
    return isinstance(node, ast.Call) and isinstance(node.func, ast.Name) and node.func.id == "range"


def test_outputs_of_many_frames_are_read_one_by_one_in_one_place():
    found = set()
    for module, tree in modules().items():
        for node in ast.walk(tree):
            loops = node.generators if isinstance(node, ast.ListComp) else [node] if isinstance(node, ast.For) else []
            counted = any(is_range(loop.iter) for loop in loops)
            calls = [one.func for one in ast.walk(node) if isinstance(one, ast.Call)] if counted else []
            if any(isinstance(call, ast.Attribute) and call.attr == "value" for call in calls):
                found.add(module)
    assert found == {"core/tautline/system/handles.py"}
