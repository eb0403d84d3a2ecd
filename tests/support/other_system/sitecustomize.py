"""Lets a process of Linux lack what Windows lacks; Python imports it at the start if its folder is in PYTHONPATH."""

# The standard library, which does the same in another way on Windows, first takes what it needs.
import asyncio  # noqa: F401
import concurrent.futures  # noqa: F401
import logging.handlers  # noqa: F401
import multiprocessing.pool  # noqa: F401
import os
import select
import shutil  # noqa: F401
import signal
import ssl  # noqa: F401
import subprocess  # noqa: F401
import sys
import tempfile  # noqa: F401

MODULES = ("fcntl", "grp", "pty", "pwd", "resource", "syslog", "termios", "tty")
NAMES = {
    os: "O_CLOEXEC O_DIRECTORY O_NOCTTY O_NOFOLLOW O_NONBLOCK chown fork forkpty getegid geteuid getgid getuid killpg "
    "lchown mkfifo set_blocking setsid waitid",
    select: "epoll poll",
    signal: "ITIMER_PROF SIGALRM SIGCHLD SIGHUP SIGPIPE SIGPROF SIGXCPU SIGXFSZ alarm setitimer",
}

for module in MODULES:
    sys.modules[module] = None  # type: ignore[assignment]
for owner, names in NAMES.items():
    for name in names.split():
        if hasattr(owner, name):
            delattr(owner, name)
