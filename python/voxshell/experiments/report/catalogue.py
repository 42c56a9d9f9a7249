"""All experiments, in the order in which the report tells them."""

from __future__ import annotations

from voxshell.experiments.experiment import Experiment
from voxshell.experiments.report.accuracy import ACCURACY
from voxshell.experiments.report.ball import BALL
from voxshell.experiments.report.bunny import BUNNY
from voxshell.experiments.report.everyday import EVERYDAY
from voxshell.experiments.report.gears import GEARS
from voxshell.experiments.report.geometry import GEOMETRY
from voxshell.experiments.report.nut import NUT
from voxshell.experiments.report.pair import PAIR
from voxshell.experiments.report.pour import POUR
from voxshell.experiments.report.rates import RATES
from voxshell.experiments.report.rest import REST
from voxshell.experiments.report.scaling import SCALING
from voxshell.experiments.report.segments import SEGMENTS
from voxshell.experiments.report.slope import SLOPE
from voxshell.experiments.report.stack import STACK

EXPERIMENTS: tuple[Experiment, ...] = (
    BALL,
    STACK,
    BUNNY,
    SEGMENTS,
    RATES,
    PAIR,
    POUR,
    REST,
    SLOPE,
    NUT,
    GEARS,
    ACCURACY,
    GEOMETRY,
    EVERYDAY,
    SCALING,
)
