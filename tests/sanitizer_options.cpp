// Defaults of the sanitizers for the test programs of the asan preset. Memory that other people's start-up code keeps
// until the end of the process is no finding of ours.
#include <dlfcn.h>

extern "C" const char* __asan_default_options();
extern "C" const char* __lsan_default_suppressions();

// Callers of malloc are found by unwind tables: libc keeps no frame pointers, so its vasprintf() would hide MPI's name.
extern "C" const char* __asan_default_options() {
  return "detect_stack_use_after_return=1:strict_string_checks=1:fast_unwind_on_malloc=0";
}

extern "C" const char* __lsan_default_suppressions() {
  return "leak:libopen-pal\n"
         "leak:libopen-rte\n"
         "leak:libmpi\n"
         "leak:libpmix\n"
         "leak:mca_\n"
         "leak:libhwloc\n"
         "leak:libpetsc\n"
         "leak:libgmsh\n"
         "leak:libGLX\n"
         "leak:libX11\n";
}

/// Modules stay loaded, so that the leaks of MPI's can be told from ours by the module's name.
extern "C" int dlclose(void*) noexcept { return 0; }
