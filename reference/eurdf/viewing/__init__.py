"""A robot to look at and to move, with its loops closed: in a browser, and as a picture."""
