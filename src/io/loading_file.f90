!> From a history file to the values of a loading, in SI.
module rbs_io_loading_file
   use rbs_base_error, only: error_type, fatal_error, bad_input
   use rbs_base_kinds, only: wp
   use rbs_base_text, only: lower, list_of, suggestion, to_text
   use rbs_io_history, only: elsewhere, history_type, read_history, snippet
   use rbs_io_text_file, only: is_integer
   use rbs_base_check, only: is_given
   use rbs_loading_loading_record, only: loading_record, units_of
   use rbs_base_units, only: unit_type, to_si
   implicit none
   private

   public :: loading_values, read_test

contains

   !> Times and values of a loading with source = 'file'.
   subroutine loading_values(spec, folder, dynamic, refuse_times, time, value, error)
      !> Validated loading
      type(loading_record), intent(in) :: spec
      !> Folder that a relative path starts from, with a slash at its end, or empty
      character(len=*), intent(in) :: folder
      !> Whether the analysis is in time, so that times are needed
      logical, intent(in) :: dynamic
      !> Whether a force with times is refused, because the user has not chosen between statics and dynamics
      logical, intent(in) :: refuse_times
      !> Times (m) [s]; the number of the row in a static analysis
      real(wp), allocatable, intent(out) :: time(:)
      !> Values (m) [m, N or m/s2]
      real(wp), allocatable, intent(out) :: value(:)
      type(error_type), allocatable, intent(out) :: error
      type(history_type) :: history
      character(len=:), allocatable :: path
      integer :: column, i

      path = folder//spec%file
      if (spec%file(1:1) == '/') path = spec%file
      call read_history(path, spec%format, history, error)
      if (allocated(error)) return
      call find_column(history, path, spec%drive, spec%column, 'column', column, error)
      if (allocated(error)) return
      value = history%values(column, :)
      call check_range(value, path, column, 1.0e100_wp, error)
      if (allocated(error)) return
      call convert(history, path, column, spec%drive, spec%unit, value, error)
      if (allocated(error)) return
      value = value*spec%scale
      if (.not. dynamic) then
         if (refuse_times .and. spec%drive == 'force' .and. any(is_time(history%labels))) then
            call fatal_error(error, bad_input, path// &
                             ': the force has times; name the method in &analysis: '// &
                             "'static' for the path without inertia, or 'auto' for the response in time")
            return
         end if
         time = [(real(i - 1, wp), i=1, history%rows)]
         return
      end if
      call find_times()

   contains

      !> Take the times, in seconds, from their column or from the interval between rows.
      subroutine find_times()
         character(len=*), parameter :: seconds(5) = [character(len=7) :: '', 's', 'sec', 'second', 'seconds']
         integer :: column, i

         column = findloc(is_time(history%labels), .true., dim=1)
         if (spec%time_column /= '') then
            call find_column(history, path, 'time', spec%time_column, 'time_column', column, error)
            if (allocated(error)) return
         end if
         if (column > 0) then
            if (is_given(spec%interval)) then
               call fatal_error(error, bad_input, path//': interval is given, and the times are in '// &
                                'column '//to_text(column)//' '//trim(history%labels(column))// &
                                ' as well; remove interval')
               return
            end if
            if (all(seconds /= lower(unit_of(history%labels(column))))) then
               call fatal_error(error, bad_input, path//': the times of column '// &
                                trim(history%labels(column))//' are not in seconds; convert them and '// &
                                'name the column time_s')
               return
            end if
            time = history%values(column, :)
            call check_range(time, path, column, 1.0e100_wp, error)
            if (allocated(error)) return
            do i = 2, size(time)
               if (time(i) > time(i - 1)) cycle
               call fatal_error(error, bad_input, path//': row '//to_text(i)//' of the times, '// &
                                to_text(time(i))//' s, does not come after the row before, '// &
                                to_text(time(i - 1))//' s; times must ascend strictly')
               return
            end do
         else if (is_given(spec%interval)) then
            if (allocated(history%stated)) then
               if (index(lower(history%stated), 'hz') > 0) then
                  call fatal_error(error, bad_input, path//": the rate that a comment states ('"// &
                                   snippet(history%stated)//"') is not read; remove the comment ("// &
                                   elsewhere//')')
                  return
               end if
            end if
            time = [((i - 1)*spec%interval, i=1, history%rows)]
         else
            call fatal_error(error, bad_input, path//': has no column with the time; give the time from '// &
                             'row to row with interval, in s, or name the column with time_column')
         end if
      end subroutine find_times

   end subroutine loading_values

   !> Read the displacements [m] and forces [N] of a measured test.
   subroutine read_test(path, units, name, values, error)
      character(len=*), intent(in) :: path
      !> Units of displacement and force; blank: the unit in the name of the column, else SI
      character(len=*), intent(in) :: units(2)
      !> Name of the test; not allocated if it cannot be read
      character(len=:), allocatable, intent(out) :: name
      !> Displacements and forces (rows, 2)
      real(wp), allocatable, intent(out) :: values(:, :)
      type(error_type), allocatable, intent(out) :: error
      type(history_type) :: history
      character(len=12), parameter :: drives(2) = ['displacement', 'force       ']
      integer :: column, i

      call read_history(path, 'auto', history, error)
      if (allocated(error)) return
      if (history%columns < 2) then
         call fatal_error(error, bad_input, path//': has one column; a test has displacements and forces')
         return
      end if
      allocate (values(history%rows, 2))
      ! Else `find_column` would take the one column beside a time for the displacement and for the force too.
      if (history%columns == 2 .and. is_time(history%labels(1))) history%labels(1) = 'a time'
      do i = 1, 2
         call find_column(history, path, drives(i), '', 'column', column, error)
         if (allocated(error)) return
         values(:, i) = history%values(column, :history%rows)
         call check_range(values(:, i), path, column, 1.0e300_wp, error)
         if (allocated(error)) return
         call convert(history, path, column, drives(i), units(i), values(:, i), error)
         if (allocated(error)) return
      end do
      name = history%name
   end subroutine read_test

   !> The column with the name or number that the user gives; without one the column that is named after the
   !> drive, or the only column beside a time.
   subroutine find_column(history, path, drive, word, key, column, error)
      type(history_type), intent(in) :: history
      !> Path of the file, for messages; what is driven; name or number of the column, or blank
      character(len=*), intent(in) :: path, drive, word
      !> Key under which the user gives the word, for messages
      character(len=*), intent(in) :: key
      integer, intent(out) :: column
      type(error_type), allocatable, intent(out) :: error
      character(len=64) :: wanted, label(size(history%labels))
      character(len=:), allocatable :: available

      column = 0
      label = lower(history%labels)
      available = 'columns: '//list_of(history%labels)
      if (all(history%labels == '')) available = to_text(history%columns)//' columns without names'
      if (word == '') then
         wanted = drive
         if (drive == 'ground_acceleration') wanted = 'acceleration'
         ! Files often have short names: 'vertical_g', 'axial_kN'.
         if (drive == 'vertical_acceleration') wanted = 'vertical'
         if (drive == 'axial_load') wanted = 'axial'
         column = findloc(index(label, trim(wanted)) == 1 .or. index(label, trim(drive)) == 1, .true., dim=1)
         if (column > 0) return
         if (history%columns == 1 .and. .not. is_time(history%labels(1))) column = 1
         if (history%columns == 2 .and. is_time(history%labels(1))) column = 2
         if (column == 0) then
            call fatal_error(error, bad_input, path//": no column is named after '"//trim(drive)// &
                             "' ("//available//'); name one with '//key)
         end if
      else if (is_integer(trim(word))) then
         read (word, '(i9)') column
         if (column < 1 .or. column > history%columns) then
            call fatal_error(error, bad_input, path//': '//key//' = '//trim(word)//', but the columns '// &
                             'are 1 to '//to_text(history%columns))
         end if
      else
         column = findloc(label == lower(word), .true., dim=1)
         if (count(label == lower(word)) > 1) then
            call fatal_error(error, bad_input, path//': '//key//" = '"//trim(word)//"' is the name of "// &
                             'more than one column; give the number of the column')
         else if (column == 0) then
            call fatal_error(error, bad_input, path//': '//key//" = '"//trim(word)//"' is not there ("// &
                             available//')'//suggestion(word, history%labels))
         end if
      end if
   end subroutine find_column

   !> Convert values to SI from the unit that the user gives, else from the unit in the column's name (a PEER
   !> file is given such names); other values are in SI.
   subroutine convert(history, path, column, drive, unit, value, error)
      type(history_type), intent(in) :: history
      !> Path of the file, for messages; what is driven; unit that the user gives, or blank
      character(len=*), intent(in) :: path, drive, unit
      integer, intent(in) :: column
      real(wp), intent(inout) :: value(:)
      type(error_type), allocatable, intent(out) :: error
      type(unit_type), allocatable :: units(:)
      character(len=8), allocatable :: names(:)
      character(len=64) :: name
      logical :: stated
      integer :: i

      allocate (units, source=units_of(drive))
      name = unit
      ! A unit that a comment states is not read: refused, unless the user gives a unit that agrees.
      stated = allocated(history%stated) .and. unit_of(history%labels(column)) == ''
      ! Rates of loading are no units of what is driven.
      if (stated) stated = index(drive, 'acceleration') > 0 .or. index(lower(history%stated), 'unit') > 0
      if (stated) stated = unit == '' .or. .not. agrees(lower(history%stated), lower(unit))
      if (stated) then
         call fatal_error(error, bad_input, path//": the unit that a comment states ('"// &
                          snippet(history%stated)//"') is not read; remove the comment and give the "// &
                          'unit with unit, or in the name of the column ('//elsewhere//')')
         return
      end if
      if (name == '') name = unit_of(history%labels(column))
      if (name == '') return
      names = units%name
      i = findloc(lower(names) == lower(name), .true., dim=1)
      if (i > 0) then
         value = to_si(value, units(i))
      else
         call fatal_error(error, bad_input, path//": the unit '"//trim(name)//"' of column "// &
                          trim(history%labels(column))//' is not one of '//list_of(names)// &
                          '; give the right one with unit ('//elsewhere//')')
      end if
   end subroutine convert

   !> Whether a comment names a unit; a unit of a single letter counts only in brackets: [g] or (g). Both are
   !> in lower case.
   pure logical function agrees(comment, unit)
      character(len=*), intent(in) :: comment, unit

      agrees = index(comment, trim(unit)) > 0
      if (len_trim(unit) > 1) return
      agrees = index(comment, '['//trim(unit)//']') > 0 .or. index(comment, '('//trim(unit)//')') > 0
   end function agrees

   !> Refuse values that are so large that conversion, scale or squares would overflow.
   subroutine check_range(value, path, column, largest, error)
      real(wp), intent(in) :: value(:)
      character(len=*), intent(in) :: path
      !> Number of the column, for the message
      integer, intent(in) :: column
      !> Largest size that is accepted
      real(wp), intent(in) :: largest
      type(error_type), allocatable, intent(out) :: error
      integer :: i

      i = findloc(abs(value) <= largest, .false., dim=1)
      if (i == 0) return
      call fatal_error(error, bad_input, path//': row '//to_text(i)//' of column '//to_text(column)//', '// &
                       to_text(value(i))//', is outside the range of the arithmetic; correct the file')
   end subroutine check_range

   !> The unit at the end of a column's name: `_mm`, ` (mm)`, `[mm]`, `/mm`, `-mm`, ` mm`; blank without one.
   pure function unit_of(label) result(unit)
      character(len=*), intent(in) :: label
      character(len=len(label)) :: unit
      integer :: last, mark

      unit = ''
      last = len_trim(label)
      if (last == 0) return
      if (scan(label(last:last), ')]') == 1) last = last - 1
      mark = scan(label(:last), '_([ ', back=.true.)
      ! A slash or a dash may belong to the unit itself: m/s2.
      if (mark == 0) mark = scan(label(:last), '/-')
      if (mark > 0) unit = adjustl(label(mark + 1:last))
   end function unit_of

   !> Whether a column's name is that of times: t, time, time_s.
   elemental logical function is_time(label)
      character(len=*), intent(in) :: label

      is_time = lower(label) == 't' .or. lower(label) == 't_s' .or. index(lower(label), 'time') == 1
   end function is_time

end module rbs_io_loading_file
