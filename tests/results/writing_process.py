"""Writes batches to the file named by its argument, as fast as it can, until it is killed; prints a line after each.

Frame k holds k in every variable, so that a reader can see whether all of it is there.
"""

import sys

import numpy as np

from tautline.results.store import Store
from tautline.results.variable import Variable

BODIES, FRAMES = 13, 20


def variables():
    names = [Variable(f"quantity{i}", ("time", "body"), "N", "a quantity") for i in range(6)]
    return [
        *names,
        Variable("position", ("time", "body", "axis"), "m", "position"),
        Variable("hook_load", ("time",), "N", ""),
    ]


def batch(first, frames=FRAMES):
    k = np.arange(first, first + frames, dtype=float)
    values = {"time": k, "hook_load": k}
    values |= {f"quantity{i}": np.repeat(k, BODIES).reshape(-1, BODIES) for i in range(6)}
    return values | {"position": np.repeat(k, 3 * BODIES).reshape(-1, BODIES, 3)}


def write(path, batches):
    store = Store(path, variables(), {"axis": np.array(["north", "east", "down"])}, {"scene": "a: 1"})
    print("ready", flush=True)
    for number in range(batches):
        store.append(batch(number * FRAMES))
        print(store.frames, flush=True)
    store.finish({"status": "done"}, restart={"q": np.arange(4.0)})
    print("finished", flush=True)


if __name__ == "__main__":
    write(sys.argv[1], int(sys.argv[2]))
