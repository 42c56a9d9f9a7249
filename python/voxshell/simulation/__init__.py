"""Worlds in stock Bullet, with bodies and joints. Only this folder and `robots` need Bullet."""

from voxshell import _bullet
from voxshell.base.compiled import keep_compiled
from voxshell.simulation.body import Body
from voxshell.simulation.comparison_shapes import ConvexDecomposition, ConvexHull, GImpact
from voxshell.simulation.compound import Compound
from voxshell.simulation.joint_kinds import FixedJoint, HingeJoint, PointJoint, SliderJoint
from voxshell.simulation.joints import Joint, Reaction
from voxshell.simulation.live_view import LiveView
from voxshell.simulation.material import Material
from voxshell.simulation.recorder import Recorder
from voxshell.simulation.state import WorldState
from voxshell.simulation.world import World

__all__ = [
    "Body",
    "Compound",
    "ConvexDecomposition",
    "ConvexHull",
    "FixedJoint",
    "GImpact",
    "HingeJoint",
    "Joint",
    "LiveView",
    "Material",
    "PointJoint",
    "Reaction",
    "Recorder",
    "SliderJoint",
    "World",
    "WorldState",
]

keep_compiled(_bullet)
