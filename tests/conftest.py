"""Makes the folders of tests importable, as `references.soft_string`, and Ctrl-C heard by all tests."""

import signal
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parent))

# A shell starts what runs in the background with Ctrl-C ignored, and its children with it; tests of Ctrl-C need it.
if signal.getsignal(signal.SIGINT) is signal.SIG_IGN:
    signal.signal(signal.SIGINT, signal.default_int_handler)
