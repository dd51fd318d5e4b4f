#include "runtime/app/observers.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include <algorithm>

namespace frustum {
namespace {

using std::chrono::nanoseconds;
using std::chrono::steady_clock;

double ms(nanoseconds t) { return std::chrono::duration<double, std::milli>(t).count(); }
double us(nanoseconds t) { return std::chrono::duration<double, std::micro>(t).count(); }

std::string_view name_of(WorkDone::Kind kind) {
  switch (kind) {
    case WorkDone::Kind::node: return "node";
    case WorkDone::Kind::prepare: return "prepare";
    case WorkDone::Kind::pixels: return "pixels";
  }
  return "";
}

// Counters of one name that a node raised several times are summed.
Json counters_of(const WorkDone& work) {
  std::map<std::string, std::uint64_t> sums;
  for (const auto& [name, n] : work.counters) sums[name] += n;
  Json out = Json::object();
  for (const auto& [name, n] : sums) out[name] = n;
  return out;
}

std::string line_of(const Json& j) { return j.dump(-1, ' ', false, Json::error_handler_t::replace); }

}  // namespace

void Observers::planned(std::size_t items) {
  for (Observer* o : all_) o->planned(items);
}
void Observers::started(std::string_view node) {
  for (Observer* o : all_) o->started(node);
}
void Observers::progress(std::string_view node, double fraction) {
  for (Observer* o : all_) o->progress(node, fraction);
}
void Observers::done(const WorkDone& work) {
  for (Observer* o : all_) o->done(work);
}
void Observers::pixel_times(const std::vector<PixelNodeTime>& times) {
  for (Observer* o : all_) o->pixel_times(times);
}
void Observers::cached(const NodeCaching& caching) {
  for (Observer* o : all_) o->cached(caching);
}
void Observers::warned(std::string_view node, std::string_view code, std::string_view message) {
  for (Observer* o : all_) o->warned(node, code, message);
}

EventStream::EventStream(std::string run, std::function<void(const std::string&)> write)
    : run_(std::move(run)), write_(std::move(write)), began_(steady_clock::now()) {}

void EventStream::emit(const char* event, Json more) {
  Json line = {{"event", event}, {"run", run_}, {"ms", ms(steady_clock::now() - began_)}};
  line.update(more);
  write_(line_of(line));
}

void EventStream::planned(std::size_t items) { emit("planned", {{"items", items}}); }
void EventStream::started(std::string_view node) { emit("started", {{"node", node}}); }
void EventStream::progress(std::string_view node, double fraction) {
  emit("progress", {{"node", node}, {"fraction", fraction}});
}

void EventStream::done(const WorkDone& work) {
  emit("done", {{"kind", name_of(work.kind)},
                {"nodes", work.nodes},
                {"start_ms", ms(work.start)},
                {"time_ms", ms(work.time)},
                {"bytes", work.bytes},
                {"cache", frustum::name_of(work.cache)},
                {"thread", work.thread},
                {"counters", counters_of(work)}});
}

void EventStream::pixel_times(const std::vector<PixelNodeTime>& times) {
  Json nodes = Json::array();
  for (const PixelNodeTime& t : times)
    nodes.push_back({{"node", t.node}, {"time_ms", ms(t.time)}, {"pixels", t.pixels}});
  emit("pixel_times", {{"nodes", nodes}});
}

void EventStream::cached(const NodeCaching& caching) { emit("cached", to_json(caching)); }

void EventStream::warned(std::string_view node, std::string_view code, std::string_view message) {
  emit("warned", {{"node", node}, {"code", code}, {"message", message}});
}

Json to_json(const NodeCaching& c) {
  Json j = {{"node", c.node}, {"verdict", frustum::name_of(c.verdict)}};
  for (const auto& [name, text] :
       {std::pair{"from", &c.from}, {"why", &c.why}, {"detail", &c.detail}, {"kept", &c.kept}})
    if (!text->empty()) j[name] = *text;
  if (c.bytes != 0) j["bytes"] = c.bytes;
  return j;
}

struct Trace::Events {
  Json list = Json::array();
};

Trace::Trace() : events_(std::make_unique<Events>()), began_(steady_clock::now()) {}
Trace::~Trace() = default;

void Trace::done(const WorkDone& work) {
  Json args = {{"bytes", work.bytes}, {"cache", frustum::name_of(work.cache)}};
  args.update(counters_of(work));
  events_->list.push_back({{"name", fmt::format("{}", fmt::join(work.nodes, "+"))},
                           {"cat", name_of(work.kind)},
                           {"ph", "X"},
                           {"ts", us(work.start)},
                           {"dur", us(work.time)},
                           {"pid", 1},
                           {"tid", work.thread},
                           {"args", args}});
}

void Trace::pixel_times(const std::vector<PixelNodeTime>& times) {
  const double now = us(steady_clock::now() - began_);
  for (const PixelNodeTime& t : times)
    events_->list.push_back({{"name", "pixels of " + t.node},
                             {"ph", "C"},
                             {"ts", now},
                             {"pid", 1},
                             {"args", {{"ms on all threads", ms(t.time)}, {"pixels", t.pixels}}}});
}

void Trace::warned(std::string_view node, std::string_view code, std::string_view message) {
  events_->list.push_back({{"name", fmt::format("{}: {}", node, code)},
                           {"ph", "i"},
                           {"s", "g"},
                           {"ts", us(steady_clock::now() - began_)},
                           {"pid", 1},
                           {"tid", 0},
                           {"args", {{"message", message}}}});
}

std::string Trace::text() const {
  std::string out = "{\"displayTimeUnit\": \"ms\", \"traceEvents\": [\n";
  for (std::size_t i = 0; i < events_->list.size(); ++i)
    out += line_of(events_->list[i]) + (i + 1 < events_->list.size() ? ",\n" : "\n");
  return out + "]}\n";
}

void StepTimes::add(const std::string& what, nanoseconds time) {
  const auto [found, added] = index_.try_emplace(what, rows_.size());
  if (added) rows_.push_back({what, {}});
  rows_[found->second].times.push_back(time);
}

void StepTimes::done(const WorkDone& work) {
  const std::string nodes = fmt::format("{}", fmt::join(work.nodes, "+"));
  add(work.kind == WorkDone::Kind::node ? nodes : fmt::format("{} {}", name_of(work.kind), nodes), work.time);
}

void StepTimes::pixel_times(const std::vector<PixelNodeTime>& times) {
  for (const PixelNodeTime& t : times) add(fmt::format("  {} (all threads)", t.node), t.time);
}

nanoseconds median(std::vector<nanoseconds> times) {
  std::sort(times.begin(), times.end());
  const std::size_t n = times.size();
  return n % 2 == 1 ? times[n / 2] : (times[n / 2 - 1] + times[n / 2]) / 2;
}

}  // namespace frustum
