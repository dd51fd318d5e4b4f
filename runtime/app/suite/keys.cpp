#include "runtime/app/suite/keys.h"

#include <nlohmann/json.hpp>

namespace frustum {

template <>
const ParamType& param_type<JsonText>() {
  static const ParamType type = [] {
    ParamType t{.kind = ParamType::Kind::record, .name = "any JSON"};
    t.read = [](const Json& j, void* value, const ParamOptions&, ParamReader&) {
      static_cast<JsonText*>(value)->text = j.dump();
    };
    t.write = [](const void* value) {
      const auto& text = static_cast<const JsonText*>(value)->text;
      return text.empty() ? Json() : Json::parse(text);
    };
    return t;
  }();
  return type;
}

namespace suite_keys {

const std::array<MetricKey, 9> metric_keys{{{"max", &Check::max},
                                            {"rmse", &Check::rmse},
                                            {"mrse", &Check::mrse},
                                            {"psnr", &Check::psnr},
                                            {"ssim", &Check::ssim},
                                            {"flip", &Check::flip},
                                            {"delta_e_2000", &Check::delta_e_2000},
                                            {"delta_e_2000_max", &Check::delta_e_2000_max},
                                            {"wrong_ids", &Check::wrong_ids}}};

void describe(Fields<Percentile>& f) {
  f.field("p", &Percentile::p, "Share of the values, 0 to 100.", {.unit = "%", .range = between(0, 100)})
      .field("at_most", &Percentile::at_most, "The difference that this share stays within.",
             {.range = at_least(0)});
}

void describe(Fields<Probe>& f) {
  f.field("pixel", &Probe::pixel, "Column and row of one pixel.", {.unit = "px"})
      .field("region", &Probe::region, "x, y, width and height: every pixel of it.", {.unit = "px"})
      .field("row", &Probe::row, "Row of a column: a vertex, a corner, a face, a line of a table.",
             {.range = at_least(0)})
      .field("sample", &Probe::sample, "Which sample of the pixel; every one if left out.",
             {.range = at_least(0)})
      .field("plane", &Probe::plane, "Which plane of the pixels; the first if left out.")
      .field("column", &Probe::column, "Which column of a mesh or a table; the first if left out.")
      .field("equals", &Probe::equals, "What it is: a number, or one for each number of a row.")
      .field("between", &Probe::between, "Or the interval in which every number lies, ends included.")
      .field("abs", &Probe::abs, "How far a number may be from `equals`.", {.range = at_least(0)})
      .field("rel", &Probe::rel, "The same as a share of `equals`.", {.range = at_least(0)})
      .field("ulp", &Probe::ulp, "The same in representable numbers.", {.range = at_least(0)});
}

void describe(Fields<Invariant>& f) {
  f.field("name", &Invariant::name, "The law, by name.")
      .field("of", &Invariant::of, "The other port, where the law is about two.")
      .field("tolerance", &Invariant::tolerance, "How far a number may miss it.", {.range = at_least(0)});
}

void describe(Fields<Analytic>& f) {
  f.field("value", &Analytic::value,
          "An expression over planes or columns, x, y, u and v: \"N.x^2 + N.y^2\".")
      .field("equals", &Analytic::equals, "What it is, an expression too.")
      .field("where", &Analytic::where, "Only where this is not zero: \"id < 4294967295\".")
      .field("abs", &Analytic::abs, "How far the value may be from it.", {.range = at_least(0)})
      .field("rel", &Analytic::rel, "The same as a share of what is expected.", {.range = at_least(0)})
      .field("ulp", &Analytic::ulp, "The same in representable doubles.", {.range = at_least(0)});
}

void describe(Fields<OtherRun>& f) {
  f.field("graph", &OtherRun::graph, "A graph file, relative to the suite; the case's own if left out.")
      .field("port", &OtherRun::port, "A port or an output of it; the check's own if left out.")
      .field("set", &OtherRun::set, "ADDRESS and value; on the case's own graph these come after the case's.")
      .field("precision", &OtherRun::precision, "The Real of its nodes.");
}

void describe(Fields<Metamorphic>& f) {
  f.field("set", &Metamorphic::set, "ADDRESS and value: how the input is changed.")
      .field("precision", &Metamorphic::precision, "The Real of the changed run.")
      .field("expect", &Metamorphic::expect, "What the output becomes.");
}

void describe(Fields<Relation>& f) {
  f.field("shift", &Relation::shift, "Moved right and down.", {.unit = "px"})
      .field("times", &Relation::times, "Every real number times this, but alpha.")
      .field("matrix", &Relation::matrix, "Positions transformed by it.");
  f.exactly_one();
}

void describe(Fields<Check>& f) {
  f.field("port", &Check::port, "NODE.PORT, or an output by name.")
      .field("golden", &Check::golden, "Compared with what was accepted.")
      .field("trace", &Check::trace,
             "Digests of all ports are accepted too, and the first that differs is named.")
      .field("same_as", &Check::same_as, "Compared with another port of the run, or of another run.")
      .field("metamorphic", &Check::metamorphic, "The input changed, the output changes as expected.")
      .field("exact", &Check::exact, "Bit for bit; the default without a tolerance.")
      .field("abs", &Check::abs, "How far each value may be away.", {.range = at_least(0)})
      .field("rel", &Check::rel, "The same as a share of the value expected.", {.range = at_least(0)})
      .field("ulp", &Check::ulp, "The same in representable numbers of the kind stored.",
             {.range = at_least(0)})
      .field("fraction", &Check::fraction, "Share of the values for which abs, rel or ulp has to hold.",
             {.range = between(0, 1)})
      .field("percentile", &Check::percentile, "A percentile of the differences.")
      .field("max", &Check::max, "Most that any value may be away.", {.range = at_least(0)})
      .field("rmse", &Check::rmse, "Most root mean square of the differences.", {.range = at_least(0)})
      .field("mrse", &Check::mrse, "Most mean relative squared error.", {.range = at_least(0)})
      .field("psnr", &Check::psnr, "Least peak signal-to-noise ratio, for a peak of 1.", {.unit = "dB"})
      .field("ssim", &Check::ssim, "Least mean structural similarity.", {.range = between(-1, 1)})
      .field("flip", &Check::flip, "Most mean FLIP error.", {.range = between(0, 1)})
      .field("delta_e_2000", &Check::delta_e_2000, "Most mean CIEDE2000 difference.", {.range = at_least(0)})
      .field("delta_e_2000_max", &Check::delta_e_2000_max, "Most CIEDE2000 difference of any pixel.",
             {.range = at_least(0)})
      .field("wrong_ids", &Check::wrong_ids, "Most ids that may differ.", {.range = at_least(0)})
      .field("shape", &Check::shape, "Entries of the port's summary, and what they are.")
      .field("probe", &Check::probe, "Numbers at one place.")
      .field("statistics", &Check::statistics, "Intervals for statistics.")
      .field("invariant", &Check::invariant, "A law that the buffer obeys.")
      .field("analytic", &Check::analytic, "A closed form that its numbers follow.")
      .field("why", &Check::why, "The reason for a tolerance above zero.");
}

void describe(Fields<Expect>& f) {
  f.field("code", &Expect::code, "Of a diagnostic that loading or running has to give.")
      .field("pointer", &Expect::pointer, "Where it points.")
      .field("line", &Expect::line, "Its line.", {.range = at_least(1)})
      .field("column", &Expect::column, "Its column.", {.range = at_least(1)})
      .field("suggestion", &Expect::suggestion, "One of its suggestions.");
}

void describe(Fields<Budget>& f) {
  f.field("bytes", &Budget::bytes, "Most bytes of buffers that are live at once: 268435456 or \"256M\".")
      .field("counters", &Budget::counters, "Most work: \"triangles_clipped\", or \"cut:triangles_clipped\".")
      .field("time", &Budget::time, "Seconds that it should take; more is said and fails nothing.",
             {.unit = "s", .range = above(0)});
}

void describe(Fields<Waiver>& f) {
  f.field("until", &Waiver::until, "The last day on which a failure does not count, YYYY-MM-DD.")
      .field("why", &Waiver::why, "Why it fails.");
}

void describe(Fields<Case>& f) {
  f.field("id", &Case::id, "Unique in the suite.")
      .field("graph", &Case::graph, "Relative to the suite; * makes one case of every file that matches.")
      .field("use", &Case::use, "Presets; later ones stand above earlier ones, the case above all.")
      .field("set", &Case::set, "ADDRESS and value, as for --set.")
      .field("matrix", &Case::matrix, "ADDRESS and a list of values; one case for every combination.")
      .field("precision", &Case::precision, "The Real in which nodes compute, above the graph's own.")
      .field("checks", &Case::checks, "What has to hold of ports.")
      .field("expect", &Case::expect, "Diagnostics that it has to give; others fail.")
      .field("budget", &Case::budget, "What it may cost.")
      .field("tags", &Case::tags, "For --filter.")
      .field("timeout", &Case::timeout, "Seconds after which it is ended.", {.unit = "s", .range = above(0)})
      .field("retry", &Case::retry, "Further attempts where it does not pass; then it is flaky.",
             {.range = between(0, 10)})
      .field("skip", &Case::skip, "Why it is not run.")
      .field("waiver", &Case::waiver, "Why a failure does not count until a date.");
}

void describe(Fields<Preset>& f) {
  f.field("set", &Preset::set, "ADDRESS and value.").field("matrix", &Preset::matrix, "ADDRESS and values.");
}

}  // namespace suite_keys
}  // namespace frustum
