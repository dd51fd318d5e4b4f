#include "nodes/supersample/pattern.h"

#include "nodes/supersample.h"
#include "runtime/buffers/pattern.h"
#include "runtime/core/node_type.h"

#include <fmt/format.h>

namespace frustum {
namespace kernels {
constexpr auto choices(PatternKind) {
  return std::array{std::pair{PatternKind::grid, "grid"}, std::pair{PatternKind::jittered, "jittered"},
                    std::pair{PatternKind::sobol, "sobol"}, std::pair{PatternKind::standard, "standard"}};
}
}  // namespace kernels
namespace {

struct Inputs {};
struct Params {
  int samples = 16;
  kernels::PatternKind kind = kernels::PatternKind::sobol;
};
struct Outputs {
  Ref<SamplePattern> pattern;
};

void check(const Params& p) {
  if (p.kind == kernels::PatternKind::standard && !kernels::has_standard_samples(p.samples))
    throw NodeError(
        "no_standard_samples",
        fmt::format("there are standard places for 1, 2, 4, 8 and 16 samples, not for {}", p.samples),
        at_param("samples"));
}

Outputs run(const Inputs&, const Params& p, Context& ctx) {
  auto out = std::make_shared<SamplePattern>();
  out->samples = p.samples;
  out->period = kernels::pattern_period(p.kind);
  const auto samples = static_cast<std::size_t>(p.samples), period = static_cast<std::size_t>(out->period);
  out->x.resize(samples * period * period);
  out->y.resize(samples * period * period);
  supersample::fill_pattern(p.kind, ctx.seed, samples, period, out->x, out->y);
  return {std::move(out)};
}

}  // namespace

NodeType nodes::supersample_pattern() {
  return node("supersample.pattern", run)
      .doc(
          "Where the samples of each pixel lie, on steps of 1/4096 px; the seed of the run moves all but the "
          "grid.")
      .cite("Vulkan 1.3 and Direct3D 11.3, standard sample locations")
      .cite("Sobol 1967; Owen 1995; Burley 2020, JCGT 9(4); Cook 1986 (jittered)")
      .covers(93)
      .param("samples", &Params::samples,
             "Samples a pixel; raising it lowers noise and aliasing, at the cost of time.",
             {.range = between(1, 1024)})
      .knob({"1", "2", "4", "8", "16", "32", "64", "256"},
            "An edge crosses sqrt(n) strata of n, each with variance 1/n^2: RMSE n^-3/4 (Mitchell 1996); "
            "random n^-1/2.",
            -0.75)
      .param("kind", &Params::kind,
             "grid repeats in every pixel; jittered and sobol differ over 64 x 64; standard is Vulkan's and "
             "Direct3D's.")
      .knob({"grid", "jittered", "sobol"},
            "At the same number: a grid aliases along rows, jitter is noise, sobol also stratifies every row "
            "and column.")
      .check(check)
      .output("pattern", &Outputs::pattern,
              "The pattern; sobol fills every dyadic rectangle once where samples is 2^k.");
}

}  // namespace frustum
