"""The column of a section: by the layered model, or by that of the paper."""

from __future__ import annotations

from dataclasses import replace
from functools import cache, lru_cache
from typing import Any, Literal, TypeAlias, get_args, overload

from rbsdem import _arguments
from rbsdem.errors import InputError, warn
from rbsdem.model.column import MOST_BODIES, Column, Footing, Top
from rbsdem.model.frame import FrameMember
from rbsdem.model.materials import CONCRETE_DENSITY
from rbsdem.model.shape import Section, checked_section
from rbsdem.model.springs import Elastic, Pinching, Spring, Takeda, unchecked
from rbsdem.model.wall import WallSection
from rbsdem.section.curvature import column_length
from rbsdem.section.layered import LayeredColumn, LayeredModel, area_of_rest, body_lengths, lumping
from rbsdem.section.paper import springs
from rbsdem.section.parameters import VERSION, ModelParameters, parameters
from rbsdem.section.shear import shear_spring
from rbsdem.section.spans import Pair, beam_spans
from rbsdem.section.strength import axial_failure_law, nominal_moment, shear_failure_drift

Model: TypeAlias = Literal["layered", "paper"]
"""Name of a model."""

MODELS: tuple[str, ...] = get_args(Model)
"""Names of the models."""

DEFAULT: Model = "layered"
"""The model that is taken if none is named."""

#: Shares of what was fitted to columns by which bars of beams grow stronger with their range of
#: strain, and wear: they go much farther, and with the whole of it would have more than their
#: strength in tension. Chosen on the loops of one subassembly (`studies/frames_measured.py`).
_BARS_OF_BEAMS = {"isotropic_hardening": 0.25, "fatigue": 0.5}
#: Ties that hold less than this share of the axial load hold none of it.
_LEAST_TIES = 1e-3
#: Force at the nominal moment over strength in shear, up to which columns fail in flexure.
_IN_FLEXURE = 0.6


def model_name(model: str, model_parameters: ModelParameters | None = None) -> str:
    """Return the name of a model with the version of its parameters, as "layered 2026.8".

    Parameters
    ----------
    model : str
        "layered" or "paper", which has no fitted parameters.
    model_parameters
        As for `column`.

    Raises
    ------
    InputError
        If there is no such model.
    """
    model = _arguments.choice(model, "model", MODELS)
    if model != "layered":
        return model
    return f"{model} {_known(model_parameters).label}"


def _known(model: ModelParameters | None) -> ModelParameters:
    """Return checked parameters, those of the version if none are given."""
    if model is None:
        return parameters()
    remedy = "as of rbsdem.section.parameters()"
    return _arguments.instance(model, "model_parameters", ModelParameters, remedy)


@overload
def column(
    section: Section,
    height: float,
    *,
    axial_load: float,
    mass: float | None = None,
    n: int | None = None,
    model: Literal["layered"] = "layered",
    model_parameters: ModelParameters | None = None,
    axial_height: float | None = None,
    restrained: int | None = None,
    round_core: bool = False,
    top: Top = "free",
    footing: Footing | None = None,
    shear_span: float | None = None,
) -> LayeredColumn: ...
@overload
def column(
    section: Section,
    height: float,
    *,
    axial_load: float,
    mass: float | None = None,
    n: int | None = None,
    model: Model,
    model_parameters: ModelParameters | None = None,
    axial_height: float | None = None,
    restrained: int | None = None,
    round_core: bool = False,
    top: Top = "free",
    footing: Footing | None = None,
) -> Column: ...
def column(
    section: Section,
    height: float,
    *,
    axial_load: float,
    mass: float | None = None,
    n: int | None = None,
    model: Model = DEFAULT,
    model_parameters: ModelParameters | None = None,
    axial_height: float | None = None,
    restrained: int | None = None,
    round_core: bool = False,
    top: Top = "free",
    footing: Footing | None = None,
    shear_span: float | None = None,
) -> Column:
    """Return the column with this section, with second-order effects of the axial load.

    Parameters
    ----------
    section : Section
        The section.
    height : float
        From the foot to the lateral load [m]; with a fixed top the clear height between both
        ends.
    axial_load : float
        Compression positive [N].
    mass : float, optional
        Mass of the column [kg]; by default that of its volume and
        `CONCRETE_DENSITY`.
    n : int, optional
        Number of bodies, by default 1 in "paper" and 2 in "layered", which needs as many.
    model : {"layered", "paper"}, optional
        "layered": a hinge of concrete and steel layers with bar slip at the foot, elastic
        joints above it (`rbsdem.section.hinge`), in series a shear spring that cracks, fails
        and pinches (`rbsdem.section.shear`). "paper": one component with trilinear Takeda
        flexure and bilinear shear by the section analysis, as the paper has them; with `n`
        above 1, joints with the section's springs of their tributary lengths above that hinge.
    model_parameters : ModelParameters, optional
        Parameters of the layered model other than those of `rbsdem.section.parameters()`.
    axial_height : float, optional
        Height at which the axial load acts, from the foot [m]; by default that of the column.
        The sections carry `axial_load`, and the column has its second-order moment at this
        height.
    restrained : int, optional
        Longitudinal bars held in a corner of a hoop or by a tie, for the confinement in the
        layered model. By default the four corners, and four more for each leg beyond two,
        in proportion for a part of a leg.
    round_core : bool, optional
        Whether the ties of a rectangular section stand for a spiral around a round core.
    top : {"free", "fixed"}, optional
        "fixed": double curvature, with the hinge and the shear spring of half the height at
        both ends (`Column.double_curvature`, prismatic); `n` is then the number of bodies of
        each half.
    footing : Footing, optional
        A footing on springs that the column stands on.
    shear_span : float, optional
        Moment over shear at the foot of a wall, where it is not the height, see
        `rbsdem.section.wall` [m].

    Returns
    -------
    Column
        A `LayeredColumn`, which knows its section and the version of its parameters, or for
        "paper" a plain `rbsdem.Column`.

    Raises
    ------
    InputError
        If a value is refused, or the section cannot carry the axial load.

    Examples
    --------
    >>> bars = Layout(12, 0.016, Steel(446e6, 702e6))
    >>> ties = Ties(0.007, 0.085, Steel(364e6, 521e6), legs=4)
    >>> section = RectangularSection(
    ...     0.4, 0.4, Concrete(46.5e6), layout=bars, ties=ties, cover=0.013
    ... )
    >>> column = rbsdem.section.column(section, 1.6, axial_load=744e3)
    >>> column.n, column.version
    (2, '2026.8')
    """
    checked_section(section)
    model = _arguments.choice(model, "model", MODELS)
    top = _arguments.choice(top, "top", get_args(Top))
    load = _arguments.number(axial_load, "axial_load")
    if restrained is not None:
        restrained = _arguments.integer(restrained, "restrained")
    round_core = _arguments.boolean(round_core, "round_core")
    if n is not None and not 1 <= _arguments.integer(n, "n") <= MOST_BODIES:
        raise InputError(f"n = {n} must be from 1 to {MOST_BODIES}")
    _check_lap(section, top)
    # The half between an end and the point of contraflexure is a cantilever.
    halves = 2 if top == "fixed" else 1
    height = column_length(height, "height") / halves
    if mass is None:
        mass = section.gross_area * height * CONCRETE_DENSITY
    else:
        mass = _arguments.number(mass, "mass") / halves
    if axial_height is not None:
        axial_height = _arguments.number(axial_height, "axial_height")
    if shear_span is not None:
        shear_span = column_length(shear_span, "shear_span")
    common = {
        "mass": mass,
        "axial_load": load,
        # At the top it needs no height, so that the column can be given other kinematics.
        "axial_height": None if axial_height == height else axial_height,
        "kinematics": "pdelta",
    }
    made: Column
    if model == "paper":
        given: dict[str, Any] = {"model_parameters": model_parameters, "restrained": restrained}
        given |= {"shear_span": shear_span}
        for name, value in (given | {"round_core": round_core or None}).items():
            if value is not None:
                raise InputError(f"{name} is for model = 'layered'; remove it")
        made = _paper(section, height, load, 1 if n is None else n, common)
    else:
        hoops = restrained, round_core
        made = _layered(section, height, load, n, model_parameters, hoops, shear_span, common)
    if top == "fixed":
        made = made.double_curvature()
    return made if footing is None else replace(made, footing=footing)


def _check_lap(section: Section, top: Top) -> None:
    """Refuse a lap at both ends, and say what one at the foot does not do."""
    lap = getattr(section, "lap", None)
    if lap is None:
        return
    if top == "fixed":
        raise InputError(
            "column: lap is at the foot alone, and in double curvature both ends would have it; "
            "make it a member of a frame (section.member)"
        )
    share = min(section.lapped(steel) for _, _, steel in section.bars)
    if share < 1.0:
        warn(
            f"lap of {lap.length:g} m: bars are limited to {share:.2f} f_y; loss of strength after "
            "that is not modelled, and lapped columns lost a fifth of it at less than half of the "
            "drift of the model"
        )


def member(
    section: Section | tuple[Section, Section],
    length: float,
    *,
    axial_load: float = 0.0,
    model_parameters: ModelParameters | None = None,
    restrained: int | None = None,
    rigid_end: float | tuple[float, float] = 0.0,
    load: float = 0.0,
    shear_spans: tuple[Pair, Pair] | None = None,
    name: str = "",
) -> FrameMember:
    """Return the kind of members of a frame with this section: each half is a layered column.

    From each end to the middle the member is a cantilever of the layered model: a joint of layers
    with bar slip at the end, a joint that cracks between it and the middle, and a shear spring in
    series, whose strength is that of M/V where both ends yield. The axial force is that of the
    frame; `axial_load` only chooses what the model takes from it (length and softening of the
    hinge, strength in shear). Beams have none. A member under axial load that has failed in shear
    loses this load at the drift of `rbsdem.section.strength.axial_failure_drift`; columns whose
    hinges yield first, at more than 0.6 of the strength in shear, fail in shear at the drift of
    `rbsdem.section.strength.shear_failure_drift`.

    Parameters
    ----------
    section : Section or pair of Section
        The section, or those of its two halves, as of a beam with more bars over one support; y > 0
        is up in a beam, on the left of the way from start to end.
    length : float
        Clear length between its ends [m]; a frame refuses it for members of another one.
    axial_load : float, optional
        Compression under the dead load [N].
    model_parameters, restrained
        As for `column`; by default bars of members without axial load grow stronger with their
        range of strain by a quarter of what those of columns do, and wear by half of it.
    load : float, optional
        Load that acts in its span toward y < 0, as on a beam under a floor [N/m]: a joint of
        layers, without slip of bars, then stands in the middle too, where the span yields, and all
        of the member is cracked from the first, as its ends are.
    shear_spans : pair of pairs of float, optional
        M/V of the strength in shear [m] at start and end, with y > 0 in tension and in compression;
        by default those of ends that yield under the load (`rbsdem.section.spans.beam_spans`).
    rigid_end, name
        As for `FrameMember`.

    Raises
    ------
    InputError
        If a value is refused, or the section cannot carry the axial load.
    """
    halves = tuple(section) if isinstance(section, (tuple, list)) else (section, section)
    if len(halves) != 2:
        raise InputError(f"member: {len(halves)} sections; give one, or one for each half")
    if any(isinstance(half, WallSection) for half in halves):
        raise InputError(
            "member: a wall in a frame has springs of its own M/V; use rbsdem.section.wall_members"
        )
    if halves[0] == halves[1] and getattr(halves[1], "lap", None) is not None:
        # Bars of a column are lapped at its foot.
        halves = halves[0], replace(halves[1], lap=None)  # type: ignore[call-arg]
    length = column_length(length, "length")
    axial_load = _arguments.number(axial_load, "axial_load")
    if restrained is not None:
        restrained = _arguments.integer(restrained, "restrained")
    load = _arguments.number(load, "load", least=0.0)
    values = _known(model_parameters) if model_parameters or axial_load else _of_beams()
    start = end = _half(halves[0], length, axial_load, values, restrained)
    if halves[1] != halves[0]:
        end = _half(halves[1], length, axial_load, values, restrained)
    spans = shear_spans or _spans(halves, length, axial_load, load)
    # Equal halves with equal spans are made once.
    alike = end is start and spans[0] == spans[1]
    sides = [(start, spans[0]), (end, spans[1])][: 1 if alike else 2]
    shears = [_shear(*side) for side in sides]
    fails, falls = shears[0], shears[-1]
    ((_, above), bodies), ((_, below), others) = start.bending, end.bending
    near, far = bodies[0] / length, others[0] / length
    failures = [
        _failure(half, own[0], shear)
        for (half, own), shear in zip(sides, shears, strict=True)
        if axial_load > 0
    ]
    drift = min((drift for drift, _, _ in failures), default=None)
    failure_load = min((load for _, load, _ in failures), default=None)
    modulus, area, depth = (
        0.5 * (one + other) for one, other in zip(*map(_elastic, halves), strict=True)
    )
    joints: dict[float, Any] = {0.0: start.joint.spring, 1.0: end.joint.spring}
    if load > 0.0:
        # Between two cracked joints the rest is cracked too. It turns by its mean moment under the
        # load, so that nothing is made up for lumping.
        above, below = (
            unchecked(Elastic, k=spring.k_y / lumping(2)) if isinstance(spring, Takeda) else spring
            for spring in (above, below)
        )
        dry = values.with_values(slip_length=0.0)
        # Bars that are more over one support end before the middle.
        least = min(halves, key=lambda half: half.steel_area)
        middle = LayeredModel(least, 0.5 * length, axial_load, 2, dry, restrained)
        joints[0.5] = middle.joint.spring
    return FrameMember(
        modulus=modulus,
        area=area_of_rest(area, modulus, length, joints.values()),
        inertia=area * depth**2 / 12,
        flexure={**joints, near: above, 1 - far: below.mirrored()},
        shear={
            0.0: fails,
            0.5 * near: start.no_slip,
            1 - 0.5 * far: end.no_slip,
            1.0: falls.mirrored(),
        },
        interior="rigid",
        rigid_end=rigid_end,
        length=length,
        name=name,
        failure_drift=drift,
        failure_load=failure_load,
        shear_drift=min((one for _, _, one in failures if one is not None), default=None),
        sections=halves,
        shear_spans=spans,
    )


def _spans(
    halves: tuple[Section, Section], length: float, axial_load: float, load: float
) -> tuple[Pair, Pair]:
    """Return M/V of ends that yield; the middle of the length where they are alike."""
    half = 0.5 * length, 0.5 * length
    if halves[0] == halves[1] and halves[0].symmetric and not load > 0.0:
        return half, half
    try:
        start, end = (plastic_moments(half, axial_load) for half in halves)
    except InputError:
        return half, half
    return beam_spans(start, end, length, load)


@lru_cache(maxsize=1024)
def plastic_moments(section: Section, axial_load: float) -> Pair:
    """Return the nominal moments of a section with y > 0 in tension and in compression [N m].

    Raises
    ------
    InputError
        If the section does not carry the axial load.
    """
    first = nominal_moment(section, axial_load)
    second = first if section.symmetric else nominal_moment(section.mirrored, axial_load)
    if not min(first, second) > 0.0:
        raise InputError(f"the section has no moment under an axial load of {axial_load:.4g} N")
    return first, second


@cache
def _of_beams() -> ModelParameters:
    """Return the parameters of members without axial load, whose bars harden and wear less."""
    fitted = parameters()
    shares = {name: share * fitted.values[name] for name, share in _BARS_OF_BEAMS.items()}
    return fitted.with_values(**shares)


def _half(
    section: Section,
    length: float,
    axial_load: float,
    values: ModelParameters,
    restrained: int | None,
) -> LayeredModel:
    """Return the half of a member as a cantilever, and tell what is odd about it."""
    _check_lap(checked_section(section), "free")
    model = LayeredModel(section, 0.5 * length, axial_load, 2, values, restrained)
    _check_own(model)
    if notes := model.notes:
        warn("; ".join(notes))
    return model


def _check_own(model: LayeredModel) -> None:
    """Refuse values of parameters that a user gave and that a column cannot have."""
    # Those of another version are meant for all columns, and are cut to the limits of each.
    if model.parameters.version == VERSION and model.parameters is not _of_beams():
        model.check(model.parameters.own)


def _shear(half: LayeredModel, spans: Pair) -> Pinching:
    """Return the shear spring of a half for its shear spans."""
    drawn = half.section, half.height, half.axial_load, half.joint.shear_stiffness
    return shear_spring(*drawn, half.parameters, half.joint, spans=spans)[0]


def _elastic(section: Section) -> tuple[float, float, float]:
    """Return E_c [Pa], gross area [m2] and depth [m], of which the elastic part is made."""
    return section.concrete_law["ec"], section.gross_area, section.depth


def _failure(half: LayeredModel, span: float, shear: Pinching) -> tuple[float, float, float | None]:
    """Return at what drifts a member whose hinges have yielded fails.

    The drift at axial failure under no load, the load that halves it [N], and the drift at shear
    failure; None where bending limits the member.
    """
    section, axial_load = half.section, half.axial_load
    drift, halves = axial_failure_law(section)
    force = nominal_moment(section, axial_load) / span
    # Below that share of its strength in shear it is flexure that limits a column (ASCE 41-17).
    critical = force > _IN_FLEXURE * shear.f_y
    # Without ties any load falls at once.
    load = max(halves, _LEAST_TIES * axial_load)
    return drift, load, shear_failure_drift(section, force, axial_load) if critical else None


def _layered(
    section: Section,
    height: float,
    axial_load: float,
    n: int | None,
    model_parameters: ModelParameters | None,
    hoops: tuple[int | None, bool],
    shear_span: float | None,
    common: dict[str, Any],
) -> LayeredColumn:
    """Return a cantilever of the layered model; `common` are its arguments for all models."""
    if n == 1:
        raise InputError("n = 1: the layered model needs a joint above the hinge; give 2 or more")
    hinge = section, height, axial_load, n or 2
    drawing = LayeredModel(*hinge, _known(model_parameters), *hoops, shear_span)
    _check_own(drawing)
    made = LayeredColumn(height, n=drawing.n, drawing=drawing, **drawing.made, **common)
    if notes := drawing.notes:
        warn("; ".join(notes))
    return made


def _paper(
    section: Section, height: float, axial_load: float, n: int, common: dict[str, Any]
) -> Column:
    """Return a cantilever of the paper's model; `common` are its arguments for all models."""
    # Columns of high axial load are controlled by compression: they yield there.
    made = springs(section, height, axial_load, yield_rule="first")
    shear: Spring | None = made.shear
    if shear is None:
        # Knee of the shear diagram in closed form: 0.48 of the uncracked stiffness.
        stiffness = 0.48 * section.concrete_law["ec"] / 2 * section.gross_area
        shear = Elastic(stiffness / height)
    flexure = [made.flexure]
    lengths = None
    if n > 1:
        # Each joint has its share of the slip, and the curvature of its part.
        shear = shear.split(n)
        lengths, part = body_lengths(height, made.hinge_length, n)
        above = made.flexure.scaled(made.hinge_length / (part / lumping(n)))
        # A spring of its own for each joint, no longer that of a whole column.
        flexure += [above] * (n - 1)
    sizes: Any = {"n": n, "lengths": lengths, "model": "paper"}
    return Column(height, shear=shear, flexure=flexure, **sizes, **common)
