// `frustum report`: one run of a graph as one HTML page that needs nothing else.
#pragma once

#include "runtime/app/session.h"

#include <cstdint>
#include <string>
#include <vector>

namespace frustum {

struct ReportOptions {
  std::vector<std::string> wanted;        // as --want; empty: every output, and every end port
  bool all = false;                       // every port of every node that runs besides
  std::vector<std::string> settings;      // ADDR=VALUE as given, shown among the parameters
  std::uint64_t most_values = 4'000'000;  // numbers of one picture in the page; larger ones are thinned
  RunOptions run = {};
};

// The run, and the page of it. `page` is empty where the run did not end well; `result` tells why.
struct Report {
  RunResult result;
  Diagnostics problems;
  std::vector<std::string> ports;  // shown, in the page's order
  std::string page;
};

// Runs what is asked for (no file is written) and makes the page. Every text of the graph is data in it and
// none is markup; it loads nothing from anywhere. The page's size is bounded by the number of ports times
// `most_values`.
Report make_report(Session& session, const Graph& graph, const ReportOptions& options);

}  // namespace frustum
