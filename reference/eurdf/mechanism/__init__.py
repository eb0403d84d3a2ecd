"""The mechanism as plain data; it imports nothing of the project beside itself."""
