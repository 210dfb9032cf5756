"""Reactions, storey shears and rotations of frames: statics at every row, and closed forms."""

import numpy as np
import pytest

import rbsdem
from rbsdem import frames
from rbsdem.codes import DesignSpectrum, target
from rbsdem.run.case import case_of_text
from rbsdem.springs import Bilinear, Elastic, PeakOriented

STIFF = frames.FrameMember(30e9, 4.0, 4.0)


def frame(kinematics="pdelta", **more):
    """Return three storeys, two bays, with rigid ends, loads on beams and on nodes."""
    kinds = [
        frames.FrameMember(30e9, 0.16, 2.1e-3, yield_moment=m, hardening=0.02, rigid_end=p)
        for m, p in ((250e3, 0.25), (180e3, 0.2))
    ]
    nodes = [frames.FrameNode(f"N-{i}-{k}", load_y=-40e3) for i in (1, 3) for k in (1, 2, 3)]
    return rbsdem.Frame.grid(
        [4.0, 3.2, 3.0], [6.0, 4.5], columns=kinds[0], beams=kinds[1], beam_load=20e3,
        floor_mass=[60e3, 50e3, 40e3], nodes=nodes, kinematics=kinematics, **more,
    )  # fmt: skip


@pytest.mark.parametrize("kinematics", ["small", "pdelta"])
@pytest.mark.parametrize("pattern", ["triangular", "uniform"])
def test_statics_of_a_push_over(kinematics, pattern):
    made = frame(kinematics, pattern=pattern)
    push = rbsdem.pushover(made, drift=0.03, points=20)
    weight, force = 3 * 20e3 * 10.5 + 6 * 40e3, push.force
    levels, mass = np.cumsum([4.0, 3.2, 3.0]), np.array([60e3, 50e3, 40e3])
    shares = mass * levels if pattern == "triangular" else mass
    shares = shares / shares.sum()
    total = sum(push.reactions.values())
    assert list(push.reactions) == ["N-1-0", "N-2-0", "N-3-0"]
    np.testing.assert_allclose(total[:, 0], -force, atol=1e-9 * weight)
    np.testing.assert_allclose(total[:, 1], weight, rtol=1e-9)
    above = np.cumsum(shares[::-1])[::-1]
    np.testing.assert_allclose(push.storey_shear, np.outer(force, above), atol=1e-9 * weight)
    # The loads and, with second-order work, the axial forces of the dead load on their members that
    # have turned: those of the columns are the weights on nodes that have moved.
    moment, weights = force * (shares @ levels), np.zeros_like(force)
    if kinematics == "pdelta":
        for one, axial in zip(made.geometry.values(), made.parts.compression, strict=True):
            start, end = one.start, one.end
            way = push.x[:, end] - push.x[:, start], push.y[:, end] - push.y[:, start]
            moment = moment + axial * (one.axis[1] * way[0] - one.axis[0] * way[1])
            half = 0.5 * one.load * abs(made.parts.x[end] - made.parts.x[start])
            weights += half * (push.x[:, start] + push.x[:, end])
        weights -= sum(
            push.x[:, made.parts.nodes.index(own.name)] * own.load_y for own in made.nodes
        )
    np.testing.assert_allclose(push.base_moment, moment, atol=1e-11 * moment.max())
    # Beams that shorten move the weights of their two nodes a little differently.
    np.testing.assert_allclose(
        moment, force * (shares @ levels) + weights, atol=2e-4 * moment.max()
    )


def test_shears_of_the_lowest_storey_are_the_base_shear_in_time():
    record = rbsdem.motions.synthetic(1)[0]
    made = frame("pdelta")
    quake = rbsdem.time_history(made, record, method="newmark", dt=0.01)
    largest = np.abs(quake.base_shear).max()
    np.testing.assert_allclose(quake.storey_shear[:, 0], quake.base_shear, atol=1e-8 * largest)


def test_loads_on_a_clamped_beam_are_held_by_its_ends():
    nodes = [frames.FrameNode(name, x, 0.0, support="fixed") for name, x in (("a", 0), ("b", 6))]
    one = frames.Member("AB", "a", "b", frames.FrameMember(30e9, 0.15, 3e-3), (0.5, 0.25), 12e3)
    free = frames.FrameNode("c", 0.0, 3.0, load_y=-1e3)
    post = frames.Member("AC", "a", "c", frames.FrameMember(30e9, 0.15, 3e-3))
    made = rbsdem.Frame(nodes=[*nodes, free], members=[one, post], control_node="c")
    rest = rbsdem.cyclic(made, force=[0.0])
    beam = rest.member("AB")
    half = 0.5 * 12e3 * 5.25
    np.testing.assert_allclose(beam.shear[0], [-half, half])
    fixed = half * 5.25 / 6
    np.testing.assert_allclose(beam.geometry.moment(*beam.moment[0], [0, 0.5, 1]), [
        -fixed, fixed / 2, -fixed])  # fmt: skip
    np.testing.assert_allclose(rest.reactions["a"][0], [0, half + 12e3 * 0.5 + 1e3, -fixed
        - half * 0.5], atol=1e-6)  # fmt: skip
    np.testing.assert_allclose(
        rest.reactions["b"][0, 1:], [half + 12e3 * 0.25, fixed + half * 0.25]
    )


def test_stability_coefficient_is_what_takes_the_stiffness():
    """theta = P/(K h): with second-order work the force falls by this share."""
    flexible = frames.FrameMember(30e9, 4.0, 1e-4)
    forces = []
    for kinematics in ("small", "pdelta"):
        made = rbsdem.Frame.grid(
            [3.0], [5.0], columns=flexible, beams=STIFF, beam_load=40e3, kinematics=kinematics
        )
        push = rbsdem.pushover(made, drift=0.001, points=4)
        forces.append(push.force[-1])
        theta = push.stability_coefficient[-1, 0]
    first_order, second_order = forces
    # By first-order shears theta is P d/(V h); by those of the displaced frame theta/(1 - theta).
    assert theta == pytest.approx(200e3 * 0.001 / second_order, rel=1e-6)
    assert second_order == pytest.approx(first_order - 200e3 * 0.001, rel=0.01)


def test_rotations_of_a_cantilever_and_of_its_hinge():
    elastic = rbsdem.Frame([3.0], columns=frames.FrameMember(30e9, 0.16, 2.1e-3))
    bent = rbsdem.pushover(elastic, drift=0.01, points=3).member("C-1-1")
    np.testing.assert_allclose(bent.chord_rotation[-1], [-0.01, 0.005], rtol=1e-9)
    assert not bent.plastic_rotation.any()
    hinge = frames.FrameMember(
        30e9, 0.16, 2.1e-3, flexure=Bilinear(1e7, 4e-3, 1e5), interior="rigid"
    )
    made = rbsdem.Frame([3.0], columns=hinge)
    # No moment is at the top, so all of the drift is the rotation of the foot.
    column = rbsdem.cyclic(made, displacement=[0.03, -0.03, 0.0]).member("C-1-1")
    np.testing.assert_allclose(column.chord_rotation[:, 0], [-0.01, 0.01, 0.0], atol=1e-12)
    whole = rbsdem.pushover(made, drift=0.01, points=10).member("C-1-1")
    assert whole.plastic_rotation[-1, 0] == pytest.approx(-0.006, rel=1e-9)
    assert not whole.plastic_rotation[:, 1].any()


def test_state_at_a_drift_and_at_the_largest_force():
    push = rbsdem.pushover(frame(), drift=0.04, points=7)
    at = push.at(drift=0.0123)
    assert at["displacement"] == pytest.approx(0.0123 * push.frame.height, rel=1e-12)
    assert push.at("peak")["force"] == push.path.force.max()
    loop = rbsdem.cyclic(frame(), displacement=[0.1, -0.2, 0.3])
    # From the first point at 0.1 m to the second at -0.2 m.
    assert loop.at(drift=-0.01)["time"] == pytest.approx((0.1 + 0.102) / 0.3)
    with pytest.raises(rbsdem.InputError, match=r"drift = 0\.5 is not reached; the rows go from"):
        push.at(drift=0.5)
    with pytest.raises(rbsdem.InputError, match="exactly one of time"):
        push.at(1.0, drift=0.01)
    with pytest.raises(rbsdem.InputError, match="time = 'top'"):
        push.at("top")


def test_periods_before_yield_and_of_the_secant():
    """Rigid beam, hinges that never soften: one mass on a bilinear spring, T_e = T_1."""
    column = frames.FrameMember(30e9, 0.16, 2e-3, yield_moment=100e3, hardening=0.0)
    stiff = frames.FrameMember(30e9, 40.0, 400.0)
    made = rbsdem.Frame.grid(
        [4.0], [5.0], columns=column, beams=stiff, floor_mass=1e4, beam_load=2e4
    )
    push = rbsdem.pushover(made, drift=0.03)
    stiffness = push.base_shear[1] / push.displacement[1]
    assert push.periods["uncracked"] == pytest.approx(
        2 * np.pi * np.sqrt(1e4 / stiffness), rel=1e-3
    )
    assert push.periods["secant at yield"] == pytest.approx(push.periods["uncracked"], rel=1e-3)


def test_events_members_and_modes_are_printed_as_tables():
    concrete, steel = rbsdem.Concrete(25e6), rbsdem.Steel(450e6, 600e6)
    ties = rbsdem.Ties(0.008, 0.15, steel)
    section = rbsdem.RectangularSection(
        0.4, 0.4, concrete, layout=rbsdem.Layout(8, 0.018, steel), ties=ties, cover=0.03
    )
    made = rbsdem.Frame.grid([3.0], columns=section, floor_mass=1e5, kinematics="pdelta",
                             nodes=[frames.FrameNode("N-1-1", load_y=-1e6)])  # fmt: skip
    push = rbsdem.pushover(made, drift=0.04)
    counts = push.events.to_pandas()["name"].value_counts()
    # The cover is lost on the side that is pressed, after the bars have yielded.
    assert counts["spalling"] == 1
    order = [event.name for event in push.events]
    assert order.index("yield") < order.index("spalling")
    text = str(push.events)
    assert "cracking" not in text
    assert text.splitlines()[-1] == f"and {counts['cracking']} springs crack"
    assert len(push.events.to_pandas(cracking=False)) == len(push.events) - counts["cracking"]
    assert "chord_rotation_rad" in str(push.member("C-1-1"))
    modes = rbsdem.modes(made, 1)
    assert f"{modes.period[0]:.4g}" in str(modes)
    # The cover of the frame's hinge is lost at the strain of its softening line.
    (spalled,) = [event for event in push.events if event.name == "spalling"]
    row = int(np.flatnonzero(push.time == spalled.time)[0])
    hinge = made.kinds["C-1-1"].at("flexure", 0.0)
    y, cover = max(hinge.layers, key=lambda one: abs(one[0]) if hasattr(one[1], "d_peak") else 0.0)
    closed = push.springs["opening"][row, 0] - abs(y) * abs(push.springs["rotation"][row, 0])
    assert closed <= -(cover.d_peak + cover.f_peak / cover.k_soft) * (1 - 1e-9)


@pytest.mark.filterwarnings("ignore::rbsdem.errors.AccuracyWarning")
def test_limit_states_and_error_are_those_of_a_column():
    # One rigid body on a spring is a column of one body and a frame of one member.
    spring = PeakOriented(
        d_y=0.004, f_y=200e3, d_cap=0.02, f_cap=240e3, d_pc=0.03, d_c=0.001, f_c=80e3
    )
    member = frames.FrameMember(30e9, 1.0, 100.0, flexure={0.0: spring})
    made = rbsdem.Frame.grid([3.0], columns=member, floor_mass=40e3)
    column = rbsdem.Column(
        height=3.0, n=1, mass=1.0, top_mass=40e3, shear=Elastic(1e12), flexure=spring
    )
    path = [0.02, -0.03, 0.1, -0.1, 0.12]
    for call in (
        lambda own: rbsdem.cyclic(own, displacement=path),
        lambda own: rbsdem.pushover(own, drift=-0.04, points=7),
    ):
        one, two = (call(own).limit_states() for own in (column, made))
        assert one.names() == two.names() == ["cracking", "first_yield", "cap", "strength_loss"]
        for state in one:
            for name in ("time", "drift", "force"):
                expected = pytest.approx(getattr(state, name), rel=1e-4)
                assert getattr(two[state.name], name) == expected, (state.name, name)
    assert two["cap"].source == "flexure of C-1-1 start"
    record = rbsdem.motions.synthetic(1)[0]
    given = {"method": "newmark", "dt": 0.01, "collapse_drift": 0.03}
    one, two = (rbsdem.time_history(own, record, **given) for own in (column, made))
    assert one.limit_states().names() == two.limit_states().names()
    found = one.refined_error(), two.refined_error()
    assert found[1].response_rms == pytest.approx(found[0].response_rms, rel=0.01)
    assert two.error_estimate.measured == found[1].largest


def free_nodes(made, kinds, **more):
    """Return a grid put together of nodes with floors and of members."""
    parts, masses = made.parts, np.broadcast_to(made.floor_mass, len(made.storeys))
    share = np.array([3.0, 5.25, 2.25]) / 10.5
    nodes = [
        frames.FrameNode(
            f"n{name[1:]}", x, y, "fixed" if k == 0 else "", floor=int(k),
            mass=masses[k - 1] * share[int(name[2]) - 1] if k else 0.0,
            load_y=-40e3 if k and name[2] != "2" else 0.0,
        )
        for name, x, y, k in zip(parts.nodes, parts.x, parts.y, parts.floor, strict=True)
    ]  # fmt: skip
    members = [
        frames.Member(
            name.lower(), nodes[one.start].name, nodes[one.end].name,
            kinds["BC".index(name[0])], one.rigid, one.load,
        )
        for name, one in made.geometry.items()
    ]  # fmt: skip
    last = nodes[parts.nodes.index("N-1-3")].name
    return rbsdem.Frame(
        nodes=nodes, members=members, kinematics="pdelta", control_node=last, **more
    )


@pytest.mark.parametrize("pattern", ["triangular", "uniform", "modal"])
def test_storeys_of_free_nodes_are_those_of_a_grid(pattern):
    grid = frame("pdelta", pattern=pattern)
    kinds = grid.named_kinds["kind-2"], grid.named_kinds["kind-1"]
    free = free_nodes(grid, kinds, pattern=pattern)
    assert free.storey_heights == pytest.approx((4.0, 3.2, 3.0), rel=1e-12)
    assert set(free.supports) == {"n-1-0", "n-2-0", "n-3-0"}
    assert (
        case_of_text(free.to_namelist() + "&loading drive = 'force', values = 1 /").column == free
    )
    one, two = (rbsdem.pushover(made, drift=0.02, points=10) for made in (grid, free))
    for name in ("storey_drift", "storey_shear", "floor_displacement"):
        expected = getattr(one, name)[-1]
        np.testing.assert_allclose(getattr(two, name)[-1], expected, rtol=1e-6, err_msg=name)
    if pattern == "modal":
        spectrum = DesignSpectrum.en_1998(0.1, "C")
        drifts = [target(push, spectrum, "en_1998").storey_drift for push in (one, two)]
        np.testing.assert_allclose(*drifts, rtol=1e-6)
        record = rbsdem.motions.synthetic(1)[0]
        given = {"method": "newmark", "dt": 0.01, "progress": False, "scales": [1.0, 8.0]}
        runs = [
            rbsdem.ensemble(made, [record], measures=["peak_storey_drift_2"], **given)
            for made in (grid, free)
        ]
        np.testing.assert_array_equal(*(own.status for own in runs))
        np.testing.assert_allclose(
            *(own.measures["peak_storey_drift_2"] for own in runs), rtol=1e-4
        )


def test_floors_that_cannot_be():
    kind = frames.FrameMember(30e9, 0.16, 2.1e-3)

    def cantilever(*floors):
        nodes = [
            frames.FrameNode(f"n{i}", 0.0, 3.0 * i, "" if i else "fixed", floor=floor)
            for i, floor in enumerate(floors)
        ]
        members = [frames.Member(f"m{i}", f"n{i}", f"n{i + 1}", kind) for i in (0, 1)]
        return rbsdem.Frame(nodes=nodes, members=members)

    assert cantilever(0, None, 1).storey_heights == (6.0,)
    assert cantilever(None, None, None).storey_heights == ()
    for floors, text in (
        ((0, 1, 3), "floor 2 has no node"),
        ((None, 1, 2), "floor 0 has no node"),
        ((0, 2, 1), "floor 2 is not above floor 1"),
    ):
        with pytest.raises(rbsdem.InputError, match=text):
            cantilever(*floors)
    with pytest.raises(rbsdem.InputError, match="N-1-1' belongs to the grid, which has its floor"):
        rbsdem.Frame.grid([3.0], columns=kind, nodes=[frames.FrameNode("N-1-1", floor=1)])
