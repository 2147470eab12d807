"""Files of machine code: how one is named, written, read, and brought into a process.

A file holds the machine code of one kernel for arguments of one form, what it needs besides, and a checksum. Its name
is a hash of all that goes into the code, so there is no list of files that would have to be kept in order. What cannot
be read is as good as absent.
"""

from __future__ import annotations

import contextlib
import functools
import hashlib
import json
import os
import threading
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any, NamedTuple

import llvmlite.binding as llvm
import numpy as np

from tautline.kernels.machine import storage
from tautline.kernels.machine.sources import applications_in, fingerprints_of_others, own_fingerprint
from tautline.kernels.machine.targets import instructions, shipped_target, target
from tautline.kernels.memory import Form, classes_in, text_of

KERNELS_OF: list[Callable[[type], Iterator[Any]]] = []
"""Each gives the kernels that compiled code calls for a class of named tuples among its arguments."""
FINDERS: dict[str, Callable[[str], None]] = {}
"""By the beginning of a symbol, what has LLVM know where such a symbol is."""
ROUTINES: list[Callable[[], None]] = []
"""Each has LLVM know the routines of a compiler, which machine code may call; asked last, for it loads the compiler."""
SUFFIX = ".code"
DIGEST = hashlib.sha256().digest_size


class Stored(NamedTuple):
    """Machine code of a kernel, as a file holds it.

    ``symbol`` is its name in the object file ``code``; ``returned`` is the form of what it gives back, None where
    Python could not take it; ``needed`` are the symbols that it refers to.
    """

    symbol: str
    returned: Form
    needed: tuple[str, ...]
    code: bytes


Name = tuple[str, str | None]
"""A file's name in the folder of this machine's own code, and in that of installed code."""


def name_of(function: Any, forms: tuple[Form, ...]) -> Name:
    """What the code of a kernel for arguments of some forms is kept under."""
    classes = list(dict.fromkeys(each for form in forms for each in classes_in(form)))
    kernels = [each for one in classes for kernels in KERNELS_OF for each in kernels(one)]
    contents = [
        function.__qualname__, str(function.__code__.co_firstlineno), *map(text_of, forms),
        own_fingerprint(function), *applications_in(function, *classes, *kernels), *fingerprints_of_others(kernels),
    ]  # fmt: skip
    triple, processor, features = target()
    level = shipped_target()
    short = function.__qualname__.replace("<", "").replace(">", "")[-60:]
    return (
        f"{short}-{_hash(*contents, triple, processor, features)}{SUFFIX}",
        None if level is None else f"{short}-{_hash(*contents, triple, level, '')}{SUFFIX}",
    )  # fmt: skip


def _hash(*parts: str) -> str:
    return hashlib.sha256("\0".join(parts).encode()).hexdigest()[:24]


def read(function: Any, name: Name) -> Iterator[Stored]:
    """Code that is kept for a kernel: what is installed, what is in the folder that is kept, and in its stand-in."""
    own, shipped = name
    places = [(storage.shipped_folder(), shipped)] if shipped else []
    places.append((storage.kept_folder(), own))
    if storage.folder_to_write.cache_info().currsize and storage.folder_to_write() != storage.kept_folder():
        places.append((storage.folder_to_write(), own))
    for folder, file in places:
        if folder is not None and file is not None:
            with contextlib.suppress(Exception):  # whatever a damaged file raises
                yield _from_bytes((folder / _room(function) / file).read_bytes())


def write(function: Any, name: Name, stored: Stored) -> None:
    """Keep code; a disk that is full, or a folder that is gone, is said once."""
    folder = storage.folder_to_write()
    if folder is None:
        return
    try:
        room = folder / _room(function)
        room.mkdir(parents=True, exist_ok=True)
        save(room / name[0], _to_bytes(stored))
    except OSError as error:
        storage.say_not_kept(error.strerror or str(error))
    except TypeError as error:
        storage.say_not_kept(f"{function.__qualname__}: {error}")


def save(path: Path, contents: bytes) -> None:
    """Write a file as a whole, or not at all."""
    beside = path.with_name(f"{path.name}.{os.getpid()}.{threading.get_ident()}.tmp")
    try:
        beside.write_bytes(contents)
        os.replace(beside, path)
    except BaseException:
        with contextlib.suppress(OSError):
            beside.unlink()
        raise


def _room(function: Any) -> str:
    """Folder of a function's code below one of ours."""
    return function.__module__ or "nowhere"


def _to_bytes(stored: Stored) -> bytes:
    head = {"symbol": stored.symbol, "returned": _encode_form(stored.returned), "needed": stored.needed}
    contents = json.dumps(head).encode() + b"\n" + stored.code
    return hashlib.sha256(contents).digest() + contents


def _from_bytes(data: bytes) -> Stored:
    contents = memoryview(data)[DIGEST:]
    if hashlib.sha256(contents).digest() != data[:DIGEST]:
        raise ValueError("the file is damaged")
    end = data.index(b"\n", DIGEST)
    head = json.loads(data[DIGEST:end])
    return Stored(head["symbol"], _decode_form(head["returned"]), tuple(head["needed"]), data[end + 1 :])


_NUMBERS: dict[str, Form] = {"float": float, "int": int, "bool": bool, "none": type(None)}


def _encode_form(returned: Form) -> Any:
    """The form of what is given back, for JSON: the name of a number, a list for a tuple, None where there is none."""
    if isinstance(returned, tuple):
        return [_encode_form(part) for part in returned[1:]]
    if returned is None:
        return None
    return next((name for name, form in _NUMBERS.items() if form is returned), str(returned))


def _decode_form(encoded: Any) -> Form:
    """The form that `_encode_form` made this of."""
    if isinstance(encoded, list):
        return tuple, *map(_decode_form, encoded)
    if encoded is None:
        return None
    return _NUMBERS[encoded] if encoded in _NUMBERS else np.dtype(encoded)


# -- into a process ----------------------------------------------------------------------------------------------------


_linking = threading.Lock()
_linked: dict[tuple[str, int], int] = {}
"""Addresses of what was brought into the process, by symbol and a hash of the code."""


@functools.cache
def _engine() -> Any:
    """What brings object files into memory and links them: LLVM's own, of which numba has another.

    Of a symbol that comes twice, in code that was changed, it knows the address of the last.
    """
    llvm.initialize_native_target()
    llvm.initialize_native_asmprinter()
    described = llvm.Target.from_triple(llvm.get_process_triple())
    machine = described.create_target_machine(
        cpu=llvm.get_host_cpu_name(), features=instructions(), opt=3, codemodel="jitdefault", jit=True,
        reloc="static" if described.name.startswith("x86") else "default",  # as numba compiles
    )  # fmt: skip
    return llvm.create_mcjit_compiler(llvm.parse_assembly(""), machine)


def load(stored: Stored) -> int | None:
    """Bring code into the process, and give its address; None where something that it refers to is not to be had.

    A symbol that is missing would end the process, with LLVM's words.
    """
    for symbol in stored.needed:
        if not _is_known(symbol):
            return None
    known = stored.symbol, hash(stored.code)
    with _linking:
        if known not in _linked:
            engine = _engine()
            engine.add_object_file(llvm.ObjectFileRef.from_data(stored.code))
            engine.finalize_object()
            _linked[known] = int(engine.get_function_address(stored.symbol))
        return _linked[known] or None


def _is_known(symbol: str) -> bool:
    """Whether LLVM knows a symbol, or does once it was told."""
    for beginning, find in FINDERS.items():
        if symbol.startswith(beginning):
            find(symbol)
            return True
    if llvm.address_of_symbol(symbol):
        return True
    for name_them in ROUTINES:
        name_them()
    return bool(llvm.address_of_symbol(symbol))
