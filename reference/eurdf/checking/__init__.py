"""`eurdf.load` and `eurdf.check`: the files of a robot in, the robot or what is wrong with it out."""
