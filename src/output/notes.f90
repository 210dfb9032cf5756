!> Notes on a structure and on a run: input and results that are allowed but perhaps not intended.
module rbs_output_notes
   use rbs_base_band_matrix, only: band_matrix
   use rbs_base_check, only: is_given
   use rbs_base_constants, only: pi, standard_gravity
   use rbs_base_error, only: message_list
   use rbs_base_kinds, only: wp
   use rbs_base_text, only: to_text
   use rbs_case_case_record, only: case_record
   use rbs_hysteresis_spring_record, only: spring_record
   use rbs_hysteresis_springs, only: follow_path
   use rbs_output_spans, only: span_watch, hinge_turned
   use rbs_output_summary, only: summary_type
   use rbs_structure_column_column_record, only: column_record
   use rbs_structure_frame_frame, only: frame_type
   use rbs_structure_frame_frame_checks, only: is_rigid, is_strut
   use rbs_structure_frame_frame_parts, only: frame_parts
   use rbs_structure_frame_frame_record, only: frame_record
   use rbs_structure_frame_new_frame, only: frame_member
   use rbs_structure_spring_location, only: flexure, layer
   use rbs_structure_structure, only: structure_type, horizontal, small, finite
   implicit none
   private

   public :: drift_note, run_notes, structure_notes, largest_small, largest_ground, much

   !> Least and largest height of a column [m]: a height in millimetres is outside.
   real(wp), parameter :: shortest = 0.05_wp, longest = 100.0_wp

   !> No hinge of concrete or steel yields later [rad].
   real(wp), parameter :: late_yield = 0.2_wp
   character(len=*), parameter :: late = ' does not yield before a rotation of 0.2 rad; deformations are '// &
                                         'in rad, and 2.7 mrad is 0.0027'

   !> Axial loads below this share of the lateral strength are hardly meant.
   real(wp), parameter :: hardly_any = 0.005_wp

   !> Lateral strength beside the axial load, M/(h P): a column ten times as long as deep has 0.01 or more.
   real(wp), parameter :: too_weak = 0.003_wp

   !> Storeys and bays outside of these lengths are in another unit, or of no building [m].
   real(wp), parameter :: lowest_storey = 1.0_wp, widest_bay = 60.0_wp

   !> Young's moduli of building materials [Pa].
   real(wp), parameter :: least_modulus = 1.0e8_wp, largest_modulus = 1.0e12_wp

   !> Radii of gyration above this are those of no member [m].
   real(wp), parameter :: largest_radius = 10.0_wp

   !> Stresses at the yield moment of a solid section of the same area and inertia [Pa]: with a moment in kN m
   !> it is below.
   real(wp), parameter :: least_stress = 1.0e5_wp, largest_stress = 1.0e10_wp

   !> Bending stiffness over that of the softest kind, beyond which digits of the softer members are lost.
   real(wp), parameter :: far_stiffer = 1.0e7_wp

   !> Masses [kg] and loads [N/m] below these are those of no floor, where storeys are as high as `low_storey`
   !> [m].
   real(wp), parameter :: least_mass = 200.0_wp, least_load = 100.0_wp, low_storey = 2.0_wp

   !> Period of buildings of height h, 0.075 h^(3/4) [s] (EN 1998-1, 4.3.3.2.2), and the largest ratio of both
   !> periods.
   real(wp), parameter :: usual_period = 0.075_wp, most_periods = 25.0_wp

   !> Rotations larger than this are not small [rad].
   real(wp), parameter :: largest_small = 0.1_wp

   !> Share of the energies that the balance may miss.
   real(wp), parameter :: much = 0.05_wp

   !> Share of its Euler load that the load along an inclined member may be; error of displacements over this
   !> share: 1/4.93 - 1/7.84 in units of E I/l^2, of a cantilever with half of the load at its top.
   real(wp), parameter :: much_along = 0.01_wp, error_along = 0.74_wp

   !> No ground has moved with more [m/s2].
   real(wp), parameter :: largest_ground = 5.0_wp*standard_gravity

   !> Lateral strength of buildings in shares of their weight.
   real(wp), parameter :: least_strength = 0.01_wp, largest_strength = 50.0_wp

   !> Displacements beyond this share of the height are hardly meant.
   real(wp), parameter :: far = 0.5_wp

contains

   !> Add the notes on a run that has ended.
   subroutine run_notes(structure, summary, spans, notes)
      class(structure_type), intent(in) :: structure
      type(summary_type), intent(in) :: summary
      !> The watch over the rows of the run
      type(span_watch), intent(in) :: spans
      type(message_list), intent(inout) :: notes

      call rotation_note(structure, summary, notes)
      if (summary%remark /= '') call notes%add(trim(summary%remark))
      call spans%tell(structure, notes)
      if (summary%peak_ground > largest_ground) then
         call notes%add('the ground: its peak is '//to_text(summary%peak_ground/standard_gravity)// &
                        ' g; no ground has moved with more than 5 g, and accelerations are in m/s2')
      end if
      ! Explicit steps near their limit lose energy as they must; only implicit ones, of frames, are judged.
      if (.not. structure%is_implicit .or. .not. summary%time_step > 0.0_wp) return
      if (.not. summary%residual > much*summary%largest) return
      call notes%add('the balance of energy misses '// &
                     to_text(anint(100.0_wp*summary%residual/summary%largest))// &
                     ' per cent of the largest energy: the step does not resolve the response; take a '// &
                     'shorter dt')
   end subroutine run_notes

   !> Note rotations that are taken as small but have grown large. The error of sin(th) is th^2/6 of it, and
   !> that of cos(th), which lever arms contain, th^2/2: together 2 th^2/3.
   subroutine rotation_note(structure, summary, notes)
      class(structure_type), intent(in) :: structure
      type(summary_type), intent(in) :: summary
      type(message_list), intent(inout) :: notes
      character(len=6) :: kinematics
      integer :: before

      ! A run to its collapse was asked for, and its rotations are known to be large.
      if (summary%collapsed) return
      ! Exact rotations may be large.
      if (structure%kinematics == finite) return
      ! The displacements of a path are given, those of a response in time are not.
      if (.not. summary%time_step > 0.0_wp) then
         before = notes%count
         call drift_note(structure, summary%peak_displacement, notes)
         ! That note names the remedy of a column. Frames have none: they err as the next note says.
         if (notes%count > before .and. .not. structure%is_implicit) return
      end if
      if (structure%is_implicit) then
         call frame_rotation_note(structure, summary, notes)
         return
      end if
      if (.not. summary%peak_rotation > largest_small) return
      kinematics = 'pdelta'
      if (structure%kinematics == small) kinematics = 'small'
      ! Without a number of its own, so that a session of many runs shows it once.
      if (summary%peak_rotation < 1.0_wp) then
         call notes%add("the rotation of a body goes beyond 0.1 rad; with kinematics = '"// &
                        trim(kinematics)//"' displacements and forces err by about 2 th^2/3 of them "// &
                        "(0.7 % at 0.1 rad, 2.7 % at 0.2 rad), where th is peak_rotation; use 'finite'")
      else
         call notes%add("the rotation of a body goes beyond 1 rad; with kinematics = '"//trim(kinematics)// &
                        "' the displacement has no meaning then (displacements are in m, forces in N); "// &
                        "use 'finite'")
      end if
   end subroutine rotation_note

   !> Note that a frame turns far: its rotations, of the nodes and of the whole, are taken as small.
   subroutine frame_rotation_note(structure, summary, notes)
      class(structure_type), intent(in) :: structure
      type(summary_type), intent(in) :: summary
      type(message_list), intent(inout) :: notes

      if (max(summary%peak_rotation, abs(summary%peak_displacement)/structure%total_height) > &
          largest_small) then
         call notes%add('frame: it turns by more than 0.1 rad, and the rotations of frames are taken as '// &
                        'small: displacements and forces err by about 2 th^2/3 of them (0.7 % at 0.1 '// &
                        'rad, 2.7 % at 0.2 rad), and beyond 1 rad they have no meaning')
      end if
   end subroutine frame_rotation_note

   !> Note a displacement beyond half of the height, as a number in another unit makes it.
   subroutine drift_note(structure, displacement, notes)
      class(structure_type), intent(in) :: structure
      !> Largest displacement of the top [m]
      real(wp), intent(in) :: displacement
      type(message_list), intent(inout) :: notes
      character(len=:), allocatable :: remedy

      if (.not. abs(displacement) > far*structure%total_height) return
      remedy = "; if it is meant, use kinematics = 'finite'"
      ! Frames have small rotations only.
      if (structure%is_implicit) remedy = ''
      call notes%add('the top goes beyond half of the height; displacements are in m (16 mm is 0.016), '// &
                     'drifts are parts of the height (2 per cent is 0.02), forces are in N'//remedy)
   end subroutine drift_note

   !> Add the notes about a structure and its loading.
   subroutine structure_notes(case, structure, notes)
      !> Validated case
      type(case_record), intent(in) :: case
      !> Structure that was made of it
      class(structure_type), intent(in) :: structure
      type(message_list), intent(inout) :: notes

      if (allocated(case%frame)) then
         call frame_notes(case%frame, notes)
         call period_note(structure, notes)
         select type (structure)
         class is (frame_type)
            call inclined_note(structure, notes)
            call strength_note(case%parts, -sum(structure%pattern(horizontal)%force), notes)
         end select
      else
         call column_notes(case%column, notes)
      end if
   end subroutine structure_notes

   !> Note sizes of a frame in a wrong unit, and masses without weight.
   subroutine frame_notes(frame, notes)
      type(frame_record), intent(in) :: frame
      type(message_list), intent(inout) :: notes
      !> Stress at the edge at yield [Pa]; whether there is mass and dead load; whether kinds have no elastic
      !> values
      real(wp) :: stress
      integer :: i
      logical :: heavy, loaded
      logical, allocatable :: rigid(:)

      if (allocated(frame%storeys)) call check_lengths('storeys', frame%storeys)
      if (allocated(frame%bays)) call check_lengths('bays', frame%bays)
      allocate (rigid(size(frame%kind)))
      do i = 1, size(frame%kind)
         associate (kind => frame%kind(i), owner => "member_kind '"//trim(frame%kind(i)%name)//"': ")
            rigid(i) = is_rigid(kind, frame%spring) .or. is_strut(kind, frame%spring)
            if (rigid(i)) cycle
            if (kind%modulus < least_modulus .or. kind%modulus > largest_modulus) then
               call notes%add(owner//'modulus = '//to_text(kind%modulus)// &
                              ' Pa is that of no building material; 30 GPa is 30e9')
            end if
            if (kind%inertia > largest_radius**2*kind%area) then
               call notes%add(owner//'inertia and area make a radius of gyration of '// &
                              to_text(sqrt(kind%inertia/kind%area))//' m; they are in m4 and m2, and '// &
                              '1e12 mm4 are 1, 1e6 mm2 are 1')
            end if
            if (.not. is_given(kind%yield_moment)) cycle
            ! Of a rectangle with this area and this inertia
            stress = kind%yield_moment*sqrt(3.0_wp/(kind%inertia*kind%area))
            if (stress >= least_stress .and. stress <= largest_stress) cycle
            call notes%add(owner//'yield_moment = '//to_text(kind%yield_moment)//' N m is a stress of '// &
                           to_text(stress)//' Pa at its edge, that of no member; moments are in N m, and '// &
                           '170 kN m is 170e3')
         end associate
      end do
      call check_alike()
      ! Springs that are given one by one
      do i = 1, size(frame%spring)
         associate (own => frame%spring(i))
            if (own%group /= 'flexure') cycle
            if (yields_late(own%spring)) call notes%add("flexure of '"//trim(own%kind)//trim(own%node)// &
                                                        trim(own%panel)//"'"//late)
         end associate
      end do
      if (allocated(frame%storeys)) then
         do i = 1, size(frame%floor)
            call check_floor('mass', frame%floor(i)%mass, least_mass, 'kg', '40 t is 40e3')
            if (frame%floor(i)%is_loaded()) call check_floor('dead_load', maxval(frame%floor(i)%dead_load), &
                                                             least_load, 'N/m', '10 kN/m is 10e3')
         end do
      end if
      heavy = any(frame%floor%mass > 0.0_wp) .or. any(frame%node%mass > 0.0_wp)
      loaded = any(frame%floor%is_loaded()) .or. any(abs(frame%node%load_y) > 0.0_wp) .or. &
               any(abs(frame%member%load) > 0.0_wp)
      if (heavy .and. .not. loaded) then
         call notes%add('frame: it has mass and no dead load; the weight of masses acts as far as it is '// &
                        'given as load of beams or load_y of nodes')
      end if
      if (frame%kinematics == 'pdelta' .and. .not. loaded) then
         call notes%add("frame: kinematics = 'pdelta' does nothing without dead load; give some")
      end if

   contains

      !> Note a kind so much stiffer than another one that digits of the other are lost.
      subroutine check_alike()
         real(wp), allocatable :: bending(:)
         integer :: soft, stiff

         if (all(rigid)) return
         bending = frame%kind%modulus*frame%kind%inertia
         soft = minloc(bending, dim=1, mask=.not. rigid)
         stiff = maxloc(bending, dim=1, mask=.not. rigid)
         if (.not. bending(stiff) > far_stiffer*bending(soft)) return
         call notes%add("member_kind '"//trim(frame%kind(stiff)%name)//"': it is "// &
                        to_text(bending(stiff)/bending(soft))//" times as stiff in bending as '"// &
                        trim(frame%kind(soft)%name)//"', and each factor of ten costs a digit of the "// &
                        "results; a rigid member has interior = 'rigid' and no springs")
      end subroutine check_alike

      !> Note storeys or bays whose lengths are those of no building.
      subroutine check_lengths(name, length)
         !> 'storeys' or 'bays', and their lengths [m]
         character(len=*), intent(in) :: name
         real(wp), intent(in) :: length(:)

         if (minval(length) >= lowest_storey .and. maxval(length) <= widest_bay) return
         call notes%add('frame: '//name//' has lengths of '//to_text(minval(length))//' to '// &
                        to_text(maxval(length))//' m; lengths are in m, and 3200 mm is 3.2')
      end subroutine check_lengths

      !> Note a mass or a load that is that of no floor, but for models on a shaking table, whose storeys are
      !> low.
      subroutine check_floor(name, value, least, unit, meant)
         !> Key, unit and an example in it, for the message
         character(len=*), intent(in) :: name, unit, meant
         !> Value, and the least one of a floor
         real(wp), intent(in) :: value, least

         if (.not. value > 0.0_wp .or. value >= least .or. minval(frame%storeys) < low_storey) return
         call notes%add('floor: '//name//' = '//to_text(value)//' '//unit//' is that of no floor of a '// &
                        'building; '//meant)
      end subroutine check_floor
   end subroutine frame_notes

   !> Note a lateral strength of the columns at the foot that is none of a building beside the weight of the
   !> masses, as of moments in kN m: the strength is that of hinges at both ends, at a rotation beyond their
   !> yield.
   subroutine strength_note(parts, mass, notes)
      type(frame_parts), intent(in) :: parts
      !> Mass of all nodes that move [kg]
      real(wp), intent(in) :: mass
      type(message_list), intent(inout) :: notes
      !> Lateral strength [N]; clear length [m] of a column and moments of its two hinges [N m]
      real(wp) :: strength, length, hinges(2)
      integer :: i

      if (.not. mass > 0.0_wp) return
      strength = 0.0_wp
      do i = 1, size(parts%member)
         associate (m => parts%member(i), a => parts%node(parts%member(i)%node(1)), &
                    b => parts%node(parts%member(i)%node(2)))
            ! Columns at the foot end in a node that is held upward.
            if (m%after_dead_load .or. m%pinned .or. .not. (a%held(2) .or. b%held(2))) cycle
            if (abs(a%y - b%y) < abs(a%x - b%x)) cycle
            length = hypot(a%x - b%x, a%y - b%y) - sum(m%rigid)
            hinges = [hinge_of(m, 0.0_wp), hinge_of(m, 1.0_wp)]
            ! A hinge without bound leaves the strength open.
            if (any(hinges < 0.0_wp)) return
            strength = strength + sum(hinges)/length
         end associate
      end do
      if (.not. strength > 0.0_wp) return
      associate (share => strength/(standard_gravity*mass))
         if (share >= least_strength .and. share <= largest_strength) return
         call notes%add('frame: the columns at its foot carry a lateral force of some '//to_text(strength)// &
                        ' N, '//to_text(share)//' of the weight of the masses, as those of no building; '// &
                        'moments are in N m (170 kN m is 170e3), masses in kg (40 t is 40e3)')
      end associate
   end subroutine strength_note

   !> Moment of the hinge at an end of a member, turned by `hinge_turned` [N m]; negative where nothing bounds
   !> it.
   real(wp) function hinge_of(m, position) result(moment)
      type(frame_member), intent(in) :: m
      !> Position of the end in shares of the length: 0 or 1
      real(wp), intent(in) :: position
      real(wp) :: f(1)
      integer :: j

      moment = 0.0_wp
      ! Layers give the moment by their distances, as openings and as lever arms.
      associate (bends => abs(m%position - position) <= 0.0_wp .and. (m%kind == flexure .or. m%kind == layer))
         do j = 1, size(bends)
            if (.not. bends(j)) cycle
            if (m%kind(j) == layer) then
               call follow_path(m%spring(j), [m%y(j)*hinge_turned], f)
               moment = moment + m%y(j)*f(1)
            else
               call follow_path(m%spring(j), [hinge_turned], f)
               moment = moment + abs(f(1))
            end if
         end do
         if (.not. any(bends) .or. any(bends .and. m%spring%rule == 'elastic')) moment = -1.0_wp
      end associate
   end function hinge_of

   !> Note a load along an inclined member, which does second-order work as if it were at the ends of the
   !> member.
   subroutine inclined_note(frame, notes)
      type(frame_type), intent(in) :: frame
      type(message_list), intent(inout) :: notes
      !> Load along each member over its Euler load
      real(wp) :: share(frame%members)
      integer :: i

      if (.not. frame%axially_loaded) return
      share = 0.0_wp
      do i = 1, frame%members
         associate (e => frame%element(i))
            if (.not. (abs(e%load_across) > 0.0_wp .and. e%flexural_rigidity > 0.0_wp)) cycle
            ! The axis of the member is to_basic(1, 4:5): its slope times the load across is the load along.
            share(i) = abs(e%load_across*e%to_basic(1, 5)/e%to_basic(1, 4))*e%length**3 &
                       /(pi**2*e%flexural_rigidity)
         end associate
      end do
      i = maxloc(share, dim=1)
      if (.not. share(i) > much_along) return
      call notes%add('member '//trim(frame%member_name(i))//': it is inclined, and with '// &
                     "kinematics = 'pdelta' the part of its load along its axis acts at its ends: "// &
                     'displacements may err by some '// &
                     to_text(anint(1000.0_wp*error_along*share(i))/10.0_wp)// &
                     ' per cent of them; n members in its place divide that by n squared')
   end subroutine inclined_note

   !> Note a period that is that of no building, as of stiffness or masses in another unit. The period is that
   !> of the sway under the masses as loads along x (Rayleigh).
   subroutine period_note(structure, notes)
      class(structure_type), intent(in) :: structure
      type(message_list), intent(inout) :: notes
      type(band_matrix) :: matrix
      !> Masses along x as loads, then displacements by them; the two periods [s]
      real(wp) :: sway(structure%unknowns), period, usual
      logical :: regular

      sway = -structure%pattern(horizontal)%force
      ! A frame without mass, or with a stiffness that does not hold it, has no period.
      if (.not. any(sway > 0.0_wp)) return
      call matrix%create(structure%unknowns, structure%half_width)
      matrix%band = 0.0_wp
      call structure%add_stiffness(structure%initial_stiffness, structure%initial_tangent, matrix%band)
      call matrix%factor()
      call matrix%solve(sway, regular)
      if (.not. (matrix%positive .and. regular)) return
      associate (force => -structure%pattern(horizontal)%force)
         period = 2.0_wp*pi*sqrt(sum(force*sway**2)/sum(force*sway))
      end associate
      usual = usual_period*structure%total_height**0.75_wp
      if (max(period/usual, usual/period) < most_periods) return
      call notes%add('frame: a period of some '//to_text(period)//' s is that of no building '// &
                     to_text(structure%total_height)//' m high; lengths are in m, masses in kg, '// &
                     'moduli in Pa, stiffness of springs is in N m/rad and N/m')
   end subroutine period_note

   !> Note sizes of a column in a wrong unit, springs that seem exchanged, loads that do nothing and masses
   !> without weight, each with a remedy.
   subroutine column_notes(spec, notes)
      !> Validated
      type(column_record), intent(in) :: spec
      type(message_list), intent(inout) :: notes
      !> Whether joints carry the axial load by their own law
      logical :: carried

      if (spec%height < shortest .or. spec%height > longest) then
         call notes%add('column: height = '//to_text(spec%height)//' m is that of no column; lengths are '// &
                        'in m, and 1750 mm is 1.75')
      end if
      if (all(spec%shear%rule == 'takeda') .and. all(spec%flexure%rule == 'bilinear')) then
         call notes%add("column: shear has the rule 'takeda' and flexure 'bilinear', usually it is the "// &
                        'other way round; exchange them if that is meant')
      end if
      ! Axial springs and layers carry the load with all kinematics.
      carried = allocated(spec%axial_spring)
      carried = carried .or. any(spec%flexure%rule == 'layered')
      if (spec%kinematics == 'small' .and. .not. carried) then
         if (abs(spec%axial_load) > 0.0_wp) then
            call notes%add('column: axial_load = '//to_text(spec%axial_load)//' N does nothing with '// &
                           "kinematics = 'small'; set kinematics = 'pdelta', which has its second-order "// &
                           'moments, or remove it')
         end if
         if (spec%self_weight .and. spec%gravity > 0.0_wp) then
            call notes%add("column: self_weight does nothing with kinematics = 'small'; set "// &
                           "kinematics = 'pdelta', or remove it")
         end if
      end if
      if (spec%top_mass > 0.0_wp .and. spec%gravity > 0.0_wp .and. .not. abs(spec%axial_load) > 0.0_wp) then
         call notes%add('column: top_mass = '//to_text(spec%top_mass)//' kg has no weight, as axial_load '// &
                        'is zero; give axial_load = '//to_text(anint(spec%top_mass*standard_gravity))// &
                        " N with kinematics = 'pdelta', or gravity = 0 if something else carries it")
      end if
      call balance_notes(spec, notes)
   end subroutine column_notes

   !> Note springs and loads of a column that do not go together, as numbers in another unit do. The strength
   !> of the lowest flexural spring is its moment at a rotation of 0.05 rad.
   subroutine balance_notes(spec, notes)
      !> Validated
      type(column_record), intent(in) :: spec
      type(message_list), intent(inout) :: notes
      !> That moment [N m], and the lateral strength by it [N]
      real(wp) :: moment(1), least

      ! Drawn members are judged where they are drawn; springs that never yield have no strength.
      if (spec%flexure(1)%rule == 'layered' .or. spec%flexure(1)%rule == 'elastic') return
      call follow_path(spec%flexure(1), [0.05_wp], moment)
      if (spec%kinematics /= 'small' .and. spec%axial_load < 0.0_wp) then
         call notes%add('column: axial_load = '//to_text(spec%axial_load)//' N is tension; compression '// &
                        'is positive')
      end if
      if (yields_late(spec%flexure(1))) call notes%add('column: flexure'//late)
      least = moment(1)/spec%height
      if (spec%kinematics /= 'small' .and. least > 0.0_wp .and. least < too_weak*spec%axial_load) then
         call notes%add('column: the lateral strength of flexure, '//to_text(least)//' N, is hardly any '// &
                        'beside axial_load = '//to_text(spec%axial_load)//' N; stiffness is in N m/rad, '// &
                        'forces are in N')
      else if (spec%axial_load > 0.0_wp .and. spec%axial_load < hardly_any*least .and. &
               .not. spec%top_mass > 0.0_wp) then
         call notes%add('column: axial_load = '//to_text(spec%axial_load)//' N is hardly any beside the '// &
                        'lateral strength of '//to_text(least)//' N; loads are in N, and 744 kN is 744e3')
      end if
   end subroutine balance_notes

   !> Whether a flexural spring still is on its first line at a rotation at which any hinge has yielded.
   logical function yields_late(spring)
      type(spring_record), intent(in) :: spring
      real(wp) :: moment(1)

      yields_late = .false.
      if (any(spring%rule == [character(len=8) :: 'layered', 'elastic'])) return
      call follow_path(spring, [late_yield], moment)
      yields_late = moment(1) >= (1.0_wp - 1.0e-9_wp)*spring%initial_stiffness()*late_yield
   end function yields_late

end module rbs_output_notes
