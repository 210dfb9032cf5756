!> Joints one above the other that nothing couples, driven by the displacement of the top: small rotations
!> without axial load.
module rbs_solve_static_diagonal
   use rbs_base_constants, only: no_stiffness
   use rbs_base_kinds, only: wp
   implicit none
   private

   public :: follow_diagonal

contains

   !> The joints share the force, and their motions add up. The force is that of the most flexible joint p and
   !> what takes the others to it, F' = -r_p/a_p + F'': with F' itself, its motion (r_p + a_p F')/k_p would be
   !> a difference of round-off over next to nothing.
   pure subroutine follow_diagonal(arm, initial, k, r, gap, rate, force_rate, correction, force_correction, &
                                   regular)
      !> Arms of the force and initial stiffness of the joints (m)
      real(wp), intent(in) :: arm(:), initial(:)
      !> Stiffness of the springs, residual (m), and what is missing from the displacement [m]
      real(wp), intent(in) :: k(:), r(:), gap
      !> Change of the deformations per metre, and what takes the residuals away (m)
      real(wp), intent(out), contiguous :: rate(:), correction(:)
      !> Change of the force [N/m], and of the force with the correction [N]
      real(wp), intent(out) :: force_rate, force_correction
      !> Whether there is a unique solution
      logical, intent(out) :: regular
      real(wp) :: flexible(size(arm)), flexibility
      integer :: i, p

      regular = .true.
      p = 1
      do i = 1, size(arm)
         flexible(i) = 0.0_wp
         if (abs(k(i)) > no_stiffness*initial(i)) then
            flexible(i) = arm(i)**2/k(i)
            if (regular .and. abs(flexible(i)) > abs(flexible(p))) p = i
         else
            regular = .false.
            p = i
         end if
      end do
      if (regular) then
         ! Softening joints have a negative flexibility; with that of the others it may vanish.
         flexibility = sum(flexible)
         regular = abs(flexibility) > no_stiffness*sum(abs(flexible))
         if (.not. regular) return
         force_rate = 1.0_wp/flexibility
         rate = flexible/arm*force_rate
      else
         regular = .true.
         force_rate = 0.0_wp
         call follow_mechanism(arm, initial, flexible, rate)
      end if
      force_correction = -r(p)/arm(p)
      correction = flexible/arm*(r/arm + force_correction)
      associate (missing => gap - sum(arm*correction))
         correction = correction + rate*missing
         force_correction = force_correction + force_rate*missing
      end associate
   end subroutine follow_diagonal

   !> Joints without stiffness take all the motion. Several share it as they would with a hardening in
   !> proportion to their initial stiffness, however small.
   pure subroutine follow_mechanism(arm, initial, flexible, rate)
      real(wp), intent(in) :: arm(:), initial(:)
      !> Flexibility, 0 where there is no stiffness
      real(wp), intent(in) :: flexible(:)
      real(wp), intent(out) :: rate(:)

      rate = 0.0_wp
      where (.not. abs(flexible) > 0.0_wp) rate = arm/initial
      rate = rate/sum(arm*rate)
   end subroutine follow_mechanism

end module rbs_solve_static_diagonal
