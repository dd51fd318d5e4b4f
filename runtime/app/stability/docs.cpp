#include "runtime/app/stability/docs.h"

#include "runtime/app/files.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>

namespace frustum::stability {
namespace {

// Cells hold formulas with vertical bars.
std::string cell(std::string_view text) {
  std::string out;
  for (const char c : text) out += c == '|' ? "\\|" : std::string(1, c);
  return out;
}

std::size_t count(const std::vector<Outcome>& outcomes, State state) {
  return static_cast<std::size_t>(
      std::count_if(outcomes.begin(), outcomes.end(), [&](const Outcome& o) { return o.state == state; }));
}

constexpr const char* introduction = R"(# Hard cases stay numerically stable

<!-- Written by `frustum stability --docs docs`; do not edit. -->

Computer graphics is arithmetic on numbers that are almost never exact. Textbook formulas are right on
paper and break on the machine: a vector of length 1e20 has no direction, two triangles that share an edge
leave a hole between them, values of 10 000 with a spread of 0.1 get a variance above 100 000, and one
NaN eats a picture. Such failures are rare enough to survive testing and common enough to be seen.

This page is a catalogue of {total} of them, from the first lesson to the last. Each case that is built is
a program that does four things:

1. it feeds the **textbook method** an input on which it fails, and checks that it does fail;
2. it feeds the same input to **the code of this repository**: the kernel or node that draws your
   pictures, not a copy;
3. it compares both with an **exact answer** that shares no code with either: integers of 128 bits,
   rationals (GMP), or reals of any precision (MPFR) whose digits are doubled until two results agree;
4. it holds ours to a **bound that was fixed before** anything was measured.

So every row below is a claim with a proof that runs: `frustum stability` runs it here and now,
and `./dev test` runs each case as a test, `Hard.FND_01` and so on. Where ours did not hold, ours was changed.

)";

constexpr const char* reading = R"(## How to read the tables

**Error** is the worst over all inputs of a case, in the unit of its bound; *inf* means an infinity, a
NaN, or nothing at all. An **ulp** is the distance between a number and the next one its type can hold;
**u** is half an ulp of 1 (2^-24 in float, 2^-53 in double), which is what one rounding may cost.
**Price** is the time of our method over that of the textbook's for the same work, measured in turns in
one run: 1 is free, below 1 is faster. Setting up a transform counts together with a thousand points that
it moves; predicates are timed on inputs where their filter decides, as nearly all do. Where there is no
price, the two do not do comparable work. Prices are those of the machine that wrote this page.

```
frustum stability                        every case, its two errors, bound and price
frustum stability --filter clipping      some of them
frustum stability --full                 up to a hundred times as many inputs
frustum stability --json                 with methods, oracles and worst inputs as hexadecimal floats
```

A case is one value in `tests/hard/<stage>.cpp`: texts for this page and a function that measures. Adding
one edits no other file than the catalogue's row.

)";

std::string stage_table(const std::vector<const Outcome*>& rows) {
  std::string out =
      "| case | | textbook | its error | ours | error | bound | price "
      "|\n|---|---|---|---:|---|---:|---:|---:|\n";
  for (const Outcome* o : rows)
    out +=
        fmt::format("| {} | **{}**: {} | {} | {} | {} | {} | {} {} | {} |\n", o->row->id, cell(o->row->title),
                    cell(o->hard_case->input), cell(o->hard_case->naive), error_text(o->naive.worst),
                    cell(o->hard_case->robust), error_text(o->robust.worst), error_text(o->hard_case->bound),
                    cell(o->hard_case->unit), o->paid ? fmt::format("{:.2f}", o->paid->ratio) : "");
  return out;
}

std::string tables(const std::vector<Outcome>& outcomes) {
  std::vector<std::pair<std::string_view, std::vector<const Outcome*>>> stages;
  for (const Outcome& o : outcomes) {
    if (o.state == State::argued || o.state == State::not_built) continue;
    if (stages.empty() || stages.back().first != o.row->stage) stages.emplace_back(o.row->stage, 0);
    stages.back().second.push_back(&o);
  }
  std::string out;
  for (const auto& [stage, rows] : stages) out += fmt::format("## {}\n\n{}\n", stage, stage_table(rows));
  return out;
}

std::string argued_list(const std::vector<Outcome>& outcomes) {
  std::string out =
      "## Argued\n\nThese cannot hold as the criterion was fixed; each is argued in "
      "[decision 3](decisions/0003-hard-cases.md).\n\n| case | | why |\n|---|---|---|\n";
  for (const Outcome& o : outcomes)
    if (o.state == State::argued)
      out += fmt::format("| {} | {} | {} |\n", o.row->id, cell(o.row->title), cell(o.why));
  return out + "\n";
}

std::string waiting_list(const std::vector<Outcome>& outcomes) {
  std::string out =
      "## Not built yet\n\nThese wait for a stage of the pipeline.\n\n| case | | waits for "
      "|\n|---|---|---|\n";
  for (const Outcome& o : outcomes)
    if (o.state == State::not_built)
      out += fmt::format("| {} | {} | {} |\n", o.row->id, cell(o.row->title), cell(o.why));
  return out;
}

}  // namespace

std::string stability_page(const HardCases& all, const std::vector<Outcome>& outcomes) {
  std::string out = introduction;
  const std::string total = "{total}";
  out.replace(out.find(total), total.size(), std::to_string(outcomes.size()));
  out += fmt::format("Today **{} hold**, {} are argued, {} wait for stages that are not built.",
                     count(outcomes, State::holds), count(outcomes, State::argued),
                     count(outcomes, State::not_built));
  if (const auto broken = count(outcomes, State::broken) + count(outcomes, State::naive_survives); broken > 0)
    out += fmt::format(" **{} do not hold.**", broken);
  if (const double price = median_price(outcomes); price > 0)
    out += fmt::format(" The median price of robustness is {:.2f} times the textbook's time.", price);
  out += "\n\n";
  for (const Illustration& p : all.pictures)
    out += fmt::format("![{0}](images/{1})\n\n*{0}*\n\n", p.caption, p.file);
  return out + reading + tables(outcomes) + argued_list(outcomes) + waiting_list(outcomes);
}

void write_docs(const HardCases& all, const std::vector<Outcome>& outcomes, const std::string& folder) {
  for (const Illustration& p : all.pictures) p.draw(fmt::format("{}/images/{}", folder, p.file));
  write_if_changed(folder + "/stability.md", stability_page(all, outcomes));
}

}  // namespace frustum::stability
