"""Planar frames: what they are made of, and what their analyses return."""

from rbsdem.checks.infills import infills as infills
from rbsdem.model.frame import FrameMember as FrameMember
from rbsdem.model.frame import FrameNode as FrameNode
from rbsdem.model.frame import Member as Member
from rbsdem.model.shape import TeeSection as TeeSection
from rbsdem.run.building_result import BuildingResult as BuildingResult
from rbsdem.run.frame_result import FrameResult as FrameResult
from rbsdem.section.frame import Frame as Frame
from rbsdem.section.infill import Infill as Infill
from rbsdem.section.panel import JointPanel as JointPanel
