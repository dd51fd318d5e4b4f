// A graph written as text, run by the program's own session with the libraries of this tree.
#pragma once

#include "runtime/app/session.h"
#include "runtime/buffers/image.h"
#include "tests/support/source_dir.h"
#include "tests/support/temp_file.h"

#include <fmt/format.h>

#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

namespace frustum::test {

struct SessionRun {
  RunResult result;
  std::vector<Buffer> buffers;  // by address

  const Raster& image(std::size_t i = 0) const { return buffers.at(i).as<Image>()->raster; }
  // "code: message" of every diagnostic of the run.
  std::string said() const {
    std::string all;
    for (const Diagnostic& d : result.problems.list()) all += d.code + ": " + d.message + "\n";
    return all;
  }
};

// Throws std::runtime_error with the diagnostics where the graph does not load.
inline SessionRun run_in_session(const TempFolder& folder, std::string_view graph,
                                 const std::vector<std::string>& wanted, std::uint64_t memory = 0) {
  Session session;
  Loaded loaded = session.load(folder.write("graph.json", graph),
                               {.library_folders = {std::string(FRUSTUM_SOURCE_DIR) + "/graphs/lib"}});
  if (!loaded.graph) throw std::runtime_error(to_text(loaded.problems));
  RunOptions options;
  if (memory != 0) options.memory = memory;
  std::vector<PortRef> ports;
  for (const std::string& address : wanted) {
    const auto port = port_of(*loaded.graph, address, loaded.problems);
    if (!port) throw std::runtime_error(to_text(loaded.problems));
    ports.push_back(*port);
  }
  options.demand.ports = ports;
  SessionRun out{session.run(*loaded.graph, options, false), {}};
  for (const PortRef& p : ports)
    if (const auto at = out.result.buffers.find(p); at != out.result.buffers.end())
      out.buffers.push_back(at->second);
  return out;
}

}  // namespace frustum::test
