"""The public names, each with the module that defines it."""

from eurdf.viewing.shown import ShownRobot as ShownRobot
from eurdf.viewing.viewer import Viewer as Viewer
