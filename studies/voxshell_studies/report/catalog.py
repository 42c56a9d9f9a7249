"""All experiments, in the order of the report."""

from __future__ import annotations

from voxshell_studies.experiment import Experiment
from voxshell_studies.report.accuracy import ACCURACY
from voxshell_studies.report.ball import BALL
from voxshell_studies.report.bunny import BUNNY
from voxshell_studies.report.everyday.experiment import EVERYDAY
from voxshell_studies.report.gears import GEARS
from voxshell_studies.report.geometry.experiment import GEOMETRY
from voxshell_studies.report.limits import LIMITS
from voxshell_studies.report.nut import NUT
from voxshell_studies.report.pair import PAIR
from voxshell_studies.report.pour import POUR
from voxshell_studies.report.rates import RATES
from voxshell_studies.report.rest import REST
from voxshell_studies.report.scaling import SCALING
from voxshell_studies.report.segments import SEGMENTS
from voxshell_studies.report.slope import SLOPE
from voxshell_studies.report.stack import STACK

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
    LIMITS,
    SCALING,
)
