"""Another onnxruntime than the one the extension ships: it works, or the error says what was found and what to do.

The others are the real wheels of requirements/other_wheels.lock, each first on the path of a Python of its own. They
are fetched into wheels/ when they are needed first, and where that cannot be, these tests are skipped and say so.
"""

import importlib.metadata
import os
import subprocess
import sys
import zipfile

import pytest

from scripts.fetch_wheels import OTHERS, ROOT, WHEELS, fetch, locked, unlike_the_lock
from tessera import RuntimeProblem
from tessera.runtime import open_session

HERE = f"cp{sys.version_info[0]}{sys.version_info[1]}"
MESH = """
import onnxruntime, tessera
print(onnxruntime.__version__)
report = tessera.mesh([[(0, 0), (4, 0), (4, 3), (0, 3)]], 0.5).report
print(report.n_triangles, report.q_worst > 0.8, report.q_mean > 0.9)
"""


def others():
    """The names of the locked wheels for this Python; on Linux only, as they are."""
    return [name for _, name in locked(OTHERS) if f"-{HERE}-" in name and sys.platform == "linux"]


@pytest.fixture(params=others() or [None])
def other(request, tmp_path):
    """A folder that holds another onnxruntime, and its version."""
    if request.param is None:
        pytest.skip("no other onnxruntime is locked for this Python and platform")
    if not (WHEELS / request.param).exists():
        WHEELS.mkdir(exist_ok=True)
        try:
            fetch(request.param)
        except subprocess.CalledProcessError as error:
            pytest.skip(f"{request.param} cannot be fetched: {error}")
    assert request.param not in unlike_the_lock(OTHERS)
    zipfile.ZipFile(WHEELS / request.param).extractall(tmp_path)
    return tmp_path, request.param.split("-")[1]


def run(code, *path):
    """The finished process of a Python that finds onnxruntime in the given folders first."""
    environment = os.environ | {"PYTHONPATH": os.pathsep.join(map(str, [*path, ROOT / "addon"]))}
    return subprocess.run([sys.executable, "-c", code], env=environment, capture_output=True, text=True, timeout=60)


def test_another_onnxruntime_meshes(other):
    folder, version = other
    ran = run(MESH, folder)
    assert ran.returncode == 0, ran.stderr
    found, mesh = ran.stdout.splitlines()
    assert found == version != importlib.metadata.version("onnxruntime")
    assert mesh.split()[1:] == ["True", "True"] and 100 < int(mesh.split()[0]) < 200


def test_an_onnxruntime_without_its_compiled_part_is_named_with_its_place_and_the_remedy(other):
    folder, version = other
    for compiled in (folder / "onnxruntime" / "capi").glob("*pybind11_state*"):
        compiled.unlink()
    ran = run(MESH.replace("import onnxruntime, tessera\nprint(onnxruntime.__version__)", "import tessera"), folder)
    said = ran.stderr.strip().splitlines()[-1]
    assert ran.returncode == 1 and said.startswith("tessera.runtime.RuntimeProblem: ")
    assert f"onnxruntime {version}, found in '{folder / 'onnxruntime'}', cannot load" in said
    assert "works with onnxruntime 1.19 to 1.32" in said and "disable or update" in said


def test_no_onnxruntime_at_all_is_said():
    code = "import sys; sys.modules['onnxruntime'] = None; " + MESH.replace(
        "import onnxruntime, tessera", "import tessera"
    )
    said = run(code.replace("print(onnxruntime.__version__)", "")).stderr.strip().splitlines()[-1]
    assert "RuntimeProblem: onnxruntime is not installed. Tessera's zip brings it" in said


def test_a_network_that_cannot_be_read_is_named(tmp_path):
    broken = tmp_path / "nn1.onnx"
    broken.write_bytes(b"no network")
    with pytest.raises(RuntimeProblem, match=r"onnxruntime [\d.]+, found in .* cannot load the network nn1.onnx: "):
        open_session(broken)
