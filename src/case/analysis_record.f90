!> The input of the analysis and of its output.
module rbs_case_analysis_record
   use rbs_base_kinds, only: wp
   use rbs_base_constants, only: unset, unset_integer
   use rbs_base_error, only: message_list
   use rbs_base_text, only: to_text
   use rbs_base_check, only: is_given
   use rbs_case_methods, only: method_type, methods, method_named, method_choices, takes, quoted_names
   use rbs_base_key_visitor, only: key_visitor, visited_record
   use rbs_base_keys, only: bound_type, above_zero, one_or_more
   implicit none
   private

   public :: analysis_record, output_record

   !> Tolerances of `rk45` that the arithmetic can reach.
   type(bound_type), parameter :: possible = bound_type(1.0e-13_wp, 0.1_wp)
   !> Range of the spectral radius at infinite frequency.
   type(bound_type), parameter :: radius = bound_type(0.0_wp, 1.0_wp)
   type(bound_type), parameter :: drift = &
      bound_type(0.0_wp, 1.0_wp, least_open=.true., most_open=.true., reason='(10 per cent is 0.1)')

   !> How the case is solved.
   type, extends(visited_record) :: analysis_record
      !> One of `methods`, see `rbs_case_methods`; empty: not chosen yet
      character(len=20) :: method = ''
      !> Whether the user has named the method
      logical :: named = .true.
      !> Time step [s]; `unset`: chosen by the method
      real(wp) :: dt = unset
      !> End of the analysis [s]; `unset`: the end of the loading
      real(wp) :: duration = unset
      character(len=20) :: events = ''
      real(wp) :: tolerance = unset, rho_infinity = unset, collapse_drift = unset
      logical :: allow_unstable = .false.
      !> A run that takes longer is stopped [s]; `unset`: none is
      real(wp) :: max_seconds = unset
      !> Path of the state that the analysis begins in; not allocated: at rest
      character(len=:), allocatable :: initial
   contains
      procedure :: visit => visit_analysis, dynamic, static, known, validate => validate_analysis
   end type analysis_record

   !> The output of a run.
   type, extends(visited_record) :: output_record
      !> Path of the csv; not allocated: the case file's name with .csv
      character(len=:), allocatable :: file
      integer :: every = unset_integer
      !> Whether the rows hold the openings of layered joints; whether the rows of an analysis in time hold
      !> how the top moves
      logical :: openings = .false., motion = .false.
      !> Path for the state at the end; not allocated: it is not written
      character(len=:), allocatable :: state
   contains
      procedure :: visit => visit_output
   end type output_record

contains

   !> The keys of the analysis.
   subroutine visit_analysis(self, v)
      class(analysis_record), intent(inout) :: self
      type(key_visitor), intent(inout) :: v

      call v%word('method', self%method, 'method; without it static for displacements and forces without '// &
                  'time, auto for motions', method_choices())
      call v%key('dt', self%dt, 's', above_zero, 'time step; without it chosen by the method', &
                 optional=.true.)
      call v%key('duration', self%duration, 's', above_zero, &
                 'how long the analysis lasts; without it as long as the loading', optional=.true.)
      call v%word('events', self%events, 'rk4: springs change their line at the end of a step (step), or '// &
                  'where it ends (located)', 'step located')
      call v%key('tolerance', self%tolerance, '', possible, 'rk45, auto: wanted relative error of a step '// &
                 'in energy norm; without it 1e-6', optional=.true.)
      call v%key('rho_infinity', self%rho_infinity, '', radius, 'hht, generalised_alpha: spectral radius '// &
                 'at infinite frequency; without it 0.8', optional=.true.)
      call v%key('collapse_drift', self%collapse_drift, '', drift, 'drift at which the structure '// &
                 'counts as collapsed, of a storey of a frame or of the top', optional=.true.)
      call v%key('allow_unstable', self%allow_unstable, &
                 'rk4: take a step beyond the stability limit all the same')
      call v%key('max_seconds', self%max_seconds, 's', above_zero, &
                 'a run that takes longer is stopped', optional=.true.)
      call v%long_text('initial', self%initial, &
                       'path of the state that another analysis ended in, to begin there')
   end subroutine visit_analysis

   !> The keys of the output.
   subroutine visit_output(self, v)
      class(output_record), intent(inout) :: self
      type(key_visitor), intent(inout) :: v

      call v%long_text('file', self%file, 'path of the csv, from the folder of the case')
      call v%key('every', self%every, '', one_or_more, 'every n-th point or step is kept, and the last; '// &
                 'without it every point of the loading', optional=.true.)
      call v%key('openings', self%openings, &
                 'whether the rows hold the openings of layered joints, from which their layers follow')
      call v%key('motion', self%motion, &
                 'whether the rows in time hold velocity and acceleration of the top and that of the ground')
      call v%long_text('state', self%state, &
                       'path for the state at the end, from which another analysis can begin')
   end subroutine visit_output

   !> Whether the analysis runs in time.
   pure logical function dynamic(self)
      class(analysis_record), intent(in) :: self

      dynamic = any(methods%name == self%method .and. methods%in_time)
   end function dynamic

   !> Whether the method is one of the table.
   pure logical function known(self)
      class(analysis_record), intent(in) :: self

      known = any(methods%name == self%method)
   end function known

   !> Whether the method leaves out inertia. A method that is not known is neither.
   pure logical function static(self)
      class(analysis_record), intent(in) :: self

      static = any(methods%name == self%method .and. .not. methods%in_time)
   end function static

   !> Add a message for every setting that is refused, or that the method does not use: the user expects it
   !> to have an effect.
   subroutine validate_analysis(self, messages)
      class(analysis_record), intent(inout) :: self
      type(message_list), intent(inout) :: messages
      type(method_type) :: method
      logical :: sound

      call self%check('analysis', messages, sound)
      method = method_named(self%method)
      if (is_given(self%rho_infinity) .and. sound) then
         if (self%rho_infinity < method%least_rho_infinity) then
            call messages%add('analysis: rho_infinity = '//to_text(self%rho_infinity)//" of method = '"// &
                              trim(method%name)//"' must be from "//to_text(method%least_rho_infinity)// &
                              ' to 1')
         end if
      end if
      ! A name that is not known has been reported already.
      if (.not. self%known()) return
      call refuse('dt', is_given(self%dt))
      call refuse('duration', is_given(self%duration))
      call refuse('events', self%events /= '')
      call refuse('tolerance', is_given(self%tolerance))
      call refuse('rho_infinity', is_given(self%rho_infinity))
      call refuse('allow_unstable', self%allow_unstable)

   contains

      !> Refuse a setting that is given and that the method does not use.
      subroutine refuse(key, given)
         character(len=*), intent(in) :: key
         logical, intent(in) :: given
         character(len=:), allocatable :: names

         if (.not. given .or. takes(method, key)) return
         call quoted_names(takes(methods, key), names)
         call messages%add('analysis: '//key//" has no meaning for method = '"//trim(method%name)// &
                           "'; remove it or set method = "//names)
      end subroutine refuse

   end subroutine validate_analysis

end module rbs_case_analysis_record
