#include "runtime/app/suite/run.h"

#include "runtime/app/suite/isolate.h"
#include "runtime/io/image_files.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <deque>
#include <filesystem>
#include <iterator>
#include <map>
#include <stdexcept>
#include <thread>

namespace frustum {
namespace {

std::string shell_word(const std::string& word) {
  std::string out = "'";
  for (const char c : word) out += c == '\'' ? "'\\''" : std::string(1, c);
  return out + "'";
}

int processors() { return std::max(1, static_cast<int>(std::thread::hardware_concurrency())); }

// What is no UTF-8 in it is replaced, so that it can stand in any report.
std::string readable(const std::string& text) {
  return Json::parse(Json(text).dump(-1, ' ', false, Json::error_handler_t::replace)).get<std::string>();
}

// A case on its way: its attempts so far.
struct Item {
  const Suite* suite;
  const SuiteCase* suite_case;
  const GoldenBook* book;
  CaseResult result;                 // of the last attempt
  std::vector<std::string> earlier;  // failures of the attempts before
};

class SuiteRun {
 public:
  SuiteRun(Session& session, const std::vector<Suite>& suites, const SuiteOptions& options,
           const std::function<void(const CaseResult&)>& each)
      : session_(session),
        options_(options),
        each_(each),
        jobs_(options.jobs > 0 ? options.jobs : processors()),
        today_(options.today.empty() ? today_utc() : options.today) {
    for (const Suite& suite : suites) {
      const auto [book, fresh] = books_.try_emplace(suite.file, golden_folder(suite), golden_book(suite));
      for (const SuiteCase& c : suite.cases)
        if (chosen(c, options.filters) && in_shard(options.shard, suite.name, c.id))
          items_.push_back({&suite, &c, &book->second, {}, {}});
    }
  }

  std::vector<CaseResult> run() {
    if (options_.isolate)
      run_isolated();
    else
      for (std::size_t i = 0; i < items_.size(); ++i) run_here(i);
    std::vector<CaseResult> results;
    for (Item& item : items_) results.push_back(std::move(item.result));
    return results;
  }

 private:
  CaseResult named(const Item& item) const {
    CaseResult r;
    r.suite = item.suite->name, r.suite_file = item.suite->file;
    r.id = item.suite_case->id, r.tags = item.suite_case->tags;
    r.rerun = fmt::format("frustum test {} --filter {}", item.suite->file, shell_word(r.id));
    r.accept = r.rerun + " --accept --reason '...'";
    r.attempts = static_cast<int>(item.result.attempts);
    return r;
  }

  CaseResult judged(std::size_t i) {
    const Item& item = items_[i];
    CaseResult r = named(item);
    JudgeOptions options{.goldens = options_.goldens,
                         .staging = options_.staging,
                         .evidence = options_.evidence,
                         .evidence_name = fmt::format("{:05}_{}", i, item.result.attempts),
                         .evidence_of_all = options_.evidence_of_all,
                         .threads = options_.threads,
                         .cancel = options_.cancel};
    if (options.threads == 0) options.threads = options_.isolate ? std::max(1, processors() / jobs_) : 0;
    judge_case(session_, *item.suite_case, *item.book, options, r);
    r.images_read = image_module_is_open();
    return r;
  }

  bool skipped(std::size_t i) {
    Item& item = items_[i];
    if (item.suite_case->skip.empty()) return false;
    item.result = named(item);
    item.result.verdict = CaseVerdict::skip;
    item.result.notes.push_back("skipped: " + item.suite_case->skip);
    each_(item.result);
    return true;
  }

  // ----- one after the other

  void run_here(std::size_t i) {
    if (skipped(i)) return;
    do {
      if (options_.cancel != nullptr && options_.cancel->cancelled()) throw Cancelled();
      items_[i].result = judged(i);
    } while (again(i));
    finish(i);
  }

  // ----- in processes

  void run_isolated() {
    namespace fs = std::filesystem;
    const auto threads = std::distance(fs::directory_iterator("/proc/self/task"), fs::directory_iterator());
    if (threads > 1 && !image_module_is_open())
      throw std::logic_error("cases cannot be isolated from a process that has started threads");
    IsolatedProcesses processes(static_cast<std::size_t>(jobs_));
    std::deque<std::size_t> waiting;
    for (std::size_t i = 0; i < items_.size(); ++i)
      if (!skipped(i)) waiting.push_back(i);
    while (!waiting.empty() || !processes.empty()) {
      while (!waiting.empty() && !processes.full()) {
        if (options_.cancel != nullptr && options_.cancel->cancelled()) throw Cancelled();
        start(processes, waiting.front());
        waiting.pop_front();
      }
      for (const IsolatedEnd& end : processes.wait(options_.cancel)) {
        take(end);
        if (again(end.tag))
          waiting.push_front(end.tag);
        else
          finish(end.tag);
        open_images_once(items_[end.tag].result, waiting.size());
      }
    }
  }

  double timeout_of(const Item& item) const { return item.suite_case->timeout.value_or(options_.timeout); }

  void start(IsolatedProcesses& processes, std::size_t i) {
    constexpr double longest = 1e9;  // 30 years: nanoseconds of them fit into 64 bits, and added to now too
    const std::chrono::duration<double> timeout(std::min(timeout_of(items_[i]), longest));
    processes.start(i, std::chrono::duration_cast<std::chrono::nanoseconds>(timeout), [this, i] {
      return case_to_json(judged(i)).dump(-1, ' ', false, Json::error_handler_t::replace);
    });
  }

  void take(const IsolatedEnd& end) {
    Item& item = items_[end.tag];
    if (end.kind == IsolatedEnd::Kind::done) {
      item.result = case_from_json(Json::parse(end.result));
    } else {
      CaseResult r = named(item);
      r.verdict = end.kind == IsolatedEnd::Kind::timeout ? CaseVerdict::timeout : CaseVerdict::crash;
      r.failures.push_back(end.kind == IsolatedEnd::Kind::timeout
                               ? fmt::format("it did not end within {:g} s", timeout_of(item))
                               : fmt::format("its process ended by {}", end.how));
      item.result = std::move(r);
    }
    item.result.time = end.time;
    if (item.result.verdict != CaseVerdict::pass) item.result.said = readable(end.said);
  }

  // Opening the image module takes as long as many small cases. Once a case needed it, it is opened here, so
  // that every later process is born with it. What it starts are idle threads of a logging library that
  // nobody waits for.
  void open_images_once(const CaseResult& r, std::size_t left) {
    constexpr std::size_t worth_it = 4;
    if (r.images_read && left >= worth_it && !image_module_is_open()) open_image_module();
  }

  // ----- what follows from a result

  bool again(std::size_t i) {
    Item& item = items_[i];
    CaseResult& r = item.result;
    if (!counts_against(r.verdict) || r.attempts > std::max(item.suite_case->retry, options_.retry))
      return false;
    for (const std::string& f : r.failures)
      item.earlier.push_back(fmt::format("attempt {}, {}: {}", r.attempts, name_of(r.verdict), f));
    ++r.attempts;
    return true;
  }

  void finish(std::size_t i) {
    Item& item = items_[i];
    CaseResult& r = item.result;
    r.notes.insert(r.notes.end(), item.earlier.begin(), item.earlier.end());
    if (r.verdict == CaseVerdict::pass && r.attempts > 1) r.verdict = CaseVerdict::flaky;
    if (const auto& waiver = item.suite_case->waiver) apply(*waiver, r);
    each_(r);
  }

  void apply(const Waiver& waiver, CaseResult& r) const {
    const std::string what = fmt::format("the waiver until {} ({})", waiver.until, waiver.why);
    if (today_ > waiver.until) {
      r.failures.push_back(what + " has expired");
      if (!counts_against(r.verdict)) r.verdict = CaseVerdict::fail;
    } else if (counts_against(r.verdict)) {
      r.notes.push_back(fmt::format("{}, counted as waived: {}", name_of(r.verdict), what));
      r.verdict = CaseVerdict::waived;
    } else {
      r.notes.push_back(what + " is not needed: it passes");
    }
  }

  Session& session_;
  const SuiteOptions& options_;
  const std::function<void(const CaseResult&)>& each_;
  const int jobs_;
  const std::string today_;
  std::map<std::string, GoldenBook> books_;
  std::vector<Item> items_;
};

}  // namespace

std::string golden_book(const Suite& suite) {
  const std::string folder = std::filesystem::absolute(suite.file).parent_path().filename().string();
  return folder == "suites" ? suite.name : folder + "." + suite.name;
}

std::string today_utc() {
  const auto day = std::chrono::floor<std::chrono::days>(std::chrono::system_clock::now());
  const std::chrono::year_month_day d(day);
  return fmt::format("{:04}-{:02}-{:02}", static_cast<int>(d.year()), static_cast<unsigned>(d.month()),
                     static_cast<unsigned>(d.day()));
}

std::string golden_folder(const Suite& suite) {
  return (std::filesystem::path(suite.file).parent_path() / ".." / "golden").lexically_normal().string();
}

std::vector<CaseResult> run_suites(Session& session, const std::vector<Suite>& suites,
                                   const SuiteOptions& options,
                                   const std::function<void(const CaseResult&)>& each) {
  return SuiteRun(session, suites, options, each).run();
}

void record_goldens(const std::vector<Suite>& suites, const std::vector<CaseResult>& results,
                    const std::string& reason) {
  for (const Suite& suite : suites) {
    GoldenBook book(golden_folder(suite), golden_book(suite));
    for (const CaseResult& r : results)
      if (r.suite_file == suite.file)
        for (const Candidate& c : r.accepted) book.accept(c.key, c.digest, reason, c.staged);
    book.save();
  }
}

}  // namespace frustum
