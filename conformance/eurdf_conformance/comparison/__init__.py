"""What is expected against what a parser gave: the result is a list of differences, empty where the two agree."""
