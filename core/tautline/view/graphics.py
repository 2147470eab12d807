"""Loading PyVista, and saying clearly what is missing where it cannot draw."""

from __future__ import annotations

import contextlib
import ctypes
import os
import sys
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
    """Return PyVista, ready to draw off screen where there is no display.

    Raises
    ------
    ResultError
        If it is not installed, or OpenGL is missing.
    """
    if not has_display():
        # Without a display VTK would try the X server first, and complain.
        os.environ.setdefault(WINDOW_SYSTEM, "vtkEGLRenderWindow")
    try:
        import pyvista
        from vtkmodules.vtkCommonCore import vtkLogger
    except ImportError as error:
        raise ResultError("render", f"cannot draw: {error}", "`pip install pyvista`; " + CURE) from None
    vtkLogger.SetStderrVerbosity(vtkLogger.VERBOSITY_OFF)
    check_opengl()
    pyvista.global_theme.allow_empty_mesh = True
    return pyvista


def opens_windows() -> bool:
    """Whether there is a screen, and it can be reached; raises ResultError as `graphics` does."""
    if not has_display():
        return False
    graphics()
    from vtkmodules.vtkRenderingCore import vtkRenderWindow

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

    window = vtkRenderWindow()
    window.SetOffScreenRendering(1)
    without = window.IsA("vtkOSOpenGLRenderWindow") and not _loads(*OSMESA)
    if without or not window.SupportsOpenGL():
        raise ResultError("render", "there is no OpenGL to draw with", CURE)


def _loads(*libraries: str) -> bool:
    """Whether one of some shared libraries can be loaded."""
    for name in libraries:
        with contextlib.suppress(OSError):
            ctypes.CDLL(name)
            return True
    return False
