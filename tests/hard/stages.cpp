#include "tests/hard/stages.h"

namespace frustum::hard {
namespace {

std::vector<HardCase> all_cases() {
  std::vector<HardCase> all;
  for (const auto stage : {foundations, transforms, quaternions, projection, clipping,   culling, lines,
                           triangles,   depth,      scanlines,   orders,     partitions, shading, shadows,
                           rays,        texture,    sampling,    colour,     curves,     runtime}) {
    const auto more = stage();
    all.insert(all.end(), more.begin(), more.end());
  }
  return all;
}

// Each has its section in docs/decisions/0003-hard-cases.md.
std::vector<stability::ArguedCase> argued_cases() {
  return {
      {"CLP-07", "the order of the planes is one constant of the code, so that two orders never meet"},
      {"ZBF-01",
       "depths of different triangulations differ by rounding; ties are decided by source, near-ties are "
       "not"},
      {"SHD-04",
       "single precision holds the cosine of a small angle only to u; the double precision of a node does"},
      {"TEX-02", "1 / w below 2^-128 is out of range in single precision: the point is dropped and counted"},
      {"SMP-08", "a sample that is not finite is named where it was made and never dropped in silence"},
  };
}

}  // namespace
}  // namespace frustum::hard

const frustum::stability::HardCases& frustum::stability::hard_cases() {
  static const HardCases all{{hard::catalogue_rows, hard::catalogue_size},
                             hard::all_cases(),
                             hard::argued_cases(),
                             hard::illustrations()};
  return all;
}
