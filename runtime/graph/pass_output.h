// What a pass writes: files of pixels band by band, and buffers whole.
#pragma once

#include "runtime/graph/run_state.h"

#include <memory>
#include <span>
#include <string>
#include <type_traits>

namespace frustum {

void warn_of_output(RunState& state, const GraphOutput& output, std::string code, std::string message);

NodeError empty_region(const GraphOutput& output);

// A buffer goes to its file whole, or of pixels the region asked for. Throws empty_region().
void save_output(RunState& state, const GraphOutput& output);

// Remembers which output it was that failed: a pass writes several files at once.
class NamedSink : public Sink {
 public:
  NamedSink(RunState& state, std::size_t output, const SinkRequest& request)
      : state_(state), output_(output), file_(named([&] { return state.options.make_sink(request); })) {}
  void write(std::span<const Tile> layers) override {
    named([&] { file_->write(layers); });
  }
  void finish() override {
    named([&] { file_->finish(); });
  }

 private:
  template <class F>
  std::invoke_result_t<F> named(F&& f) {
    try {
      return f();
    } catch (...) {
      state_.output_failed(output_);
      throw;
    }
  }

  RunState& state_;
  std::size_t output_;
  std::unique_ptr<Sink> file_;
};

}  // namespace frustum
