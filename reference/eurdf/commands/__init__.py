"""The command line: one module for each command."""

#: Exit code of a program that SIGINT (Ctrl-C) ended: 128 plus the number of the signal.
INTERRUPTED = 130
