"""What goes into compiled code: the files of the core and of installed applications, and all that others' kernels use.

Files are hashed by their contents and their place in their package, not by where that is installed. The core's name the
folder of the cache (:mod:`tautline.kernels.machine.storage`); an application's are part of the key of all code that
takes in a kernel or a group of it. Files say enough of what comes with this program: there constants of kernels stand
where kernels do. What others wrote, in a script or in a package that is installed, is hashed function by function with
every function that it calls and every constant that it takes in, wherever these stand; that hash is part of the key
under which its code is kept. So a folder of compiled code may be moved, copied to another machine, or come with an
installation.
"""

from __future__ import annotations

import dis
import enum
import functools
import hashlib
import os
import re
import sys
import types as python_types
import uuid
from collections.abc import Iterable, Iterator
from importlib import metadata, util
from typing import Any

import llvmlite
import numpy as np

from tautline import entry_points
from tautline.kernels.machine.settings import settings

UNCOMPILED = {"study", "cli", "view", "results"}
"""Rooms of the core in which nothing is compiled, though they speak of kernels."""
COMPILED = {"kernels", "integrators"}
"""Rooms of which every file counts: types, numbers and LLVM's own instructions go into kernels that stand elsewhere."""
LIBRARIES = {"numpy", "numba", "llvmlite", "scipy"}
"""Packages that are known by their version; Python's own modules are known by Python's."""


def kernel_sources(package: str = "tautline") -> dict[str, bytes]:
    """Contents of the files of the core, or of an installed application, that hold compiled code.

    They go by their place in the package. Each is read once and told from others by its text: this is done before the
    first kernel of every run is loaded. An application may be a module of one file.
    """
    spec = util.find_spec(package)
    if spec is not None and spec.submodule_search_locations is None and hasattr(spec.loader, "get_data"):
        loader: Any = spec.loader
        return {f"{package}.py": loader.get_data(spec.origin)}
    roots = list(spec.submodule_search_locations or ()) if spec else []
    return {place: text for root in roots for place, text in sorted(_texts(package, root))}


def _texts(package: str, root: str) -> Iterator[tuple[str, bytes]]:
    """Places and contents of the files below a folder that hold compiled code.

    Numbers that a kernel takes from a file without any are hashed by their values: see `fingerprint`.
    """
    for place in _python_files(root):
        rooms = place.split("/")[:-1]
        if package == "tautline" and not UNCOMPILED.isdisjoint(rooms[:1]):
            continue
        with open(f"{root}/{place}", "rb", buffering=0) as file:
            text = file.read()
        if not COMPILED.isdisjoint(rooms) or b"kernel" in text:
            yield f"{package}/{place}", text


@functools.cache
def packages() -> frozenset[str]:
    """The core and the installed applications."""
    points = entry_points.in_group("tautline.applications")
    return frozenset({"tautline"} | {entry_points.package_of(point) for point in points})


def is_ours(thing: Any) -> bool:
    """Whether a function or class is of the core or of an installed application."""
    return (getattr(thing, "__module__", None) or "").split(".")[0] in packages()


def comes_with_us(thing: Any) -> bool:
    """Whether a function or class is of this program, and not of an application or extension that others wrote."""
    return is_module_of_ours(getattr(thing, "__module__", None) or "")


def is_module_of_ours(name: str) -> bool:
    """Whether a module is one of this program."""
    return name.split(".")[0] in entry_points.packages_of_ours()


IMPORTED = re.compile(rb"^\s*(?:from|import)\s+(\w+)", re.MULTILINE)


@functools.cache
def version_of_numba() -> str:
    """The number of the numba that is installed, which is not loaded for it."""
    if "numba" in sys.modules:
        return str(sys.modules["numba"].__version__)
    return metadata.version("numba")


def hash_of_sources(*more: Any) -> str:
    """Hash of the core's kernel sources, of what compiles them, and of more: of contents alone, wherever they are.

    A release of Python or NumPy that only mends faults compiles the same; numba's and llvmlite's numbers count in full.
    """
    versions = (
        version_of_numba(), llvmlite.__version__, *np.__version__.split(".")[:2], sys.implementation.cache_tag,
        util.MAGIC_NUMBER.hex(), *settings(), *more,
    )  # fmt: skip
    digest = hashlib.sha256(" ".join(map(str, versions)).encode())
    digest.update(hash_of_package("tautline").encode())
    return digest.hexdigest()[:16]


def hash_of_package(package: str) -> str:
    """Hash of the kernel sources of the core, or of an installed application with those that its sources import."""
    digest, seen, waiting = hashlib.sha256(), {"tautline"}, [package]
    while waiting:
        each = waiting.pop()
        texts = kernel_sources(each)
        for place, text in texts.items():
            digest.update(f"{place}\0".encode() + hashlib.sha256(text).digest())
        if each != "tautline":
            others = {name.encode() for name in packages() - seen - {each}}
            # To look for any name is quicker than to look for what is imported, and few files have one.
            speaking = (text for text in texts.values() if any(name in text for name in others))
            named = {name for text in speaking for name in IMPORTED.findall(text)}
            waiting += sorted(name.decode() for name in named & others)
            seen |= {each, *waiting}
    return digest.hexdigest()


@functools.cache
def hash_of_all_sources() -> str:
    """Hash of every Python file of the core and of the applications that come with it: two that agree are one program.

    Line ends do not count: an installation may have those of its machine.
    """
    digest = hashlib.sha256()
    for package in sorted(entry_points.packages_of_ours()):
        spec = util.find_spec(package)
        for root in sorted(spec.submodule_search_locations or ()) if spec else ():
            for place in sorted(_python_files(root)):
                with open(f"{root}/{place}", "rb", buffering=0) as file:
                    text = file.read()
                if b"\r" in text:
                    text = text.replace(b"\r\n", b"\n")
                digest.update(f"{package}/{place}\0{len(text)}\0".encode() + text)
    return digest.hexdigest()[:16]


def _python_files(root: str, inner: str = "") -> Iterator[str]:
    """Places of the Python files below a folder, with slashes; to make paths of them takes half the time."""
    with os.scandir(os.path.join(root, inner)) as found:
        for one in found:
            if one.name.endswith(".py"):
                yield inner + one.name
            elif one.name != "__pycache__" and one.is_dir():
                yield from _python_files(root, f"{inner}{one.name}/")


@functools.cache
def applications_in(*things: Any) -> tuple[str, ...]:
    """Hashes of the installed applications that functions and classes are of; the core's names the folder."""
    return applications_in_packages(*((getattr(thing, "__module__", None) or "").split(".")[0] for thing in things))


def applications_in_packages(*names: str) -> tuple[str, ...]:
    """The same of packages by their names."""
    return tuple(map(_hash_of_application, sorted(set(names) & (packages() - {"tautline"}))))


_hash_of_application = functools.cache(hash_of_package)


def fingerprint(function: Any) -> str:
    """Hash of a function: of its code, and of all functions and constants that it uses, and so on.

    Anything that cannot be told by its contents counts as new: the code that uses it is compiled in each process.
    """
    digest = hashlib.sha256()
    for part in _contents(function, set()):
        digest.update(part.encode() + b"\0")
    return digest.hexdigest()


def own_fingerprint(function: Any) -> str:
    """Hash of a function as it stands in the key of its code: what comes with us has been hashed as files."""
    return _fingerprint_of_ours(function) if comes_with_us(function) else fingerprint(function)


def fingerprints_of_others(kernels: Iterable[Any]) -> tuple[str, ...]:
    """Those of kernels that others wrote."""
    return tuple(fingerprint(each) for each in kernels if not comes_with_us(each))


def _fingerprint_of_ours(function: Any) -> str:
    """Of a function whose sources are hashed as files: of its own code and of what it encloses."""
    digest = hashlib.sha256(function.__code__.co_code)
    for cell in function.__closure__ or ():
        for part in _contents(cell.cell_contents, set()):
            digest.update(part.encode() + b"\0")
    return digest.hexdigest()


def _contents(thing: Any, seen: set[Any]) -> Iterator[str]:
    """Text that changes where a value does that compiled code takes in."""
    if isinstance(thing, enum.Enum):
        yield f"{type(thing).__name__}.{thing.name} {thing.value!r}"
        return
    if isinstance(thing, PLAIN_VALUES):
        yield f"{type(thing).__name__} {thing!r}"
        return
    if id(thing) in seen:
        yield "again"
        return
    seen.add(id(thing))
    function = getattr(thing, "py_func", None) or getattr(thing, "_defn", None) or thing
    if isinstance(thing, np.ndarray):
        yield f"array {thing.dtype} {thing.shape} {hashlib.sha256(np.ascontiguousarray(thing).tobytes()).hexdigest()}"
    elif isinstance(thing, (tuple, list, frozenset)):
        yield f"{type(thing).__name__} {len(thing)} {getattr(type(thing), '_fields', '')}"
        for each in sorted(thing, key=repr) if isinstance(thing, frozenset) else thing:
            yield from _contents(each, seen)
    elif isinstance(thing, dict):
        yield f"dict {len(thing)}"
        for key, value in thing.items():  # pairs of them die, and others get their identities
            yield from _contents(key, seen)
            yield from _contents(value, seen)
    elif isinstance(thing, python_types.ModuleType):
        yield f"module {thing.__name__}"
    elif comes_with_us(function):
        yield f"ours {function.__module__}.{getattr(function, '__qualname__', thing)} {applications_in(function)}"
        for cell in getattr(function, "__closure__", None) or ():
            yield from _contents(cell.cell_contents, seen)
    elif is_known(thing) or is_known(function):
        yield f"known {getattr(thing, '__module__', '')}.{getattr(thing, '__qualname__', thing)}"
    elif isinstance(function, python_types.FunctionType):
        yield f"function {function.__qualname__} {getattr(thing, 'targetoptions', '')}"
        yield from _contents_of_function(function, seen)
    elif isinstance(thing, type):
        yield f"class {thing.__module__}.{thing.__qualname__} {getattr(thing, '_fields', '')}"
        yield from _contents_of_class(thing, seen)
    elif _is_type(thing):
        yield f"type {thing}"
    else:
        yield uuid.uuid4().hex


PLAIN_VALUES = (type(None), bool, int, float, complex, str, bytes, np.generic)


def _contents_of_class(kind: type, seen: set[Any]) -> Iterator[str]:
    """Members of an enumeration, defaults of a named tuple, constants and functions of any class."""
    for base in kind.__mro__[:-1]:
        for name, value in vars(base).items():
            if isinstance(value, (python_types.FunctionType, *PLAIN_VALUES)) and name not in NOT_OF_A_VALUE:
                yield name
                yield from _contents(value, seen)
    yield from _contents(getattr(kind, "_field_defaults", None), seen)
    members: Iterable[Any] = kind if isinstance(kind, enum.EnumMeta) else ()
    for member in members:
        yield from _contents(member, seen)


NOT_OF_A_VALUE = {"__doc__", "__module__", "__qualname__", "__firstlineno__"}
"""What a class has that no compiled code takes in."""


DEFINITIONS = (
    np.ufunc, np.dtype, python_types.BuiltinFunctionType, python_types.ModuleType,
    python_types.MethodDescriptorType, python_types.WrapperDescriptorType,
)  # fmt: skip
"""Kinds of things, beside functions and classes, that a package defines, and that no user makes of its classes."""


def is_known(thing: Any) -> bool:
    """Whether a function, class or object is of a package that is known by its version.

    An object that a user made of a class of such a package, as a callback for C, is not: it has contents of its own.
    """
    if isinstance(thing, python_types.FunctionType):
        return _is_function_of_a_known_package(thing)
    if isinstance(thing, type):
        return _is_class_of_a_known_package(thing)
    module: Any = getattr(thing, "__module__", None) or getattr(type(thing), "__module__", "")
    if not _is_known_module(module) or _is_type(thing):
        return False
    return isinstance(thing, DEFINITIONS) or _is_held(thing, module, type(thing).__module__)


def _is_function_of_a_known_package(function: python_types.FunctionType) -> bool:
    """Whether a function takes its globals from a module of a known package, and goes by the name of one.

    The name alone says little: what `exec` or `eval` makes has none, or that of whose names it was handed, and
    `functools.wraps` gives a function the name of another one.
    """
    room = function.__globals__
    name = room.get("__name__")
    if not _is_known_module(name) or not _is_known_module(function.__module__):
        return False
    return name in sys.modules and vars(sys.modules[name]) is room


def _is_class_of_a_known_package(kind: type) -> bool:
    """Whether a class stands by its own name in a module of a known package; one that `exec` makes may only say so."""
    name = getattr(kind, "__module__", None)
    if not _is_known_module(name) or name not in sys.modules:
        return False
    found: Any = sys.modules[name]
    for part in kind.__qualname__.split("."):
        found = getattr(found, part, None)
    return found is kind


def _is_known_module(name: Any) -> bool:
    """Whether something is the name of a module of a package that is known by its version."""
    return isinstance(name, str) and _is_known_package(name.split(".")[0])


def _is_held(thing: Any, *modules: str) -> bool:
    """Whether one of some modules, or of their packages, has an object among its names."""
    places = dict.fromkeys(name for module in modules for name in (module, module.split(".")[0]))
    held = (vars(sys.modules[name]) for name in places if name in sys.modules and _is_known_package(name.split(".")[0]))
    return any(one is thing for names in held for one in names.values())


@functools.cache
def _is_known_package(name: str) -> bool:
    """Whether a package is known by its version; a user's own ``wave.py`` is not, for all that Python has one too."""
    if name in LIBRARIES:
        return True
    if name not in sys.stdlib_module_names or name == "__main__":
        return False
    file = getattr(sys.modules.get(name), "__file__", None)
    rooms = os.path.dirname(os.__file__), os.path.join(sys.base_prefix, "DLLs")
    return file is None or any(os.path.realpath(file).startswith(os.path.realpath(room) + os.sep) for room in rooms)


def _is_type(thing: Any) -> bool:
    """Whether this is a type of numba's; there is none as long as numba is not loaded."""
    return "numba" in sys.modules and isinstance(thing, sys.modules["numba"].types.Type)


def _contents_of_function(function: python_types.FunctionType, seen: set[Any]) -> Iterator[str]:
    yield from _contents_of_code(function.__code__, seen)
    yield from _contents(function.__defaults__, seen)
    yield from _contents(function.__kwdefaults__, seen)
    for each in _implementations(function):
        yield from _contents(each, seen)
    for cell in function.__closure__ or ():
        try:
            yield from _contents(cell.cell_contents, seen)
        except ValueError:  # a name that has no value yet
            yield "empty"
    names = sorted(names_in(function.__code__))
    for name in sorted(globals_in(function.__code__)):
        if name not in function.__globals__:
            continue
        value = function.__globals__[name]
        yield f"global {name}"
        yield from _contents(value, seen)
        if isinstance(value, python_types.ModuleType):
            yield from _contents_of_module(value, names, seen)


def _implementations(function: python_types.FunctionType) -> Iterator[python_types.FunctionType]:
    """What numba takes for a function that is written for Python alone: its overloads."""
    if "numba" not in sys.modules:
        return
    templates = sys.modules["numba"].core.typing.templates
    for named, its_type in templates.builtin_registry.globals:
        if named is function:
            found = (getattr(one, "_overload_func", None) for one in getattr(its_type, "templates", ()))
            yield from (one for one in found if one is not None)


def _contents_of_module(module: python_types.ModuleType, names: list[str], seen: set[Any]) -> Iterator[str]:
    """What a function may take of a module: all that goes by one of the names in its code, in its packages too."""
    package = module.__name__.split(".")[0]
    if _is_known_package(package):
        return
    if package in entry_points.packages_of_ours():
        yield from applications_in_packages(package)
        return
    for name in names:
        if name in vars(module):
            value = vars(module)[name]
            yield f"{module.__name__}.{name}"
            yield from _contents(value, seen)
            # Another function takes other names of the same module: a module was seen only as far as its names go.
            if isinstance(value, python_types.ModuleType) and (way := (id(value), *names)) not in seen:
                seen.add(way)
                yield from _contents_of_module(value, names, seen)


def _contents_of_code(code: python_types.CodeType, seen: set[Any]) -> Iterator[str]:
    yield f"{code.co_code.hex()} {code.co_names} {code.co_varnames} {code.co_freevars} {code.co_cellvars}"
    for constant in code.co_consts:
        if isinstance(constant, python_types.CodeType):
            yield from _contents_of_code(constant, seen)
        else:
            yield from _contents(constant, seen)


def names_in(code: python_types.CodeType) -> set[str]:
    """Names that a function, and those inside of it, look up outside: globals and attributes of anything."""
    return set(code.co_names).union(*map(names_in, _inner(code)))


def globals_in(code: python_types.CodeType) -> set[str]:
    """Those of them that are looked up in its module; an attribute of a group may go by the same name as a function."""
    found = {one.argval for one in dis.get_instructions(code) if one.opname in ("LOAD_GLOBAL", "LOAD_NAME")}
    return found.union(*map(globals_in, _inner(code)))


def _inner(code: python_types.CodeType) -> Iterator[python_types.CodeType]:
    """Functions inside of a function."""
    return (constant for constant in code.co_consts if isinstance(constant, python_types.CodeType))
