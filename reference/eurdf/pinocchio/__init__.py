"""The mechanism as a Pinocchio robot: model, constraint models, actuation, geometry."""
