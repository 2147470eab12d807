"""A table for which its disk has no room: an error in words, the file as it was before, and Python goes on."""

import re
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
WRITERS = {
    "sweep": """
from tautline.sweeps.table import Variables, write_netcdf
def write(n, path):
    write_netcdf(Variables.of({"a": ("case", np.arange(1.0, n + 1))}, {"case": ("case", np.arange(n))}, {}), path)
""",
    "study": """
from tautline.study.record import write_netcdf
def write(n, path):
    write_netcdf([{"a": float(k), "b": float(k)} for k in range(1, n + 1)], {"scene": "x"}, path)
""",
}
"""`operability` writes by that of sweeps, and `stick-slip` as a study does."""
PROGRAM = """
import resource, sys
from pathlib import Path
import numpy as np
from tautline.results.errors import WriteError
path = Path(sys.argv[1])
write(10, path)
before = path.read_bytes()
# A limit on the size of files stands for a disk without room: HDF5 is refused at the same place.
resource.setrlimit(resource.RLIMIT_FSIZE, (92_160, resource.RLIM_INFINITY))
for n in (5600, 7000):
    try:
        write(n, path)
        print("written")
    except WriteError as error:
        print(str(error).partition(": ")[2].partition(";")[0])
print("as it was" if path.read_bytes() == before else "another file")
"""


@pytest.mark.skipif(sys.platform == "win32", reason="the limit on the size of files is of POSIX")
@pytest.mark.parametrize("writer", WRITERS)
def test_a_table_without_room_is_refused_and_neither_the_file_nor_python_suffers(writer, tmp_path):
    program = "import numpy as np\n" + WRITERS[writer] + PROGRAM
    found = subprocess.run([sys.executable, "-c", program, tmp_path / "a.nc"], capture_output=True, text=True)
    assert found.returncode == 0, found.stderr
    assert found.stdout.splitlines() == 2 * ["cannot be written: File too large"] + ["as it was"]
    assert not found.stderr
    assert [one.name for one in tmp_path.iterdir()] == ["a.nc"]


def test_no_table_is_written_by_hdf5_itself():
    """It would lose what the disk refuses; the store reserves its room before, and has a test of its own."""
    sources = [*(ROOT / "core").rglob("*.py"), *(ROOT / "apps").rglob("*.py")]
    of_hdf5 = re.compile(r"h5netcdf\.File\((?!made,)|\.to_netcdf\(|netCDF4|h5py\.File\([^)]*\"[wa]\"")
    found = {one.name for one in sources if of_hdf5.search(one.read_text(encoding="utf8"))}
    assert found == {"large.py", "layout.py"}
