"""The one decorator of compiled code, and the folder its cache lives in.

Numba caches a compiled function under the time stamp of its own file only: an edited callee in another file
leaves a stale caller behind (numba issue 1833). The cache folder is therefore named by a hash of all kernel
sources, of the core and of every installed application: a changed kernel means a new folder, nobody ever has to
delete one, and old ones are removed here.
"""

from __future__ import annotations

import functools
import hashlib
import os
import shutil
import sys
from importlib import metadata, util
from pathlib import Path
from typing import Any

import numba
from numba import njit, types
from numba.core.caching import Cache, IndexDataCacheFile
from numba.core.registry import CPUDispatcher
from numba.extending import overload
from numba.np import arrayobj

from tautline.kernels import compiler as _quicker  # noqa: F401  what it replaces in numba is all that it does
from tautline.kernels.parts import KernelCompiler, PartCompiler

FOLDERS_KEPT = 6
"""Cache folders kept beside the one in use: other checkouts and versions that a user may go back to."""


UNCOMPILED = ("study", "cli", "view", "results")
"""Folders of the core in which nothing is compiled, though they speak of kernels."""


def kernel_sources() -> list[Path]:
    """Files of the core and of the installed applications that hold compiled code."""
    sources = []
    for package in sorted(_packages()):
        spec = util.find_spec(package)
        for root in spec.submodule_search_locations if spec and spec.submodule_search_locations else []:
            sources += [f for f in sorted(Path(root).rglob("*.py")) if _is_compiled(f)]
    return sources


def _packages() -> set[str]:
    """The core and the installed applications."""
    points = metadata.entry_points(group="tautline.applications")
    return {"tautline"} | {point.value.split(".")[0] for point in points}


def _is_compiled(source: Path) -> bool:
    """Whether a file holds compiled code, or constants that are compiled in."""
    if source.parent.name in UNCOMPILED:
        return False
    return source.parent.name == "integrators" or b"kernel" in source.read_bytes()


@functools.cache
def cache_folder() -> Path:
    """Folder of this version's compiled kernels, created if it is not there."""
    digest = hashlib.sha256(f"{numba.__version__} {sys.version}".encode())
    for source in kernel_sources():
        digest.update(str(source).encode() + source.read_bytes())
    root = _cache_root()
    folder = root / digest.hexdigest()[:16]
    if not folder.exists():
        folder.mkdir(parents=True, exist_ok=True)
        _prune(root, keep=folder)
    else:
        os.utime(folder)
    return folder


def _cache_root() -> Path:
    if "TAUTLINE_CACHE" in os.environ:
        return Path(os.environ["TAUTLINE_CACHE"])
    from platformdirs import user_cache_path

    return user_cache_path("tautline", appauthor=False) / "kernels"


def _prune(root: Path, keep: Path) -> None:
    folders = sorted((f for f in root.iterdir() if f.is_dir() and f != keep), key=lambda f: f.stat().st_mtime)
    for folder in folders[: max(0, len(folders) - FOLDERS_KEPT)]:
        shutil.rmtree(folder, ignore_errors=True)


def _mend_index() -> None:
    """Three repairs of numba's cache index, one file a function that lists its compiled signatures.

    It is read once while it stays as it is: a run loads dozens of signatures of one function. It counts as empty where
    it names classes that cannot be imported here: a group may live in a user's own script, and one run of it would
    otherwise stop all runs elsewhere. And processes write it one after another: two that compile different signatures
    at once would give them the same file, and one of them would later be run as the other.
    """
    load, save = IndexDataCacheFile._load_index, IndexDataCacheFile.save
    known: dict[str, tuple[Any, dict]] = {}

    def load_index(self: IndexDataCacheFile) -> dict:
        try:
            file = os.stat(self._index_path)
        except OSError:
            return {}
        stamp = file.st_mtime_ns, file.st_size, file.st_ino
        if known.get(self._index_path, (None,))[0] != stamp:
            try:
                known[self._index_path] = stamp, load(self)
            except (ImportError, AttributeError):
                return {}
        return dict(known[self._index_path][1])

    def save_alone(self: IndexDataCacheFile, key: Any, data: Any) -> None:
        from filelock import FileLock

        with FileLock(f"{self._index_path}.lock"):
            save(self, key, data)

    IndexDataCacheFile._load_index = load_index
    IndexDataCacheFile.save = save_alone


def _trust_indices() -> None:
    """Compile the indices of our kernels as they stand: none counts from the end of its array.

    Numba makes a negative index count from the end, which takes three instructions for every index and keeps loops from
    being vectorised: a fifth to a third of the run time. Code of other packages that numba compiles in this process
    keeps its meaning. With NUMBA_BOUNDSCHECK=1 a negative index in a kernel is an IndexError.
    """
    ours, as_written = _packages(), arrayobj.fix_integer_index

    def fix_integer_index(context: Any, builder: Any, kind: Any, index: Any, size: Any) -> Any:
        if not kind.signed or context.fndesc is None or context.fndesc.modname.split(".")[0] not in ours:
            return as_written(context, builder, kind, index, size)
        return context.cast(builder, index, kind, types.intp)

    arrayobj.fix_integer_index = fix_integer_index


def _look_before_preparing() -> None:
    """Look into the cache before numba's compiler is made ready, which takes a quarter of a second.

    Numba makes it ready first, with all functions that it knows. What comes from the cache needs none of them.
    """

    def load_overload(self: Cache, signature: Any, target: Any) -> Any:
        with self._guard_against_spurious_io_errors():
            found = self._load_overload(signature, target)
            if found is not None:
                return found
        target.refresh()
        return None

    Cache.load_overload = load_overload


_trust_indices()
_mend_index()
_look_before_preparing()
numba.config.CACHE_DIR = str(cache_folder())

entry = functools.partial(
    njit,
    cache=True,
    nogil=True,
    error_model="numpy",
    no_cfunc_wrapper=True,
    _nrt=False,
    fastmath={"contract"},
    pipeline_class=KernelCompiler,
)
"""Decorator of compiled code that Python calls: cached across processes, releases the GIL.

``_nrt=False`` takes numba's reference counts away: they are half of the time of a small kernel, and without them code
that would allocate an array does not compile. The time loop allocates nothing, by construction. ``contract`` lets a
product and a sum be one instruction with one rounding; no sum is reordered, and what is no number stays so.
"""


class Inner(CPUDispatcher):
    """Compiled code that only compiled code can call."""

    def get_call_template(self, args: Any, kws: Any) -> Any:
        """Compile for a call; once for all whole numbers, not once more for each that stands in a call.

        Where the code is inlined the number is still known, and what depends on it is left out there.
        """
        kinds = tuple(types.unliteral(kind) if isinstance(kind, types.IntegerLiteral) else kind for kind in args)
        return super().get_call_template(kinds, kws)

    def __call__(self, *args: Any, **kwargs: Any) -> Any:
        """Refuse; without this the process would end, for there is nothing that could take Python's objects."""
        raise TypeError(f"{self.py_func.__qualname__} can be called by compiled code only; its .py_func by Python")


def addressed(function: Any = None, **options: Any) -> Any:
    """Decorator of compiled code that is called by its address.

    It goes without the wrappers that unpack a scene's many arrays, which would take longer to compile than the code.
    """
    if function is None:
        return functools.partial(addressed, **options)
    compiled = entry(no_cpython_wrapper=True, **options)(function)
    if isinstance(compiled, CPUDispatcher):
        compiled.__class__ = Inner
    return compiled


kernel = functools.partial(addressed, pipeline_class=PartCompiler)
"""Decorator of compiled code that only compiled code calls, as a part of it."""

stands_for = functools.partial(overload, jit_options={"pipeline_class": PartCompiler})
"""Decorator of a function of types that returns what compiled code calls for them: ``@stands_for(stub)``."""


def is_compiled(function: Any, signature: tuple[types.Type, ...]) -> bool:
    """Whether a kernel is compiled for the types of its arguments, in this process or in the cache."""
    if signature in function.overloads:
        return True
    key = function._cache._index_key(signature, function.targetctx.codegen())
    return key in function._cache._cache_file._load_index()


def address_of(function: Any, signature: tuple[types.Type, ...]) -> int:
    """Address of a kernel's machine code for the types of its arguments, compiled or loaded now if it was not yet.

    It follows numba's own calling convention and stays where it is for the life of the process.
    """
    if signature not in function.overloads:
        function.compile(signature)
    compiled = function.overloads[signature]
    return int(compiled.library.get_pointer_to_function(compiled.fndesc.llvm_func_name))
