"""What matplotlib logs of a home that it cannot write to, in one plain sentence: in a process of a command alone."""

from __future__ import annotations

import logging
import warnings

from tautline.errors import TautlineWarning

LIBRARY = "matplotlib"
REASONS = ("mkdir -p failed for path", "%s is not a writable directory")
"""How it begins to say why it has no folder."""
OUTCOME = "Matplotlib created a temporary cache directory"
"""How it begins to say what it does without one."""


def retell() -> None:
    """Tell it in our words from now on; everything else that matplotlib logs stays as it is.

    For a process that was started for a command: elsewhere matplotlib's log is that of whoever imports it.
    """
    logging.getLogger(LIBRARY).addFilter(_left)


def _left(record: logging.LogRecord) -> bool:
    """Whether a record is left to matplotlib."""
    told = str(record.msg)
    if told.startswith(OUTCOME):
        text = (
            "matplotlib has no folder to keep its list of fonts in. Figures take longer. Set MPLCONFIGDIR to a folder"
        )
        warnings.warn(text, TautlineWarning, stacklevel=2)
    return not told.startswith((OUTCOME, *REASONS))
