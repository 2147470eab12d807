"""Pictures: the only importers of matplotlib."""

from tautline.view.words_of_matplotlib import retell

retell()  # before any module of this package imports matplotlib
