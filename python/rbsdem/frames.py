"""Planar frames: what they are made of, and what their analyses return."""

from rbsdem.model.frame import FrameMember as FrameMember
from rbsdem.model.frame import FrameNode as FrameNode
from rbsdem.model.frame import FrameParts as FrameParts
from rbsdem.model.frame import FrameSpring as FrameSpring
from rbsdem.model.frame import Member as Member
from rbsdem.model.frame import MemberGeometry as MemberGeometry
from rbsdem.model.frame_result import FrameEvent as FrameEvent
from rbsdem.model.frame_result import FrameEvents as FrameEvents
from rbsdem.model.frame_result import FrameResult as FrameResult
from rbsdem.model.frame_result import MemberHistory as MemberHistory
from rbsdem.model.shape import TeeSection as TeeSection
from rbsdem.run.analysis import FrameModes as FrameModes
from rbsdem.section.building import Frame as Frame
from rbsdem.section.panel import JointPanel as JointPanel
from rbsdem.section.panel import panel_strength as panel_strength
