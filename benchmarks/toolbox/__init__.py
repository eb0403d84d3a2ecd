"""The published toolbox, function by function: a table of rows, each run on both sides, and the page made of it."""
