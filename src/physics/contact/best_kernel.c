#include "contact/kernel.h"

const ob_kernel *ob_kernel_best(void)
{
#ifdef OB_HAVE_AVX512
	if (__builtin_cpu_supports("avx512vl") && __builtin_cpu_supports("avx512dq"))
		return &ob_kernel_avx512;
#endif
#ifdef OB_HAVE_AVX2
	if (__builtin_cpu_supports("avx2"))
		return &ob_kernel_avx2;
#endif
	return &ob_kernel_portable;
}
