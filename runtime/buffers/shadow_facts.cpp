#include "runtime/buffers/shadow_facts.h"

#include "nodes/kernels/predicates.h"
#include "nodes/kernels/vector.h"

#include <fmt/format.h>

#include <algorithm>

namespace frustum {
namespace {

constexpr std::size_t most_tests = std::size_t{1} << 20;

// A light this little above a face, as a sine, may be hidden by what is level with the face but for rounding.
constexpr double least_elevation = 0x1p-20;

glm::dvec3 vector_of(const kernels::Triple<double>& t) { return {t[0], t[1], t[2]}; }

bool stands_in_front(const kernels::LightSource<double>& light, const std::array<glm::dvec3, 3>& corner) {
  const glm::dvec3 n =
      kernels::normalized_or(kernels::cross(corner[1] - corner[0], corner[2] - corner[0]), glm::dvec3(0));
  return std::all_of(corner.begin(), corner.end(), [&](const glm::dvec3& p) {
    const glm::dvec3 to = light.is_point ? vector_of(light.place) - p : vector_of(light.place);
    return kernels::dot(n, to) > least_elevation * kernels::norm(to);
  });
}

std::string witness(const ShadowScene& s, const kernels::LightSource<double>& light, std::size_t index,
                    std::size_t& tests) {
  for (std::size_t f = 0; f < s.faces.size(); ++f) {
    const glm::uvec3& t = s.faces[f];
    const std::array corner{s.seen[t.x], s.seen[t.y], s.seen[t.z]};
    if (!stands_in_front(light, corner))
      return fmt::format("light source {} does not stand in front of face {}", index, f);
    for (std::size_t v = 0; v < s.casters.size(); ++v) {
      if (tests-- == 0) {
        tests = 0;
        return fmt::format("{} faces are too many to be shown to be free in front", s.faces.size());
      }
      if (kernels::orientation(corner[0], corner[1], corner[2], s.casters[v]) < 0)
        return fmt::format("vertex {} of what casts shadows stands in front of face {}", v, f);
    }
  }
  return "";
}

}  // namespace

std::vector<std::string> witnesses_of_shadow(const ShadowScene& s,
                                             std::span<const kernels::LightSource<double>> sources) {
  std::size_t tests = most_tests;
  std::vector<std::string> all;
  for (std::size_t i = 0; i < sources.size(); ++i) all.push_back(witness(s, sources[i], i, tests));
  return all;
}

Verdict needs_shadows(std::span<const std::string> witnesses, std::size_t caster_faces,
                      std::uint64_t points) {
  const std::uint64_t all = points * witnesses.size();
  if (witnesses.empty()) return off_exact("no light but ambient light, which casts no shadow");
  if (caster_faces == 0) return off_exact("nothing casts a shadow: 'casters' has no faces", all);
  const auto first =
      std::find_if(witnesses.begin(), witnesses.end(), [](const auto& w) { return !w.empty(); });
  if (first != witnesses.end()) return on(*first, all);
  return off_exact("every light stands in front of every face, and nothing stands in front of any", all);
}

}  // namespace frustum
