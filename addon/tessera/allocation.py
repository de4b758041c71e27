"""Memory for temporaries: kept by the process between calls, where the C library would give it back each time."""

from __future__ import annotations

import numpy as np

# The largest block that glibc may be taught to keep (on 64-bit systems).
_LARGEST = (1 << 25) - (1 << 16)


def keep_freed_memory() -> None:
    """Let the C library reuse freed arrays of up to 32 MB instead of returning their pages to the system.

    glibc takes larger arrays than 128 kB from the system, page by page, and returns them when they are freed, until a
    block that it had taken so is freed: then it keeps blocks of up to that size. A stage's temporaries are of some 100
    kB, so that fetching pages was a third to a half of the time of many array operations. Without effect elsewhere.
    """
    block = np.empty(_LARGEST, dtype=np.uint8)
    del block
