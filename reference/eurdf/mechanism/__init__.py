"""The mechanism as plain data, and every rule that needs both files to be judged."""
