// What isolation costs: a thousand small cases, each in a process of its own.
#include "runtime/app/files.h"
#include "runtime/app/suite/run.h"

#include <benchmark/benchmark.h>
#include <fmt/format.h>

#include <filesystem>

namespace frustum {
namespace {

// The teapot tessellated coarsely and drawn at 16 x 9, with a check of its size: all stages, little work.
std::string small_suite(const std::filesystem::path& folder, int cases) {
  const auto graph = source_root(executable_path()).value_or(".") / "graphs/gallery/teapot_stages.json";
  std::string list;
  for (int i = 0; i < cases; ++i)
    list += fmt::format(R"({}{{"id": "{}", "graph": "{}", "set": {{"resolution": [16, 9], "samples": 1,
                             "mesh:tolerance_px": 8, "camera:fov_y": {}}},
                             "checks": [{{"port": "pixels", "shape": {{"width": 16}}}}]}})",
                        i == 0 ? "" : ",", i, graph.string(), 30 + i % 20);
  const auto path = folder / "suites" / "many.json";
  write_text(path, R"({"format": "frustum.suite/1", "cases": [)" + list + "]}");
  return path.string();
}

void suite_of_small_cases(benchmark::State& state) {
  const auto folder = std::filesystem::temp_directory_path() / "frustum_suite_bench";
  Diagnostics problems;
  const auto suite = load_suite(small_suite(folder, static_cast<int>(state.range(0))), problems);
  SuiteOptions options;
  options.isolate = state.range(1) != 0;
  if (!suite) return state.SkipWithError(to_text(problems).c_str());
  for (auto _ : state) {
    Session session;
    for (const CaseResult& r : run_suites(session, {*suite}, options, [](const CaseResult&) {}))
      if (r.verdict != CaseVerdict::pass) return state.SkipWithError(r.failures.front().c_str());
  }
  state.counters["ms_a_case"] =
      benchmark::Counter(static_cast<double>(state.range(0)) * 1e-3,
                         benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
  std::filesystem::remove_all(folder);
}
BENCHMARK(suite_of_small_cases)
    ->ArgNames({"cases", "isolated"})
    ->Args({1000, 1})
    ->Iterations(1)
    ->UseRealTime()
    ->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace frustum
