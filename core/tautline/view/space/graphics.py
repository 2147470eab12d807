"""Loading PyVista, and saying clearly what is missing where it cannot draw."""

from __future__ import annotations

import contextlib
import ctypes
import os
import sys
from collections.abc import Iterator
from functools import cache
from typing import Any

from tautline.results.errors import ResultError

CURE = "install a software renderer (Debian and Ubuntu: `apt install libegl1 libgl1-mesa-dri`), or use `export --vtk`"
OSMESA = ("libOSMesa.so.8", "libOSMesa.so.6", "libOSMesa.so", "osmesa.dll", "libOSMesa.8.dylib")
WINDOW_SYSTEM = "VTK_DEFAULT_OPENGL_WINDOW"


def has_display() -> bool:
    """Whether there is a screen to open a window on."""
    if sys.platform.startswith("linux"):
        return bool(os.environ.get("DISPLAY") or os.environ.get("WAYLAND_DISPLAY"))
    return True


@cache
def graphics() -> Any:
    """Return PyVista, once it is known that it can draw.

    Raises
    ------
    ResultError
        If it is not installed, or OpenGL is missing.
    """
    try:
        import pyvista
    except ImportError as error:
        raise ResultError("render", f"cannot draw: {error}", "`pip install pyvista`; " + CURE) from None
    check_opengl()
    return pyvista


def new_plotter(**given: Any) -> Any:
    """A PyVista plotter that draws off screen where there is no display; raises ResultError as `graphics` does.

    It has a theme of its own: that of the process stays as the user has set it.
    """
    pyvista = graphics()
    theme = pyvista.themes.Theme()
    theme.load_theme(pyvista.global_theme)
    theme.allow_empty_mesh = True
    with _without_a_word():
        return pyvista.Plotter(theme=theme, **given)


@contextlib.contextmanager
def _without_a_word() -> Iterator[None]:
    """Let render windows be made inside without a search for an X server that is not there, and its complaints."""
    from vtkmodules.vtkCommonCore import vtkLogger

    before, loud = os.environ.get(WINDOW_SYSTEM), vtkLogger.GetCurrentVerbosityCutoff()
    if before is None and not has_display():
        os.environ[WINDOW_SYSTEM] = "vtkEGLRenderWindow"
    vtkLogger.SetStderrVerbosity(vtkLogger.VERBOSITY_OFF)
    try:
        yield
    finally:
        vtkLogger.SetStderrVerbosity(vtkLogger.ConvertToVerbosity(int(loud)))
        if before is None:
            os.environ.pop(WINDOW_SYSTEM, None)


def opens_windows() -> bool:
    """Whether there is a screen, and it can be reached; raises ResultError as `graphics` does."""
    if not has_display():
        return False
    graphics()
    from vtkmodules.vtkRenderingCore import vtkRenderWindow

    with _without_a_word():
        window = vtkRenderWindow()
    return not (window.IsA("vtkEGLRenderWindow") or window.IsA("vtkOSOpenGLRenderWindow"))


def check_opengl() -> None:
    """Refuse to go on where nothing can draw: VTK would end the process.

    VTK tries the X server, EGL and at last OSMesa, without looking whether that is installed.

    Raises
    ------
    ResultError
        If there is no OpenGL.
    """
    import vtkmodules.vtkRenderingOpenGL2  # noqa: F401  (it makes render windows real)
    from vtkmodules.vtkRenderingCore import vtkRenderWindow

    with _without_a_word():
        window = vtkRenderWindow()
        window.SetOffScreenRendering(1)
        without = window.IsA("vtkOSOpenGLRenderWindow") and not _loads(*OSMESA)
        draws = not without and window.SupportsOpenGL()
    if not draws:
        raise ResultError("render", "there is no OpenGL to draw with", CURE)


def _loads(*libraries: str) -> bool:
    """Whether one of some shared libraries can be loaded."""
    for name in libraries:
        with contextlib.suppress(OSError):
            ctypes.CDLL(name)
            return True
    return False
