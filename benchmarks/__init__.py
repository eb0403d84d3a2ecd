"""Measurements, each as a ratio to a named peer in the same run, on one thread.

Threads of OpenBLAS wait actively for a while, which would count as time of the processor for whatever runs next.
"""

import os

for _library in ("OPENBLAS", "OMP", "MKL"):
    os.environ.setdefault(f"{_library}_NUM_THREADS", "1")  # before NumPy is imported
