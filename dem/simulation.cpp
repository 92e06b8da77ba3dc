#include <omp.h>

#include "base/error.hpp"
#include "dem/backends.hpp"

namespace dem {

bool cuda_built() {
#if defined(TRACKBED_WITH_CUDA)
  return true;
#else
  return false;
#endif
}

bool cuda_available(std::string* why_not) {
#if defined(TRACKBED_WITH_CUDA)
  return cuda_device_present(why_not);
#else
  if (why_not) *why_not = "this program was built without CUDA";
  return false;
#endif
}

std::unique_ptr<Simulation> Simulation::create(const Setup& setup, Backend backend) {
  if (backend == Backend::omp) return create_omp(setup);
  std::string why_not;
  const bool available = cuda_available(&why_not);
  base::require_user(available, "backend = cuda cannot be used: " + why_not);
#if defined(TRACKBED_WITH_CUDA)
  return create_cuda(setup);
#else
  return nullptr;
#endif
}

std::function<Picture()> Simulation::picture() const {
  return [picture = Picture{grains(), grain_contacts(), wall_contacts()}]() mutable { return std::move(picture); };
}

std::function<base::Columns()> Simulation::saved() const {
  return [columns = save()]() mutable { return std::move(columns); };
}

void use_device([[maybe_unused]] int number) {
#if defined(TRACKBED_WITH_CUDA)
  cuda_use_device(number);
#endif
}

std::string device_text() {
#if defined(TRACKBED_WITH_CUDA)
  return cuda_device_text();
#else
  return "";
#endif
}

void set_threads(int threads) { omp_set_num_threads(threads); }

}  // namespace dem
