#pragma once
// Memory that the C library holds back after it has been freed.
#include <cstdlib>  // says __GLIBC__

#ifdef __GLIBC__
#include <malloc.h>
#endif

namespace base {

/// Gives freed memory back to the system, where the C library knows how.
inline void release_memory() {
#ifdef __GLIBC__
  malloc_trim(0);
#endif
}

}  // namespace base
