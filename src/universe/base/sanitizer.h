// OB_SANITIZED: 1 in a build with a sanitizer that the compiler reports, else 0. gcc reports no undefined-behaviour
// sanitizer.
#ifndef OB_BASE_SANITIZER_H
#define OB_BASE_SANITIZER_H

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
#define OB_SANITIZED 1
#elif defined(__has_feature)
#if __has_feature(address_sanitizer) || __has_feature(thread_sanitizer) || __has_feature(undefined_behavior_sanitizer)
#define OB_SANITIZED 1
#endif
#endif
#ifndef OB_SANITIZED
#define OB_SANITIZED 0
#endif

#endif
