"""What is expected against what a reader gave: the result is a list of differences, empty where the two agree."""
