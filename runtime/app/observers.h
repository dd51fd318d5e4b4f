// Listeners to a run: the event stream, the trace file, and several at once.
#pragma once

#include "runtime/core/diagnostic.h"
#include "runtime/graph/events.h"

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <vector>

namespace frustum {

// Passes everything on to each of `all`, in order.
class Observers : public Observer {
 public:
  void add(Observer& observer) { all_.push_back(&observer); }
  void planned(std::size_t items) override;
  void started(std::string_view node) override;
  void progress(std::string_view node, double fraction) override;
  void done(const WorkDone& work) override;
  void pixel_times(const std::vector<PixelNodeTime>& times) override;
  void cached(const NodeCaching& caching) override;
  void warned(std::string_view node, std::string_view code, std::string_view message) override;

 private:
  std::vector<Observer*> all_;
};

// One JSON object an event, each with "event", "run" and "ms" since the run began:
//   {"event": "planned", "items": 12}
//   {"event": "started", "node": "cut"}
//   {"event": "progress", "node": "hits", "fraction": 0.25}
//   {"event": "done", "kind": "node", "nodes": ["cut"], "start_ms", "time_ms", "bytes", "cache", "thread",
//   "counters"}
//   {"event": "pixel_times", "nodes": [{"node", "time_ms", "pixels"}]}
//   {"event": "warned", "node": "mesh", "code", "message"}
//   {"event": "cached", "node": "mesh", "verdict": "miss", "why": "params_changed", ...}   as to_json(NodeCaching)
// `write` gets them one line at a time, without the line's end.
class EventStream : public Observer {
 public:
  EventStream(std::string run, std::function<void(const std::string& line)> write);
  void planned(std::size_t items) override;
  void started(std::string_view node) override;
  void progress(std::string_view node, double fraction) override;
  void done(const WorkDone& work) override;
  void pixel_times(const std::vector<PixelNodeTime>& times) override;
  void cached(const NodeCaching& caching) override;
  void warned(std::string_view node, std::string_view code, std::string_view message) override;

 private:
  void emit(const char* event, Json more);
  std::string run_;
  std::function<void(const std::string&)> write_;
  std::chrono::steady_clock::time_point began_;
};

// The run as a timeline in the Chrome trace format (chrome://tracing, ui.perfetto.dev): one bar per piece
// of work with bytes, cache verdict and counters as its arguments, and for each pass one counter per fused
// node with its milliseconds.
class Trace : public Observer {
 public:
  Trace();
  ~Trace() override;
  void done(const WorkDone& work) override;
  void pixel_times(const std::vector<PixelNodeTime>& times) override;
  void warned(std::string_view node, std::string_view code, std::string_view message) override;
  std::string text() const;

 private:
  struct Events;
  std::unique_ptr<Events> events_;
  std::chrono::steady_clock::time_point began_;
};

// Times of the steps of repeated runs, by what was done: "hits" or "prepare lit" or "pixels
// lit+pixels+display".
class StepTimes : public Observer {
 public:
  void done(const WorkDone& work) override;
  void pixel_times(const std::vector<PixelNodeTime>& times) override;
  struct Row {
    std::string what;
    std::vector<std::chrono::nanoseconds> times;  // one a run
  };
  // In order of first appearance; the share of each fused node stands after the passes, as "  lit (all
  // threads)".
  const std::vector<Row>& rows() const { return rows_; }

 private:
  void add(const std::string& what, std::chrono::nanoseconds time);
  std::vector<Row> rows_;
  std::map<std::string, std::size_t> index_;
};

// {"node", "verdict", "from", "why", "detail", "kept", "bytes"}; texts that are empty are left out.
Json to_json(const NodeCaching&);

std::chrono::nanoseconds median(std::vector<std::chrono::nanoseconds> times);  // of at least one

}  // namespace frustum
