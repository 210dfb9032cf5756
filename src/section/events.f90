!> Named points of a moment-curvature diagram: cracking, first yield, peak, ultimate.
module rbs_section_events
   use rbs_base_error, only: error_type, message_list
   use rbs_base_key_visitor, only: key_visitor, visited_record
   use rbs_base_keys, only: above_zero, any_number
   use rbs_base_kinds, only: wp
   use rbs_section_balance, only: state_type, begin, advance
   use rbs_section_resultants, only: laws_type
   use rbs_section_concrete_law, only: tension_choices
   use rbs_section_cross_section, only: section_type
   use rbs_section_steel_law, only: steel_yield_strain
   implicit none
   private

   public :: points_record, diagram_record, events_type, point_type, rule_type, find_events, check_rules, &
             reach_moment

   !> Rules of yield: the first bar in tension at its yield strain; that, or the extreme fibre at a strain of
   !> compression, whichever comes first (Priestley, Calvi, Kowalsky 2007: 0.002).
   integer, parameter, public :: yield_tension = 1, yield_first = 2

   !> Rules of the ultimate point: the extreme fibre at `eps_cover`; the edge of the core at the strain of
   !> hoop fracture (Mander, Priestley, Park 1988); the first bar breaks in tension; the moment has fallen by
   !> 20 per cent of its peak.
   character(len=6), parameter, public :: ultimate_names(4) = ['cover ', 'mander', 'steel ', 'drop  ']
   character(len=*), parameter, public :: ultimate_choices = 'cover mander steel drop'
   integer, parameter, public :: ultimate_cover = 1, ultimate_mander = 2, ultimate_steel = 3, &
                                 ultimate_drop = 4

   !> Share of the peak moment at which a section counts as failed.
   real(wp), parameter :: failed_share = 0.8_wp
   !> Strain over the depth at which every diagram ends.
   real(wp), parameter :: furthest = 0.5_wp
   !> First step of the curvature, as strain over the depth; growth of the steps.
   real(wp), parameter :: first_step = 2.0e-5_wp, growth = 0.05_wp

   type :: rule_type
      !> `yield_tension` or `yield_first`, and place among `ultimate_names`
      integer :: yield = yield_tension, ultimate = ultimate_cover
      !> Strains of the extreme fibre in compression for yield 'first' and ultimate 'cover'
      real(wp) :: eps_yield = 0.002_wp, eps_cover = 0.003_wp
   end type rule_type

   !> Names of the points of diagrams.
   type, extends(visited_record), abstract :: points_record
      !> Whether the core is confined and the cover spalls
      logical :: confined = .false.
      !> One of `ultimate_names`, and the strains of the rules
      character(len=8) :: ultimate = 'cover'
      real(wp) :: eps_yield = 0.002_wp, eps_cover = 0.003_wp
   contains
      procedure :: visit_points, rule
   end type points_record

   !> A moment-curvature diagram.
   type, extends(points_record) :: diagram_record
      !> Compression positive [N]
      real(wp) :: axial_load = 0.0_wp
      !> One of `tension_names`; rule of yield
      character(len=8) :: tension = 'ts', yielding = 'tension'
   contains
      procedure :: visit
   end type diagram_record

   type :: point_type
      !> Whether the diagram has this point
      logical :: found = .false.
      !> [1/m], [N m], strain at mid-depth (compression positive)
      real(wp) :: curvature = 0.0_wp, moment = 0.0_wp, eps0 = 0.0_wp
   end type point_type

   type :: events_type
      !> The extreme fibre in tension at f_t/E_c; yield and ultimate by their rules; largest moment
      type(point_type) :: cracking, yield, peak, ultimate
      !> Where the diagram ends: the moment down by 20 per cent, or the axial load no longer carried
      type(point_type) :: last
      !> Whether it ended because the axial load was no longer carried
      logical :: lost = .false.
   end type events_type

   !> Kinds of points between two states: a quantity of the section rises through zero.
   integer, parameter :: seek_cracking = 1, seek_yield = 2, seek_ultimate = 3, seek_drop = 4, seek_moment = 5

contains

   !> Present the keys of a diagram to a visitor.
   subroutine visit(self, v)
      class(diagram_record), intent(inout) :: self
      type(key_visitor), intent(inout) :: v

      call v%key('axial_load', self%axial_load, 'N', any_number, 'axial load, compression positive')
      call v%word('tension', self%tension, 'tension law of the concrete', tension_choices)
      call v%word('yielding', self%yielding, 'rule of yield', 'tension first')
      call self%visit_points(v)
   end subroutine visit

   !> Present the keys that a diagram and the fit of a spring share.
   subroutine visit_points(self, v)
      class(points_record), intent(inout) :: self
      type(key_visitor), intent(inout) :: v

      call v%key('confined', self%confined, 'the core is confined and the cover spalls')
      call v%word('ultimate', self%ultimate, 'rule of the ultimate point', ultimate_choices)
      call v%key('eps_yield', self%eps_yield, '', above_zero, &
                 'strain of the extreme fibre for the yield rule first')
      call v%key('eps_cover', self%eps_cover, '', above_zero, &
                 'strain of the extreme fibre for ultimate = cover')
   end subroutine visit_points

   !> The rules of the named points; the words must be known.
   pure type(rule_type) function rule(self, yielding)
      class(points_record), intent(in) :: self
      !> 'first'; any other word is the rule `yield_tension`
      character(len=*), intent(in) :: yielding

      rule = rule_type(merge(yield_first, yield_tension, yielding == 'first'), &
                       findloc(ultimate_names == self%ultimate, .true., dim=1), self%eps_yield, &
                       self%eps_cover)
   end function rule

   !> Follow the diagram along positive curvatures and find its points.
   subroutine find_events(section, laws, axial_load, rule, events, error, only_cracking)
      type(section_type), intent(in) :: section
      type(laws_type), intent(in) :: laws
      !> Compression positive [N]
      real(wp), intent(in) :: axial_load
      type(rule_type), intent(in) :: rule
      type(events_type), intent(out) :: events
      type(error_type), allocatable, intent(out) :: error
      !> Stop at cracking, without the other points
      logical, intent(in), optional :: only_cracking
      type(state_type) :: last, current, before_peak
      type(point_type) :: failed
      logical :: found, in_peak, short, fails

      short = .false.
      if (present(only_cracking)) short = only_cracking
      call begin(section, laws, axial_load, current, error)
      if (allocated(error)) return
      before_peak = current
      events%peak = as_point(current)
      in_peak = .false.
      do
         last = current
         call advance(section, laws, axial_load, last%curvature + step_of(section, last%curvature), &
                      current, found)
         if (.not. found) then
            events%lost = .true.
            exit
         end if
         ! The step before raised the moment and this one lowers it: the peak lies within these two.
         if (in_peak .and. current%moment < events%peak%moment) then
            call refine_peak(before_peak, current%curvature, events%peak)
         end if
         in_peak = .false.
         if (current%moment > events%peak%moment) then
            before_peak = last
            events%peak = as_point(current)
            in_peak = .true.
         end if
         call catch(seek_cracking, 0.0_wp, events%cracking)
         if (short .and. events%cracking%found) return
         call catch(seek_yield, 0.0_wp, events%yield)
         if (rule%ultimate /= ultimate_drop) call catch(seek_ultimate, 0.0_wp, events%ultimate)
         ! The moment drops at cracking too, and recovers: a section fails by crushing or rupture.
         fails = compressed(section, current) > section%plain%eps0 .or. &
                 bar_ratio(section, current, at_rupture=.true.) >= 1.0_wp
         if (fails .and. events%peak%moment > 0.0_wp) then
            call catch(seek_drop, failed_share*events%peak%moment, failed)
         end if
         if (failed%found .or. current%curvature*section%shape%depth > furthest) exit
      end do
      events%last = as_point(current)
      if (rule%ultimate == ultimate_drop) events%ultimate = failed
      if (failed%found) events%last = failed

   contains

      !> Locate a point within the last step, unless it has been found or has not been passed.
      subroutine catch(what, level, point)
         !> One of the kinds `seek_cracking` to `seek_moment`
         integer, intent(in) :: what
         !> Level of the moment for `seek_drop` [N m]; the other kinds do not use it
         real(wp), intent(in) :: level
         type(point_type), intent(inout) :: point

         if (point%found) return
         if (beyond(section, laws, rule, what, level, current) < 0.0_wp) return
         call locate(section, laws, axial_load, rule, what, level, last, current, point)
      end subroutine catch

      !> Golden-section search for the peak between two curvatures, as the diagram may have a corner there.
      subroutine refine_peak(first, end, peak)
         !> The state before the largest moment of the march, and the curvature after it [1/m]
         type(state_type), intent(in) :: first
         real(wp), intent(in) :: end
         !> The largest moment of the march, raised where a larger one is found
         type(point_type), intent(inout) :: peak
         real(wp), parameter :: golden = 0.6180339887498949_wp
         type(state_type) :: state
         real(wp) :: a, b, x(2), m(2)
         logical :: found
         integer :: i, k

         a = first%curvature
         b = end
         x = [b - golden*(b - a), a + golden*(b - a)]
         do k = 1, 2
            state = first
            call advance(section, laws, axial_load, x(k), state, found)
            if (.not. found) return
            m(k) = state%moment
         end do
         do i = 1, 20
            if (m(1) > m(2)) then
               b = x(2)
               x = [b - golden*(b - a), x(1)]
               m(2) = m(1)
               k = 1
            else
               a = x(1)
               x = [x(2), a + golden*(b - a)]
               m(1) = m(2)
               k = 2
            end if
            state = first
            call advance(section, laws, axial_load, x(k), state, found)
            if (.not. found) return
            m(k) = state%moment
            if (m(k) > peak%moment) peak = as_point(state)
         end do
      end subroutine refine_peak

   end subroutine find_events

   !> The first point of the diagram at which the moment reaches a level; not found if the diagram ends
   !> before.
   subroutine reach_moment(section, laws, axial_load, moment, point, error)
      type(section_type), intent(in) :: section
      type(laws_type), intent(in) :: laws
      !> Compression positive [N]
      real(wp), intent(in) :: axial_load
      !> The level [N m]
      real(wp), intent(in) :: moment
      type(point_type), intent(out) :: point
      type(error_type), allocatable, intent(out) :: error
      type(state_type) :: last, current
      logical :: found

      call begin(section, laws, axial_load, current, error)
      if (allocated(error)) return
      if (current%moment >= moment) then
         point = as_point(current)
         return
      end if
      do while (current%moment < moment)
         last = current
         call advance(section, laws, axial_load, last%curvature + step_of(section, last%curvature), &
                      current, found)
         if (.not. found .or. current%curvature*section%shape%depth > furthest) return
      end do
      call locate(section, laws, axial_load, rule_type(), seek_moment, moment, last, current, point)
   end subroutine reach_moment

   !> Step of the march from a curvature [1/m].
   elemental real(wp) function step_of(section, curvature)
      type(section_type), intent(in) :: section
      !> [1/m]
      real(wp), intent(in) :: curvature

      step_of = first_step/section%shape%depth + growth*curvature
   end function step_of

   !> Negative before the point that is sought, positive beyond it; dimensionless.
   pure real(wp) function beyond(section, laws, rule, what, level, state)
      type(section_type), intent(in) :: section
      type(laws_type), intent(in) :: laws
      type(rule_type), intent(in) :: rule
      !> One of the kinds `seek_cracking` to `seek_moment`
      integer, intent(in) :: what
      !> Level of the moment for `seek_drop` and `seek_moment` [N m]
      real(wp), intent(in) :: level
      type(state_type), intent(in) :: state
      real(wp) :: core_edge

      select case (what)
      case (seek_cracking)
         beyond = (0.5_wp*state%curvature*section%shape%depth - state%eps0 - laws%shell%ft/laws%shell%ec)/ &
                  laws%shell%eps0
      case (seek_yield)
         beyond = bar_ratio(section, state, at_rupture=.false.) - 1.0_wp
         if (rule%yield == yield_first) then
            beyond = max(beyond, compressed(section, state)/rule%eps_yield - 1.0_wp)
         end if
      case (seek_drop)
         beyond = 1.0_wp - state%moment/level
      case (seek_moment)
         beyond = state%moment/level - 1.0_wp
      case default                                       ! seek_ultimate
         select case (rule%ultimate)
         case (ultimate_mander)
            core_edge = state%eps0 + state%curvature*(0.5_wp*section%core_shape%depth - &
                                                      section%core_shape%end_inset(1))
            beyond = core_edge/section%core(1)%eps_cu - 1.0_wp
         case (ultimate_steel)
            beyond = bar_ratio(section, state, at_rupture=.true.) - 1.0_wp
         case default                                    ! ultimate_cover; `ultimate_drop` is sought as a drop
            beyond = compressed(section, state)/rule%eps_cover - 1.0_wp
         end select
      end select
   end function beyond

   !> Strain of the extreme fibre in compression, at y = -depth/2, compression positive.
   elemental real(wp) function compressed(section, state)
      type(section_type), intent(in) :: section
      type(state_type), intent(in) :: state

      compressed = state%eps0 + 0.5_wp*state%curvature*section%shape%depth
   end function compressed

   !> Largest of the tensile strains of the bars, each over its strain at yield or at rupture; not below -1,
   !> the value without bars.
   pure real(wp) function bar_ratio(section, state, at_rupture)
      type(section_type), intent(in) :: section
      type(state_type), intent(in) :: state
      !> Whether the strain at rupture counts, else that at yield
      logical, intent(in) :: at_rupture
      real(wp) :: limit
      integer :: i

      bar_ratio = -1.0_wp
      do i = 1, size(section%bar_y)
         limit = steel_yield_strain(section%steels(section%bar_steel(i)))
         if (at_rupture) limit = section%steels(section%bar_steel(i))%eps_u
         bar_ratio = max(bar_ratio, (state%curvature*section%bar_y(i) - state%eps0)/limit)
      end do
   end function bar_ratio

   !> The point between two states at which `beyond` passes zero: the Illinois form of regula falsi, with a
   !> bisection at every third step. Where a bar breaks the state jumps; the last state before is taken.
   subroutine locate(section, laws, axial_load, rule, what, level, first, second, point)
      type(section_type), intent(in) :: section
      type(laws_type), intent(in) :: laws
      real(wp), intent(in) :: axial_load
      type(rule_type), intent(in) :: rule
      !> Kind of point, and level of the moment, as in `beyond`
      integer, intent(in) :: what
      real(wp), intent(in) :: level
      !> States before and behind the point
      type(state_type), intent(in) :: first, second
      type(point_type), intent(out) :: point
      type(state_type) :: low, high, current
      real(wp) :: at, below, above, past
      logical :: found
      integer :: i, kept

      low = first
      high = second
      kept = 0
      below = beyond(section, laws, rule, what, level, low)
      above = beyond(section, laws, rule, what, level, high)
      if (below >= 0.0_wp) high = low               ! true before it is bent
      ! A side that is kept twice counts half, so that the secant moves it too.
      do i = 1, 100
         if (high%curvature - low%curvature <= 1.0e-10_wp*high%curvature) exit
         at = 0.5_wp*(low%curvature + high%curvature)
         if (mod(i, 3) /= 0) at = low%curvature - below*(high%curvature - low%curvature)/(above - below)
         if (at <= low%curvature .or. at >= high%curvature) at = 0.5_wp*(low%curvature + high%curvature)
         current = low
         call advance(section, laws, axial_load, at, current, found)
         past = beyond(section, laws, rule, what, level, current)
         if (past >= 0.0_wp .or. .not. found) then
            high = current
            above = past
            if (kept > 0) below = 0.5_wp*below
            kept = 1
         else
            low = current
            below = past
            if (kept < 0) above = 0.5_wp*above
            kept = -1
         end if
         if (abs(past) > 1.0e-11_wp) cycle
         low = current
         exit
      end do
      point = as_point(low)
   end subroutine locate

   !> A state as a point of the diagram that has been found.
   elemental type(point_type) function as_point(state)
      type(state_type), intent(in) :: state

      as_point = point_type(.true., state%curvature, state%moment, state%eps0)
   end function as_point

   !> Add a message for every rule that does not apply to the section.
   subroutine check_rules(section, confined, rule, messages)
      type(section_type), intent(in) :: section
      !> Whether the diagram has a confined core
      logical, intent(in) :: confined
      type(rule_type), intent(in) :: rule
      type(message_list), intent(inout) :: messages

      if (rule%ultimate == ultimate_mander .and. .not. (confined .and. section%core(1)%eps_cu < 1.0_wp)) then
         call messages%add("ultimate = 'mander' needs the confined core: give ties and confined = true, "// &
                           "or take 'cover'")
      end if
      if (rule%ultimate == ultimate_steel .and. size(section%bar_y) == 0) then
         call messages%add("ultimate = 'steel' needs bars, and this section has none; take 'cover'")
      end if
   end subroutine check_rules

end module rbs_section_events
