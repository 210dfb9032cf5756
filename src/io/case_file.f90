!> Reads a case file and its loadings; used by the executable and by Python.
module rbs_io_case_file
   use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
   use rbs_base_error, only: error_type, message_list, fatal_error, bad_input
   use rbs_base_kinds, only: wp
   use rbs_base_text, only: to_text
   use rbs_io_loading_file, only: loading_values
   use rbs_io_namelist, only: read_case
   use rbs_loading_protocol, only: protocol_values
   use rbs_loading_loads, only: loads_type, signals, signal_names
   use rbs_loading_signal, only: signal_type
   use rbs_base_check, only: is_given, check_values
   use rbs_case_analysis_record, only: analysis_record
   use rbs_case_case_record, only: case_record
   implicit none
   private

   public :: case_history, load_case

   !> The loadings of a case.
   type :: case_history
      !> Common times (m) [s]; for a static path the numbers of its points
      real(wp), allocatable :: time(:)
      !> The prescribed displacement or force of a static path (m) [m or N]; the axial load at its points
      !> where it varies (m); empty: constant [N]
      real(wp), allocatable :: target(:), axial_load(:)
      !> The actions in time
      type(loads_type) :: loads
   end type case_history

contains

   !> Read a case and its loadings; all errors in them are returned as one.
   subroutine load_case(path, case, history, error, unloaded)
      character(len=*), intent(in) :: path
      type(case_record), intent(out) :: case
      type(case_history), intent(out) :: history
      type(error_type), allocatable, intent(out) :: error
      !> Whether a case without loading is taken, with histories of no length
      logical, intent(in), optional :: unloaded
      type(message_list) :: messages
      logical :: understood, bare

      bare = .false.
      call read_case(path, case, messages, understood)
      if (present(unloaded)) bare = unloaded .and. case%loadings == 0
      if (understood .and. bare) then
         allocate (history%time(0), history%target(0), history%axial_load(0))
         call messages%raise(error)
         return
      end if
      if (understood) call load_values(path(:index(path, '/', back=.true.)))
      call messages%raise(error)
      if (.not. allocated(error)) call cut_duration(case%analysis)

   contains

      !> Make the values of every loading that has no error of its own, and put them into `history`.
      subroutine load_values(folder)
         !> Folder of the case, with a slash at its end, or empty
         character(len=*), intent(in) :: folder
         type(error_type), allocatable :: fault
         type(message_list) :: own
         type(signal_type) :: signal
         real(wp), allocatable :: time(:), value(:)
         integer :: i, j

         allocate (history%axial_load(0))
         do i = 1, case%loadings
            associate (spec => case%loading(i))
               own = message_list()
               call spec%validate(case%analysis%dynamic(), own)
               if (own%count > 0) cycle                ! reported already
               select case (spec%source)
               case ('protocol')
                  ! Amplitudes in drift need the height; a wrong height has been reported.
                  if (.not. ieee_is_finite(case%height())) cycle
                  if (case%height() <= 0.0_wp) cycle
                  call protocol_values(spec, case%height(), time, value, fault)
               case ('values')
                  call spec%inline_values(time, value)
               case default
                  call loading_values(spec, folder, case%analysis%dynamic(), .not. case%analysis%named, &
                                      time, value, fault)
               end select
               if (.not. allocated(fault)) call check_values(value, 'loading: '//trim(spec%drive), fault)
               if (allocated(fault)) then
                  call messages%add(fault%message)
                  cycle
               end if
               signal%time = time
               signal%value = value
               ! A displacement is not an action in time.
               do j = 1, signals
                  if (spec%drive == signal_names(j)) history%loads%signal(j) = signal
               end do
               if (spec%drive == 'axial_load') then
                  history%axial_load = value
               else
                  call move_alloc(value, history%target)
               end if
               call join_times(history%time, time)
            end associate
         end do
         do j = 1, signals
            if (index(signal_names(j), 'acceleration') == 0) cycle
            if (history%loads%signal(j)%acts()) call end_in_rest(history%time, history%loads%signal(j))
         end do
         if (case%loadings == 0) call messages%add('the case has no loading; give it a group &loading')
      end subroutine load_values

      !> End the times of the history at the duration of the user: earlier, or later than the loading, whose
      !> last value is held then.
      subroutine cut_duration(spec)
         type(analysis_record), intent(in) :: spec
         real(wp) :: finish

         if (.not. spec%dynamic() .or. .not. is_given(spec%duration)) return
         finish = history%time(1) + spec%duration
         if (.not. finish > history%time(1)) then
            call fatal_error(error, bad_input, 'analysis: duration = '//to_text(spec%duration)// &
                             ' s is too short to change the time of the start, '//to_text(history%time(1))// &
                             ' s; give a longer one')
            return
         end if
         history%time = [pack(history%time, history%time < finish), finish]
      end subroutine cut_duration

   end subroutine load_case

   !> Let rest follow a record that ends before another one: a zero at the next time of all.
   subroutine end_in_rest(all_times, record)
      !> Times of all loadings, ascending [s]
      real(wp), intent(in) :: all_times(:)
      type(signal_type), intent(inout) :: record
      integer :: n, known

      n = size(record%time)
      if (n < 2) return
      ! Times up to half a step behind the end of the record count as its end: they may differ by round-off.
      known = count(all_times < 1.5_wp*record%time(n) - 0.5_wp*record%time(n - 1))
      if (known == size(all_times)) return
      record%time = [record%time, all_times(known + 1)]
      record%value = [record%value, 0.0_wp]
   end subroutine end_in_rest

   !> Merge the times of one more loading into an ascending list. Times that differ by round-off become one.
   subroutine join_times(all_times, more)
      !> Times of the loadings so far, not allocated before the first; times of one more, ascending [s]
      real(wp), allocatable, intent(inout) :: all_times(:)
      real(wp), intent(in) :: more(:)
      real(wp), allocatable :: joined(:)
      real(wp) :: same
      integer :: i, j, n

      if (.not. allocated(all_times)) then
         all_times = more
         return
      end if
      allocate (joined(size(all_times) + size(more)))
      ! Times that do not ascend are refused elsewhere.
      same = 1.0e-9_wp*max(0.0_wp, min(minval(all_times(2:) - all_times(:size(all_times) - 1)), &
                                       minval(more(2:) - more(:size(more) - 1))))
      i = 1
      j = 1
      n = 0
      do while (i <= size(all_times) .or. j <= size(more))
         n = n + 1
         if (j > size(more)) then
            joined(n) = all_times(i)
            i = i + 1
         else if (i > size(all_times)) then
            joined(n) = more(j)
            j = j + 1
         else
            joined(n) = min(all_times(i), more(j))
            if (.not. all_times(i) > joined(n) + same) i = i + 1
            if (.not. more(j) > joined(n) + same) j = j + 1
         end if
      end do
      all_times = joined(:n)
   end subroutine join_times

end module rbs_io_case_file
