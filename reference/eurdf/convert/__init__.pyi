"""The public names, each with the module that defines it."""

from eurdf.convert.coordinates import Coordinates as Coordinates
from eurdf.convert.export import Export as Export
from eurdf.convert.import_robot import Import as Import
from eurdf.convert.losses import Loss as Loss
from eurdf.convert.same_motion import SameMotion as SameMotion
from eurdf.convert.simplify import Simplification as Simplification
from eurdf.writing.rewriting import RobotSize as RobotSize
