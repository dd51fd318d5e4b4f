#include "runtime/app/stability/report.h"

#include "runtime/core/text.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cctype>
#include <chrono>
#include <cmath>

namespace frustum::stability {
namespace {

std::string lower(std::string_view text) {
  std::string out(text);
  for (char& c : out) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return out;
}

bool chosen(const CatalogueRow& row, const Options& options) {
  if (options.gate_only && !row.gate) return false;
  if (options.filters.empty()) return true;
  const std::string text = lower(fmt::format("{} {} {}", row.id, row.stage, row.title));
  return std::any_of(options.filters.begin(), options.filters.end(),
                     [&](const std::string& f) { return text.find(lower(f)) != std::string::npos; });
}

void judge(const HardCase& hard, Trial& trial, Outcome& out) {
  const auto need = [&](bool holds, std::string what) {
    if (!holds) out.why += (out.why.empty() ? "" : "; ") + std::move(what);
  };
  need(trial.robust.samples > 0, "nothing was measured");
  need(trial.robust.worst <= hard.bound,
       fmt::format("error {} above {} {} at {}", error_text(trial.robust.worst), error_text(hard.bound),
                   hard.unit, witness_text(trial.robust.witness)));
  for (const auto& [what, input] : trial.broken)
    need(false, input.empty() ? what : fmt::format("{} at {}", what, witness_text(input)));
  const bool naive_fails = trial.naive.worst > hard.bound;
  out.state = !out.why.empty() ? State::broken : naive_fails ? State::holds : State::naive_survives;
  if (out.state == State::naive_survives) out.why = "the naive method keeps the bound too";
}

}  // namespace

std::string_view name_of(State s) {
  switch (s) {
    case State::holds: return "holds";
    case State::broken: return "BROKEN";
    case State::naive_survives: return "NAIVE SURVIVES";
    case State::argued: return "argued";
    case State::not_built: return "not built";
  }
  return "";
}

Outcome run_case(const HardCases& all, const CatalogueRow& row, const Options& options) {
  Outcome out{.row = &row, .why = std::string(row.needs)};
  for (const ArguedCase& a : all.argued)
    if (a.id == row.id) out.state = State::argued, out.why = a.why;
  const auto hard =
      std::find_if(all.cases.begin(), all.cases.end(), [&](const auto& c) { return c.id == row.id; });
  if (hard == all.cases.end()) return out;
  out.hard_case = &*hard;
  Trial trial(row.id, options.full, options.timed);
  const auto start = std::chrono::steady_clock::now();
  hard->run(trial);
  out.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  if (out.state != State::argued) judge(*hard, trial, out);
  out.naive = trial.naive, out.robust = trial.robust, out.paid = trial.paid;
  return out;
}

std::vector<Outcome> run_cases(const HardCases& all, const Options& options,
                               const std::function<void(const Outcome&)>& done) {
  std::vector<Outcome> outcomes;
  for (const CatalogueRow& row : all.catalogue) {
    if (!chosen(row, options)) continue;
    if (options.cancel != nullptr && options.cancel->cancelled()) throw Cancelled();
    outcomes.push_back(run_case(all, row, options));
    if (done) done(outcomes.back());
  }
  return outcomes;
}

double median_price(const std::vector<Outcome>& outcomes) {
  std::vector<double> ratios;
  for (const Outcome& o : outcomes)
    if (o.paid) ratios.push_back(o.paid->ratio);
  if (ratios.empty()) return 0;
  std::sort(ratios.begin(), ratios.end());
  return ratios[ratios.size() / 2];
}

std::string error_text(double error) {
  if (std::isinf(error)) return "inf";
  if (error == std::floor(error) && error < 1e6) return fmt::format("{:.0f}", error);
  return fmt::format("{:.2g}", error);
}

std::string witness_text(const Witness& witness) {
  std::string out;
  for (const double x : witness) out += fmt::format("{}{:a}", out.empty() ? "" : " ", x);
  return "(" + out + ")";
}

std::string to_text(const std::vector<Outcome>& outcomes) {
  std::vector<std::vector<std::string>> rows{
      {"case", "state", "naive", "robust", "bound", "unit", "price", "title"}};
  for (const Outcome& o : outcomes) {
    const bool ran = o.hard_case != nullptr;
    rows.push_back(
        {std::string(o.row->id), std::string(name_of(o.state)), ran ? error_text(o.naive.worst) : "",
         ran ? error_text(o.robust.worst) : "", ran ? error_text(o.hard_case->bound) : "",
         ran ? std::string(o.hard_case->unit) : "", o.paid ? fmt::format("{:.2f}x", o.paid->ratio) : "",
         std::string(o.row->title) + (o.why.empty() || o.state == State::holds ? "" : ": " + o.why)});
  }
  const auto count = [&](State s) {
    return std::count_if(outcomes.begin(), outcomes.end(), [&](const Outcome& o) { return o.state == s; });
  };
  double seconds = 0;
  for (const Outcome& o : outcomes) seconds += o.seconds;
  std::string out =
      aligned(rows) + fmt::format("\n{} hold, {} argued, {} not built, {} do not hold; ", count(State::holds),
                                  count(State::argued), count(State::not_built),
                                  count(State::broken) + count(State::naive_survives));
  if (const double price = median_price(outcomes); price > 0)
    out += fmt::format("median price {:.2f}x; ", price);
  return out + fmt::format("{:.1f} s\n", seconds);
}

Json to_json(const std::vector<Outcome>& outcomes) {
  const auto number = [](double x) { return std::isfinite(x) ? Json(x) : Json("inf"); };
  Json cases = Json::array();
  for (const Outcome& o : outcomes) {
    Json c{{"id", o.row->id}, {"stage", o.row->stage}, {"title", o.row->title}, {"state", name_of(o.state)}};
    if (!o.why.empty()) c["why"] = o.why;
    if (const HardCase* h = o.hard_case) {
      c.update({{"input", h->input},
                {"oracle", h->oracle},
                {"criterion", h->criterion},
                {"unit", h->unit},
                {"bound", number(h->bound)}});
      const auto method = [&](std::string_view what, const Errors& e) {
        return Json{{"method", what},
                    {"error", number(e.worst)},
                    {"witness", witness_text(e.witness)},
                    {"samples", e.samples}};
      };
      c["naive"] = method(h->naive, o.naive);
      c["robust"] = method(h->robust, o.robust);
      c["seconds"] = o.seconds;
    }
    if (o.paid)
      c["price"] = {
          {"ratio", o.paid->ratio}, {"naive_ns", o.paid->naive_ns}, {"robust_ns", o.paid->robust_ns}};
    cases.push_back(std::move(c));
  }
  return {{"cases", cases}, {"median_price", median_price(outcomes)}};
}

}  // namespace frustum::stability
