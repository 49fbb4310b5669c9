"""The thresholds of a run that few callers move: `Accuracy.thresholds`."""

from __future__ import annotations

from dataclasses import dataclass

from modelgen.runtime.arguments import check_fields


@dataclass(frozen=True, slots=True)
class Thresholds:
    """Thresholds, bounds and step choices of a run beside the fields of `Accuracy`, whose letters they use.

    L, T and M are the characteristic length, time and mass of the model. P is the length of a pair of shapes:
    the smaller radius of the balls around them, at least L. Numbers are dimensionless unless a unit is given.

    Attributes:
        stepping_step: step of time-stepping, in T, where none is given.
        stepping_theta: scheme "moreau": fraction of the step after which contacts are detected.
        stepping_tolerance: a solve for the impulses of a time step with friction ends at this residual once
            its iterations no longer halve it: of the largest velocity without contacts at the end of the
            step at most this part is wrong in the velocity of a contact. Solves that converge fast go on to
            rounding. 1e-2 in `coarse`, 1e-4 in `fast`, 1e-6 in `balanced`, 1e-9 in `tight`.
        stepping_residual: residual at which impulses are accepted, and the run says so, where no solve
            reaches `stepping_tolerance`.
        fallback_progress: a run falls back if many tries, a third of them rejected, advance it by less than
            this times T.
        fallback_step: step of time-stepping during a fallback, in T.
        chatter_step: the same where events cost too much, in T.
        chatter_work: work of events and rejected steps, in evaluations of one contact, up to which a run
            stays event-driven though time-stepping costs several times less.
        chatter_closed: a run that left its events for time-stepping does not return while more contacts are
            closed.
        start_joint_gap: joints that fit at t = 0 up to this times L are closed; others are refused.
        drift_tolerance: |d| above this times L, or |d_dot| above this times L/T, is projected away.
        friction_bound_margin: fraction by which the friction bound of a contact that reached it is lowered.
        other_motion: other forces that obey Coulomb's law and change accelerations by more than this part of
            those without forces are another motion.
        rest_acceleration: separation slower than this times L/T^2 does not open a contact.
        event_tolerance: events are located to this times T.
        extremality_residual: residual of the closest-point equations at the start, relative to L and 1.
        step_min: a run ends if its step falls below this times T.
        margin_warn: a closed contact whose margin falls below this is reported. Features of revolution
            closer to coaxial than this and this times L are followed at any margin.
        margin_refuse: a run ends if the margin of a closed contact falls below this.
        passage_time_max: a singular contact is passed in parts that take at most this times T.
        overlap_clear_gaps: at the start, a point farther from a body than this times `start_gap` is
            clear of it.
        overlap_clear_part: that distance is less by this part of the depth of an overlap, and two
            sheets overlap only if they cross deeper than this part of it.
        slip_stop_speed_ratio: slip stops at an event only if stopping costs less energy than slip at this
            times `slip_speed` has.
        separation_speed_factor: a step is shortened if a loaded contact separates at its end faster than this
            times `tolerance` times its speed or L/T.
        derivative_error_factor: in a run with derivatives, a step is refused where their error in it exceeds
            this times `tolerance`, relative to their size.
        derivative_kink_part: up to the end of a step that was refused so, that bound times this.
        derivative_step_min: steps up to this times T are never refused so.
        load_jump_rate: a load that changes in a step h by more than this times h/T of its size is searched
            for a jump where the motion takes it, past which derivatives are undecided.
        load_jump_span: it jumps if half of its change lies at one place of the motion within this times T.
        derivative_reach: derivatives at a start are undecided if a load jumps at a state that differs
            from it by no more than this, relative to the scales of places, turns and velocities.
        derivative_jump_part: a load that changes there by less than this part of it does not jump.
        derivative_impact_residual: an impact is differentiated if its law explains the change of
            velocities but for this part of it.
        derivative_start_change: changes of velocities at the start up to this, over their scales, may
            be left out of the derivatives.
        sensor_kink_reach: kinks of sensors are sought up to this far from the state, relative to what
            they depend on.
        sensor_kink_part: a sensor is on a kink if its slopes on both sides differ by more than this
            part of them.
        sensor_slope_part: the derivative of a sensor on a kink holds on a side if it differs from the
            slope there by no more than this part.
        face_force_part: whether the centre of the forces on a face stays in it is tried with forces
            that are changed by this part of its load.
        face_centre_part: the centre stays if such a change moves it beyond the border by no more than
            this part of `face_force_part` times L.
        rest_loss_factor: a contact held without force opens within a step above this times
            `rest_acceleration`.
        event_correction_step: beyond this fraction of the step, an event is corrected only while the
            corrections converge fast.
        contact_rank_tolerance: a contact row with a smaller independent part of J M^-1 J^T is dependent.
        joint_rank_tolerance: the same of a joint row, as at a dead centre.
        penetration_limit: a run ends where bodies penetrate deeper than this times L; in time-stepping,
            deeper than that and than they move in two steps.
        correction_ratio: a correction of positions, after a step of time-stepping or of drift, moves no body
            farther than this times the penetration, gap or joint error that it removes, and `contact_gap` L:
            sqrt(dx^2 + da I da / m) <= correction_ratio d + contact_gap L, with the movement dx of the centre
            of mass, the turn da, inertia I and mass m. One contact alone moves no body farther than d. A
            longer correction is not made, and what remains is judged.
        appear_depth: deepest penetration, in P, of a contact that is found during a run.
        event_scan_parts: number of parts of a step that are searched for the first event.
        appear_margin: least margin of a contact that is found during a run.
        appear_tilt_sine: sine of the largest angle by which an adjacent edge or face may point beyond the
            face that a vertex or edge is found above.
        lcp_iterations: bound on the active-set changes of one complementarity problem.
        events_at_once_max: bound on the transitions at one time.
        sweep_from_last: 1: solves for friction sweep over the contacts from the last one on, and where
            Coulomb's law has several solutions may find another; a companion does the other than its run.
        search_margin: a search for closest points drops results with a smaller margin; a ball whose centre is
            within this times L of the axis of a ring touches three parts of it.
        search_merge_distance: closest points nearer to each other than this times P are one.
        search_gap: a search follows contacts with gaps up to this times P.
        search_movement: a pair that can touch more than once is searched again after moving by this times
            the smaller radius of the balls around its shapes, or times P if that is less or the ball is a
            point.
        flat_angle: rad; a rim closer to a plane than this angle stands on three of its points, and so does
            what is closer to coaxial with another body than this and this times L.
        parallel_angle: rad; straight sides and edges closer to parallel than this are held at both ends of
            their line of contact: in event-driven runs where they are too nearly parallel (search_margin) to
            be followed between its ends.
        boundary_coincidence: boundaries of two faces nearer to each other than this times L coincide.
        feature_border: rad, or in L: a contact changes its feature this far beyond the border.
        time_resolution: changes of loads, given motions and paths within this times T may be missed.
        step_fraction: bound on the step, as a fraction of the longest step in which no event can be missed.
        companion_cost: the companion stops, and the run is not trusted, where its steps, with those that were
            rejected, exceed this times those of the run, and 100.
        prediction_error_max: rad, or in L: above this estimated error nothing is predicted.
        order_error_max: rad, or in L: the order of two impacts that is within the error is no doubt if both
            orders lead to motions that are nearer to each other than this, and the stated error covers both.
        gap_error_max: a run is not trusted if the gap of a closed contact, or a penetration, exceeded this
            times L.
        energy_error_max: a run is not trusted if its energy drift and the energy of corrections of positions,
            added, exceed this, and what rounding explains: (steps + 1) eps (|E_0| + largest kinetic energy +
            M L^2/T^2). The same if an impact adds more energy than this times the largest kinetic energy, as
            Newton's restitution with friction may.
        complementarity_error_max: a run is not trusted if min(gap/L, force/(M L/T^2)) of a contact exceeds
            this in size: forces that pull, or that act across a gap.
        overlap_depth: two shapes that no contact lists have passed through each other where a point of both
            lies deeper in them than this times the radius of the smaller one's ball.
    """

    stepping_step: float = 0.1
    stepping_theta: float = 0.5
    stepping_tolerance: float = 1e-6
    stepping_residual: float = 5e-2
    fallback_progress: float = 1e-2
    fallback_step: float = 1e-4
    chatter_step: float = 1e-2
    chatter_work: float = 1e7
    chatter_closed: int = 100
    start_joint_gap: float = 1e-6
    drift_tolerance: float = 1e-15
    friction_bound_margin: float = 1e-9
    other_motion: float = 1e-7
    rest_acceleration: float = 1e-10
    event_tolerance: float = 1e-13
    extremality_residual: float = 1e-13
    step_min: float = 1e-13
    margin_warn: float = 1e-3
    margin_refuse: float = 1e-5
    passage_time_max: float = 1e-4
    overlap_clear_gaps: float = 16.0
    overlap_clear_part: float = 1e-3
    slip_stop_speed_ratio: float = 100.0
    separation_speed_factor: float = 1e3
    derivative_error_factor: float = 100.0
    derivative_kink_part: float = 1e-3
    derivative_step_min: float = 1e-9
    load_jump_rate: float = 50.0
    load_jump_span: float = 1e-6
    derivative_reach: float = 1e-6
    derivative_jump_part: float = 1e-3
    derivative_impact_residual: float = 1e-6
    derivative_start_change: float = 1e-9
    sensor_kink_reach: float = 1e-5
    sensor_kink_part: float = 1e-4
    sensor_slope_part: float = 1e-7
    face_force_part: float = 1e-4
    face_centre_part: float = 1e-6
    rest_loss_factor: float = 100.0
    event_correction_step: float = 1e-3
    contact_rank_tolerance: float = 2e-10
    joint_rank_tolerance: float = 1e-8
    penetration_limit: float = 1e-6
    correction_ratio: float = 100.0
    appear_depth: float = 0.02
    event_scan_parts: int = 16
    appear_margin: float = 2e-5
    appear_tilt_sine: float = 0.5
    lcp_iterations: int = 200
    events_at_once_max: int = 10_000
    sweep_from_last: int = 0
    search_margin: float = 1e-9
    search_merge_distance: float = 1e-6
    search_gap: float = 0.2
    search_movement: float = 0.05
    flat_angle: float = 2e-5
    parallel_angle: float = 1e-3
    boundary_coincidence: float = 1e-13
    feature_border: float = 1e-9
    time_resolution: float = 0.05
    step_fraction: float = 1.0
    companion_cost: float = 10.0
    prediction_error_max: float = 1e-2
    order_error_max: float = 1e-4
    gap_error_max: float = 1e-9
    energy_error_max: float = 1e-6
    complementarity_error_max: float = 1e-6
    overlap_depth: float = 1e-4

    def __post_init__(self) -> None:
        check_fields(self)
