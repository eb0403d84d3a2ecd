"""Claims of the comparison with other formats that were seen by running, and their reruns."""
