"""What each simulator makes of exported robots with loops: ``python -m benchmarks simulators``."""
