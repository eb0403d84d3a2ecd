"""How a parser's process is started, asked with a time-out, and ended; and what can happen on the way."""
