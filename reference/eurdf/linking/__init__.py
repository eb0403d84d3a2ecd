"""From the two parsed files to one mechanism: every name looked up, every rule that needs both files."""
