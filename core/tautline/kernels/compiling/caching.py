"""The cache for parts: in our folder, a file for each, and never a reason for a run to fail.

Only a compiler asks for it. What is machine code is kept in files of our own (:mod:`tautline.kernels.machine.code`).

What cannot be read is as good as absent: it is compiled and written anew. The key of a kernel holds the contents of all
that goes into it and is no part of the core or of an installed application.
"""

from __future__ import annotations

import contextlib
import functools
import glob
import hashlib
import inspect
import io
import os
import pickle
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from numba.core import sigutils, types
from numba.core.caching import CompileResultCacheImpl, FunctionCache, _CacheLocator
from numba.core.compiler import CompileResult
from numba.core.serialize import NumbaPickler

from tautline.kernels.compiling.inlined import Reader
from tautline.kernels.machine import storage
from tautline.kernels.machine.code import DIGEST, KERNELS_OF, save
from tautline.kernels.machine.settings import PLAIN
from tautline.kernels.machine.sources import applications_in, fingerprints_of_others, own_fingerprint

SUFFIX = ".nbc"


class Locator(_CacheLocator):
    """Where a function's code is kept."""

    def __init__(self, function: Any, file: str) -> None:
        self._py_file, self._lineno = file, function.__code__.co_firstlineno
        self._folder = function.__module__ or "nowhere"

    def get_cache_path(self) -> str:
        """Folder to write to."""
        return self.path(storage.folder_to_write())

    def path(self, folder: Path | None) -> str:
        """Folder of the function below one of ours."""
        return os.path.join(folder or os.devnull, self._folder)

    def get_source_stamp(self) -> str:
        """The contents are in the keys."""
        return "tautline"

    def get_disambiguator(self) -> str:
        """The line, as numba has it."""
        return str(self._lineno)


class Files:
    """One file for each compiled signature of a function, in one folder.

    The name of a file follows from its key: what is kept is found without a list that processes would have to write one
    after another, and two that compile the same write the same.
    """

    def __init__(self, folder: str, name: str) -> None:
        self._folder, self._name = Path(folder), name

    def load(self, key: Any) -> Any:
        """What is kept under a key, None where there is nothing.

        Raises
        ------
        ValueError
            For a damaged file.
        """
        try:
            data = self._path(key).read_bytes()
        except OSError:
            return None
        if hashlib.sha256(data[:-DIGEST]).digest() != data[-DIGEST:]:
            raise ValueError(f"{self._path(key).name} is damaged")
        return pickle.loads(data)

    def save(self, key: Any, data: Any) -> None:
        """Write code."""
        with io.BytesIO() as written:
            _Pickler(written, protocol=4).dump(data)
            contents = written.getvalue()
        self._folder.mkdir(parents=True, exist_ok=True)
        # What reads it stops where the object ends; what follows tells whether the file is whole.
        save(self._path(key), contents + hashlib.sha256(contents).digest())

    def flush(self) -> None:
        """Remove what is kept of the function."""
        for file in self._folder.glob(f"{glob.escape(self._name)}.*{SUFFIX}"):
            file.unlink()

    def _path(self, key: Any) -> Path:
        return self._folder / f"{self._name}.{hashlib.sha256(repr(key).encode()).hexdigest()[:24]}{SUFFIX}"


class _Pickler(NumbaPickler):
    """Names classes of a user's script, which numba would write out: what is read would be of another class then."""

    def reducer_override(self, held: Any) -> Any:
        main = sys.modules.get("__main__")
        if isinstance(held, type) and held.__module__ == "__main__" and vars(main).get(held.__qualname__) is held:
            return NotImplemented
        return super().reducer_override(held)


class Code(CompileResultCacheImpl):
    """How a compiled function is written and read."""

    def __init__(self, function: Any, file: str) -> None:
        self._lineno = function.__code__.co_firstlineno
        self._locator = Locator(function, file)
        base = os.path.splitext(os.path.basename(file))[0]
        name = f"{base}.{function.__qualname__}"
        self._filename_base = self.get_filename_base(name, getattr(sys, "abiflags", ""))

    def rebuild(self, context: Any, payload: Any) -> Any:
        """Make the function of what numba's own wrote."""
        if PLAIN:
            found = super().rebuild(context, payload)
        else:
            found = CompileResult._rebuild(Reader(context), *payload)._replace(target_context=context)
        # What compiles this one in needs the same (numba forgets it).
        found.library._reload_init.update(found.reload_init)
        return found


class PartCache(FunctionCache):
    """The cache of one of our parts. What it cannot do is not done: the function is compiled."""

    _impl_class = Code

    def __init__(self, function: Any) -> None:
        self._name, self._py_func = repr(function), function
        self._impl = Code(function, inspect.getfile(function))
        self._files: dict[str, Files] = {}
        self._keys: dict[Any, Any] = {}
        self._enabled = True

    @property
    def cache_path(self) -> str:
        """Folder to write to."""
        return self._impl.locator.get_cache_path()

    def _file(self, folder: Path | None) -> Files:
        path = self._impl.locator.path(folder)
        if path not in self._files:
            self._files[path] = Files(path, self._impl.filename_base)
        return self._files[path]

    def _places(self) -> Iterator[Files]:
        """Where code may be: in the folder that is kept, and in its stand-in."""
        folders = [storage.kept_folder()]
        if storage.folder_to_write.cache_info().currsize:
            folders.append(storage.folder_to_write())
        yield from (self._file(folder) for folder in dict.fromkeys(folders) if folder is not None)

    def flush(self) -> None:
        """Forget what is kept."""
        with contextlib.suppress(Exception):
            self._file(storage.folder_to_write()).flush()

    def load_overload(self, signature: Any, context: Any) -> Any:
        """Load code, None if there is none that can be used.

        Numba makes its compiler ready first, with all functions that it knows, which takes a quarter of a second. What
        comes from the cache needs none of them, and where nothing comes it is made ready before it compiles.
        """
        if not self._enabled:
            return None
        arguments = sigutils.normalize_signature(signature)[0]
        if PLAIN:
            context.refresh()
        for files in self._places():
            with contextlib.suppress(Exception):  # whatever a damaged file raises
                data = files.load(self._index_key(signature, context.codegen()))
                found = None if data is None else self._impl.rebuild(context, data)
                if found is not None and tuple(found.signature.args) == tuple(arguments):
                    return found
        return None

    def save_overload(self, signature: Any, compiled: Any) -> None:
        """Keep code; a disk that is full, or a folder that is gone, is said once."""
        if not self._enabled or storage.folder_to_write() is None:
            return
        try:
            if self._impl.check_cachable(compiled):
                key = self._index_key(signature, compiled.codegen)
                self._file(storage.folder_to_write()).save(key, self._impl.reduce(compiled))
        except OSError as error:
            storage.say_not_kept(error.strerror or str(error))
        except (pickle.PicklingError, TypeError, AttributeError) as error:
            storage.say_not_kept(f"{self._py_func.__qualname__}: {error}")

    def _index_key(self, signature: Any, codegen: Any) -> Any:
        """The types by what they are, so that a list can be read without them; the function and others' kernels."""
        known = signature, _target_of(codegen)
        if known not in self._keys:
            self._keys[known] = self._new_key(signature, codegen)
        return self._keys[known]

    def _new_key(self, signature: Any, codegen: Any) -> Any:
        arguments = sigutils.normalize_signature(signature)[0]
        classes = list(dict.fromkeys(each for kind in arguments for each in _classes_in(kind)))
        described = [f"{each.__module__}.{each.__qualname__}{each._fields}" for each in classes]
        kernels = [each for one in classes for kernels in KERNELS_OF for each in kernels(one)]
        own = own_fingerprint(self._py_func)
        applications = applications_in(self._py_func, *classes, *kernels)
        return (str(arguments), *described), _target_of(codegen), (own, *applications, *fingerprints_of_others(kernels))


@functools.cache
def _target_of(codegen: Any) -> tuple[str, ...]:
    """What numba's code generator compiles for, which stays as it is; numba asks LLVM for the processor each time."""
    return codegen.magic_tuple()


def _classes_in(kind: types.Type) -> Iterator[type]:
    """Classes of the named tuples in a type."""
    if isinstance(kind, types.TypeRef):
        yield from _classes_in(kind.instance_type)
    elif isinstance(kind, types.BaseTuple):
        if hasattr(kind, "instance_class"):
            yield kind.instance_class
        for part in dict.fromkeys(kind.types):
            yield from _classes_in(part)
