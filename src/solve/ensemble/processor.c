/* What the processor can do; gfortran has no way to ask. */
int rbs_processor_level(void);

int rbs_processor_level(void)
{
#if defined(__x86_64__) && defined(__GNUC__)
   __builtin_cpu_init();
   if (__builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") &&
       __builtin_cpu_supports("avx512vl"))
      return 3;
   if (__builtin_cpu_supports("avx2")) return 2;
#endif
   return 1;
}
