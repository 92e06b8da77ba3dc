#pragma once
// A display for drawing where there is no screen. Debian's VTK draws through X even when no window is to be seen. So
// the pictures are drawn on a virtual X server of our own: the same on a laptop, a cluster node and in a container, and
// without a window that pops up. (xvfb-run would do the same, but needs xauth and a second start of the program.)
#include <sys/types.h>

namespace coupling {

/// Starts Xvfb and points DISPLAY to it for as long as the object lives. Where Xvfb is not installed the display that
/// DISPLAY names is used as it is. Throws base::UserError, saying what to install, when there is neither.
class VirtualDisplay {
 public:
  VirtualDisplay();
  ~VirtualDisplay();
  VirtualDisplay(const VirtualDisplay&) = delete;
  VirtualDisplay& operator=(const VirtualDisplay&) = delete;

 private:
  pid_t server_ = -1;
};

}  // namespace coupling
