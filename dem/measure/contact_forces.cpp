#include "dem/measure/contact_forces.hpp"

#include <algorithm>
#include <cmath>

namespace dem {
namespace {

constexpr double most_classes = 1000;

/// `towards`: from the partner to the grain that the force acts on.
ContactForce split(const Vec3& force, const Vec3& towards) {
  const double length = norm(towards);
  if (length == 0) return {norm(force), 0};  // two spheres on one spot: no direction
  const Vec3 normal = towards * (1 / length);
  const double along = dot(force, normal);
  return {along, norm(force - normal * along)};
}

/// Density over classes of this width of the values over their mean.
std::vector<double> density(const std::vector<double>& values, double width) {
  double sum = 0, largest = 0;
  for (const double value : values) sum += value, largest = std::max(largest, value);
  const double mean = sum / static_cast<double>(values.size());
  if (!(mean > 0)) return {1 / width};  // all of them zero
  const double classes = std::min(std::floor(largest / mean / width) + 1, most_classes);
  std::vector<double> result(static_cast<std::size_t>(classes), 0.0);
  const double each = 1 / (width * static_cast<double>(values.size()));
  for (const double value : values)
    result[static_cast<std::size_t>(std::clamp(value / mean / width, 0.0, classes - 1))] += each;
  return result;
}

}  // namespace

std::vector<ContactForce> contact_forces(const Region* region, std::span<const GrainContact> grain_contacts,
                                         std::span<const WallContact> wall_contacts) {
  std::vector<ContactForce> forces;
  for (const GrainContact& contact : grain_contacts) {
    if (region == nullptr || contains(*region, 0.5 * (contact.position_i + contact.position_j)))
      forces.push_back(split(contact.force, contact.position_i - contact.position_j));
  }
  for (const WallContact& contact : wall_contacts) {
    if (region == nullptr || contains(*region, contact.point))
      forces.push_back(split(contact.force, contact.grain_position - contact.point));
  }
  return forces;
}

double mean_normal_force(std::span<const ContactForce> forces) {
  double sum = 0;
  for (const ContactForce& force : forces) sum += force.normal;
  return forces.empty() ? 0 : sum / static_cast<double>(forces.size());
}

double share_above_mean(std::span<const ContactForce> forces) {
  if (forces.empty()) return 0;
  const double mean = mean_normal_force(forces);
  const auto above =
      std::count_if(forces.begin(), forces.end(), [mean](const ContactForce& force) { return force.normal > mean; });
  return static_cast<double>(above) / static_cast<double>(forces.size());
}

double normal_force_quantile(std::span<const ContactForce> forces, double share) {
  if (forces.empty()) return 0;
  std::vector<double> sorted;
  for (const ContactForce& force : forces) sorted.push_back(force.normal);
  std::sort(sorted.begin(), sorted.end());
  const double place = share * static_cast<double>(sorted.size() - 1);
  const auto below =
      static_cast<std::size_t>(std::clamp(std::floor(place), 0.0, static_cast<double>(sorted.size() - 1)));
  const std::size_t above = std::min(below + 1, sorted.size() - 1);
  return sorted[below] + (place - static_cast<double>(below)) * (sorted[above] - sorted[below]);
}

ForceHistogram force_histogram(std::span<const ContactForce> forces, double width) {
  ForceHistogram histogram{width, {}, {}};
  if (forces.empty()) return histogram;
  std::vector<double> normal, shear;
  for (const ContactForce& force : forces) {
    normal.push_back(force.normal);
    shear.push_back(force.shear);
  }
  histogram.normal = density(normal, width);
  histogram.shear = density(shear, width);
  const std::size_t classes = std::max(histogram.normal.size(), histogram.shear.size());
  histogram.normal.resize(classes, 0.0);
  histogram.shear.resize(classes, 0.0);
  return histogram;
}

}  // namespace dem
