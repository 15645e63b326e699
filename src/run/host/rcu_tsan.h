// Memory order of liburcu for ThreadSanitizer, which does not see its assembly and system call. before: everything so
// far happens before a matching "after" of the same address. Empty in other builds.
#ifndef OB_HOST_RCU_TSAN_H
#define OB_HOST_RCU_TSAN_H

#if defined(__has_feature)
#if __has_feature(thread_sanitizer)
#define OB_THREAD_SANITIZER 1
#endif
#endif
#if defined(__SANITIZE_THREAD__)
#define OB_THREAD_SANITIZER 1
#endif

#ifdef OB_THREAD_SANITIZER
#include <sanitizer/tsan_interface.h>
#define OB_ORDER_BEFORE(address) __tsan_release((void *)(address))
#define OB_ORDER_AFTER(address) __tsan_acquire((void *)(address))
#else
#define OB_ORDER_BEFORE(address) ((void)(address))
#define OB_ORDER_AFTER(address) ((void)(address))
#endif

#endif
