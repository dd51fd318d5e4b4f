#include "runtime/graph/pass_output.h"

#include <fmt/format.h>

namespace frustum {

void warn_of_output(RunState& state, const GraphOutput& output, std::string code, std::string message) {
  state.problem({.code = std::move(code),
                 .severity = Severity::warning,
                 .pointer = output.place.pointer,
                 .message = std::move(message),
                 .file = output.place.file,
                 .line = output.place.line,
                 .column = output.place.column},
                output.layers.front().from.node);
}

NodeError empty_region(const GraphOutput& output) {
  return {"empty_region", fmt::format("output '{}' has no pixels in the region", output.name)};
}

void save_output(RunState& state, const GraphOutput& output) {
  SaveRequest request{.path = output_path(output, state.options), .metadata = state.metadata()};
  request.warn = [&](std::string_view code, const std::string& message) {
    warn_of_output(state, output, std::string(code), fmt::format("output '{}': {}", output.name, message));
  };
  request.admit = [&state](std::uint64_t all) { state.check_memory(all); };
  const Buffer all = state.buffer(output.layers.front().from),
               part = cut_to_region(all, state.options.region);
  if (part.type().is_pixels() && part.type().raster(part.data()).frame().window.empty())
    throw empty_region(output);
  state.options.save_buffer(part, request);
}

}  // namespace frustum
