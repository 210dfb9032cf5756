!> The state that an analysis ended in, as a file: a head, the number of numbers, one number a line.
module rbs_io_state_file
   use rbs_base_error, only: error_type, fatal_error, bad_input
   use rbs_base_kinds, only: wp
   use rbs_base_stream, only: stream_type
   use rbs_base_text, only: to_text
   use rbs_io_output_file, only: output_file
   use rbs_version, only: version
   implicit none
   private

   public :: read_state, write_state

   character(len=*), parameter :: first_line = '# rbsdem state'

   !> More numbers than this are none.
   integer, parameter :: most_numbers = 100000000

contains

   !> Read the numbers of a state.
   subroutine read_state(path, stream, error)
      character(len=*), intent(in) :: path
      !> Takes the numbers; `restore` of an object is left to the caller
      type(stream_type), intent(inout) :: stream
      type(error_type), allocatable, intent(out) :: error
      integer :: unit, status
      logical :: understood

      open (newunit=unit, file=path, status='old', action='read', iostat=status)
      if (status /= 0) then
         call fatal_error(error, bad_input, 'analysis: initial: '//path//' cannot be read; check the path')
         return
      end if
      call read_numbers()
      close (unit)
      if (understood) return
      call fatal_error(error, bad_input, 'analysis: initial: '//path//' is no state of rbsdem, or it is '// &
                       'damaged; the key state of the group output writes one')

   contains

      !> Read the first line, the remarks (#), the number of numbers, and the numbers into the stream;
      !> `understood` says whether all were there.
      subroutine read_numbers()
         character(len=80) :: line
         integer :: status, i, count

         understood = .false.
         read (unit, '(a)', iostat=status) line
         if (status /= 0 .or. line /= first_line) return
         do
            read (unit, '(a)', iostat=status) line
            if (status /= 0) return
            if (line(1:1) /= '#') exit
         end do
         read (line, *, iostat=status) count
         if (status /= 0 .or. count < 1 .or. count > most_numbers) return
         if (allocated(stream%value)) deallocate (stream%value)
         allocate (stream%value(count))
         do i = 1, count
            read (unit, *, iostat=status) stream%value(i)
            if (status /= 0) return
         end do
         understood = .true.
         stream%count = count
      end subroutine read_numbers

   end subroutine read_state

   !> Write the numbers of a state, whole or not at all.
   subroutine write_state(path, stream, error)
      character(len=*), intent(in) :: path
      type(stream_type), intent(in) :: stream
      type(error_type), allocatable, intent(inout) :: error
      type(output_file) :: file
      character(len=32) :: number
      integer :: i

      call file%open(path, error)
      if (allocated(error)) return
      call file%put(first_line//new_line('a')//'# version: '//trim(version)//new_line('a')// &
                    to_text(stream%count)//new_line('a'), error)
      do i = 1, stream%count
         write (number, '(es24.16e3)') stream%value(i)
         call file%put(trim(adjustl(number))//new_line('a'), error)
      end do
      call file%close(.not. allocated(error), .false., error)
   end subroutine write_state

end module rbs_io_state_file
