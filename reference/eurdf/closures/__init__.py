"""The kinds of loop closure and of coupling, one file each: what they state, and the mathematics of it."""
