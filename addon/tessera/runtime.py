"""onnxruntime, as it is found: another add-on, or another program, may have brought one that is broken or too old."""

from __future__ import annotations

import importlib.metadata
import importlib.util
import sys
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    import onnxruntime

MODELS = Path(__file__).resolve().parents[2] / "onnx_models"
KNOWN = "1.19 to 1.32"  # the versions that were tried
_REMEDY = (
    "If another add-on brought it, disable or update that one; else install Tessera again. Then start Blender (or "
    "Python) anew, as one that was loaded stays until then."
)


class RuntimeProblem(ImportError):
    """onnxruntime is missing, broken, or cannot load the networks; the message says which, where, and what to do."""


def open_session(path: Path, threads: int = 1, provider: str = "CPUExecutionProvider") -> onnxruntime.InferenceSession:
    """A session of the network in that file; on the CPU, where there is no such provider. Raises RuntimeProblem."""
    try:
        import onnxruntime

        options = onnxruntime.SessionOptions()
        options.log_severity_level = 3
        options.intra_op_num_threads = threads
        # Threads that wait by spinning slow everything else down, and calls here are many and short.
        options.add_session_config_entry("session.intra_op.allow_spinning", "0")
        wanted = dict.fromkeys([provider, "CPUExecutionProvider"])
        providers = [name for name in wanted if name in onnxruntime.get_available_providers()]
        return onnxruntime.InferenceSession(path, options, providers=providers)
    except Exception as error:  # onnxruntime's own errors have no base class but this
        raise RuntimeProblem(_message(path, error)) from error


def _message(path: Path, error: Exception) -> str:
    cause = (str(error).strip() or repr(error)).splitlines()[0].rstrip(".")
    spec = importlib.util.find_spec("onnxruntime")
    if spec is None:
        return f"onnxruntime is not installed. Tessera's zip brings it: install the one for this platform. ({cause}.)"
    places = [spec.origin] if spec.origin else list(spec.submodule_search_locations or [])
    folder = Path(places[0]).parent if spec.origin else places[0]
    return (
        f"onnxruntime {_version()}, found in '{folder}', cannot load the network {path.name}: {cause}. "
        f"Tessera works with onnxruntime {KNOWN}. {_REMEDY}"
    )


def _version() -> str:
    """That of the module, or where it could not be imported, that of the package."""
    if version := getattr(sys.modules.get("onnxruntime"), "__version__", ""):
        return version
    try:
        return importlib.metadata.version("onnxruntime")
    except importlib.metadata.PackageNotFoundError:
        return "of an unknown version"
