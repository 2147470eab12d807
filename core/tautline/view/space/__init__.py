"""Results in space by PyVista: appearance, colours, camera, windows, pictures, films."""
