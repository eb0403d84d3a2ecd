"""Starts a parser's process, sends requests with a time-out, ends the process, and names each possible outcome."""
