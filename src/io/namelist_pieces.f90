!> The pieces that a namelist file is cut into: groups, entries, values.
module rbs_io_namelist_pieces
   implicit none
   private

   public :: nml_value, nml_entry, nml_group, nml_scan, add_group, add_entry, add_value

   !> One value as written in the file.
   type :: nml_value
      !> Repeat count (`3*0.5`)
      integer :: times = 1
      !> Its text, quotes included
      character(len=:), allocatable :: text
   end type nml_value

   !> `name = values` or `name(i) = values`.
   type :: nml_entry
      character(len=32) :: name = ''
      !> Subscript, 0 without one
      integer :: subscript = 0
      !> Line in the file
      integer :: line = 0
      integer :: values = 0
      type(nml_value), allocatable :: value(:)
   end type nml_entry

   !> One `&name ... /`.
   type :: nml_group
      character(len=32) :: name = ''
      integer :: line = 0
      !> Its entries are `first` to `last` of the scan
      integer :: first = 1, last = 0
   end type nml_group

   type :: nml_scan
      integer :: groups = 0, entries = 0
      type(nml_group), allocatable :: group(:)
      type(nml_entry), allocatable :: entry(:)
   end type nml_scan

contains

   !> Start a group.
   subroutine add_group(scanned, name, line)
      type(nml_scan), intent(inout) :: scanned
      character(len=*), intent(in) :: name
      integer, intent(in) :: line
      type(nml_group), allocatable :: longer(:)

      if (scanned%groups == size(scanned%group)) then
         allocate (longer(2*scanned%groups))
         longer(:scanned%groups) = scanned%group
         call move_alloc(longer, scanned%group)
      end if
      scanned%groups = scanned%groups + 1
      scanned%group(scanned%groups)%name = name
      scanned%group(scanned%groups)%line = line
      scanned%group(scanned%groups)%first = scanned%entries + 1
      scanned%group(scanned%groups)%last = scanned%entries
   end subroutine add_group

   !> Start an entry of the present group.
   subroutine add_entry(scanned, name, line)
      type(nml_scan), intent(inout) :: scanned
      character(len=*), intent(in) :: name
      integer, intent(in) :: line
      type(nml_entry), allocatable :: longer(:)
      integer :: i

      if (scanned%entries == size(scanned%entry)) then
         allocate (longer(2*scanned%entries))
         do i = 1, scanned%entries
            longer(i)%name = scanned%entry(i)%name
            longer(i)%subscript = scanned%entry(i)%subscript
            longer(i)%line = scanned%entry(i)%line
            longer(i)%values = scanned%entry(i)%values
            call move_alloc(scanned%entry(i)%value, longer(i)%value)
         end do
         call move_alloc(longer, scanned%entry)
      end if
      scanned%entries = scanned%entries + 1
      scanned%entry(scanned%entries)%name = name
      scanned%entry(scanned%entries)%line = line
   end subroutine add_entry

   !> Append a value to an entry.
   subroutine add_value(entry, times, text)
      type(nml_entry), intent(inout) :: entry
      integer, intent(in) :: times
      character(len=*), intent(in) :: text
      type(nml_value), allocatable :: longer(:)
      integer :: i

      if (.not. allocated(entry%value)) allocate (entry%value(4))
      if (entry%values == size(entry%value)) then
         allocate (longer(2*entry%values))
         do i = 1, entry%values
            longer(i)%times = entry%value(i)%times
            call move_alloc(entry%value(i)%text, longer(i)%text)
         end do
         call move_alloc(longer, entry%value)
      end if
      entry%values = entry%values + 1
      entry%value(entry%values)%times = times
      entry%value(entry%values)%text = text
   end subroutine add_value

end module rbs_io_namelist_pieces
