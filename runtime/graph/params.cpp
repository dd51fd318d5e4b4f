// Values of parameters: where they come from, what "$" stands for, and how problems in them find their place.
#include "runtime/core/missing_file.h"
#include "runtime/graph/flatten.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>

namespace frustum {
namespace {

// The value of --set ADDR=VALUE: JSON, or the text itself where it is none. Empty where it is JSON with a bad number or
// too many brackets, which is reported.
std::optional<Json> setting_value(const Setting& setting, const Document& top, Diagnostics& problems) {
  Diagnostics found;
  const auto text = SourceText::read(setting.value, "", found);
  if (found.empty()) return text->json();
  const auto is_text = [](const Diagnostic& d) { return d.code == "not_json"; };
  if (std::any_of(found.list().begin(), found.list().end(), is_text)) return Json(setting.value);
  for (const Diagnostic& d : found.list())
    report(problems, *top.text,
           {.code = d.code,
            .pointer = "",
            .message = fmt::format("--set {}: {}", setting.address, d.message),
            .expected = d.expected,
            .got = d.got});
  return std::nullopt;
}

// Who gave the value that a "$name" stands for.
void add_giver(Diagnostic& d, const GivenValue& given, const Instance& instance) {
  const std::string shown = quoted_json(*given.value);
  if (given.text == nullptr) {
    d.message += fmt::format(" (from --set {})", given.setting);
    return;
  }
  const TextPlace at = given.text->value_place(given.pointer);
  const bool same = given.text == instance.document->text.get();
  d.related.push_back({.pointer = given.pointer,
                       .message = fmt::format("the value {} stands here", shown),
                       .line = at.line,
                       .column = at.column,
                       .file = same ? std::string() : given.text->file()});
}

}  // namespace

std::optional<Json> substitute(const Json& value, const Instance& scope, const GivenValue** used) {
  if (value.is_string()) {
    const auto& text = value.get_ref<const std::string&>();
    if (!text.starts_with('$')) return value;
    if (text.starts_with("$$")) return Json(text.substr(1));
    const auto found = scope.params.find(std::string_view(text).substr(1));
    if (found == scope.params.end()) return std::nullopt;
    if (used != nullptr && *used == nullptr) *used = &found->second;
    return *found->second.value;
  }
  Json out = value;
  if (value.is_array()) {
    for (Json& item : out) {
      if (!item.is_structured() && !item.is_string()) continue;
      auto replaced = substitute(item, scope, used);
      if (!replaced) return std::nullopt;
      item = std::move(*replaced);
    }
  } else if (value.is_object()) {
    for (auto& [key, item] : out.items()) {
      auto replaced = substitute(item, scope, used);
      if (!replaced) return std::nullopt;
      item = std::move(*replaced);
    }
  }
  return out;
}

void apply_settings(Instance& top, const LoadOptions& options, Diagnostics& problems) {
  const Document& doc = *top.document;
  if (options.frame && doc.find_param("frame") == nullptr)
    report(problems, *doc.text,
           {.code = "no_frame_parameter",
            .severity = Severity::warning,
            .pointer = "",
            .message = "the graph has no parameter 'frame': every frame is the same",
            .expected = "a parameter \"frame\""});
  if (options.frame && doc.find_param("frame") != nullptr)
    top.params["frame"] = {std::make_shared<const Json>(*options.frame),
                           doc.folder,
                           nullptr,
                           {},
                           fmt::format("frame={}", *options.frame)};
  for (const Setting& s : options.settings) {
    if (options.frame && s.address == "frame") {
      report(problems, *doc.text,
             {.code = "frame_set_twice",
              .pointer = "",
              .message = fmt::format("--set frame={} would make every frame of --frames the same", s.value),
              .expected = "--frames, or --set frame=N without it",
              .got = s.value});
      continue;
    }
    if (!has_param_address(doc, s.address)) {
      report(problems, *doc.text,
             {.code = "unknown_address",
              .pointer = "",
              .message = fmt::format("--set {}: there is no such parameter", s.address),
              .expected = "a graph parameter, or NODE:PARAMETER",
              .got = s.address,
              .suggestions = nearest_names(s.address, param_addresses(doc))});
      continue;
    }
    auto value = setting_value(s, doc, problems);
    if (!value) continue;
    const bool own = s.address.find(':') == std::string::npos;
    (own ? top.params : top.overrides)[s.address] = {std::make_shared<const Json>(std::move(*value)),
                                                     doc.folder,
                                                     nullptr,
                                                     {},
                                                     fmt::format("{}={}", s.address, s.value)};
  }
}

namespace {

// Whether substitute() would change the value or fail.
bool takes_parameters(const Json& value) {
  if (value.is_string()) return value.get_ref<const std::string&>().starts_with('$');
  return value.is_structured() && std::any_of(value.begin(), value.end(), takes_parameters);
}

// The value of one parameter of one node.
struct FoundValue {
  std::shared_ptr<const Json> value;
  const GivenValue* giver = nullptr;  // null: written at the node
  bool overridden = false;
  bool whole = false;    // all of it comes from the giver
  bool missing = false;  // a "$name" stands for nothing

  bool elsewhere() const { return overridden && giver->text != nullptr; }
};

FoundValue find_value(const DocumentNode& node, const std::string& name, const Instance& instance) {
  FoundValue out;
  if (!instance.overrides.empty()) {
    const auto over = instance.overrides.find(fmt::format("{}:{}", node.id, name));
    if (over != instance.overrides.end()) return {over->second.value, &over->second, true, true};
  }
  const auto written =
      std::find_if(node.params.begin(), node.params.end(), [&](const auto& p) { return p.name == name; });
  if (written == node.params.end()) return out;
  if (!takes_parameters(*written->value)) {
    out.value = {std::shared_ptr<const Json>(),
                 written->value};  // not owned: the document outlives the reading
  } else if (auto value = substitute(*written->value, instance, &out.giver)) {
    out.value = std::make_shared<const Json>(std::move(*value));
  } else {
    out.missing = true;
  }
  out.whole = out.giver != nullptr && written->value->is_string();
  return out;
}

// Reads the parameters of one node. What is wrong stands where the value is written: at the node, or at what overrides it.
class NodeParams {
 public:
  NodeParams(const DocumentNode& node, const Instance& instance, const LoadOptions& options,
             Diagnostics& problems)
      : node_(node), instance_(instance), options_(options), problems_(problems) {}

  FlatParams read() {
    FlatParams out{.values = node_.type->default_params(), .places = {}};
    for (const ParamField& field : node_.type->params.fields) {
      FoundValue found = find_value(node_, field.name, instance_);
      if (found.missing) whole_ = false;
      if (!found.value) continue;
      read_one(field, found, out.values.get());
      out.places.push_back(place(field.name, found));
      given_.push_back({&field, std::move(found)});
    }
    if (whole_ && node_.type->check) check(out.values.get());
    if (options_.look_for_files)
      for (const Given& given : given_) look_for_files(given, out.values.get());
    return out;
  }

 private:
  std::string pointer_to(std::string_view name, const FoundValue& found) const {
    return found.elsewhere() ? found.giver->pointer
                             : child_pointer(child_pointer(node_.pointer, "params"), name);
  }

  FlatParams::Place place(const std::string& name, const FoundValue& found) const {
    const bool set = found.giver != nullptr && found.giver->text == nullptr;
    return {name, found.elsewhere() ? found.giver->text : instance_.document->text.get(),
            pointer_to(name, found), set ? found.giver->setting : ""};
  }

  // A path is relative to the file that wrote it; one inside a larger value is taken with that value.
  void read_one(const ParamField& field, const FoundValue& found, void* params) {
    Diagnostics read;
    ParamReader reader(read, pointer_to(field.name, found),
                       found.whole ? found.giver->folder : instance_.document->folder, options_.to_linear);
    field.type->read(*found.value, static_cast<char*>(params) + field.offset, field.options, reader);
    for (Diagnostic& d : read.list()) add(std::move(d), found);
  }

  void add(Diagnostic d, const FoundValue& found) {
    whole_ = false;
    if (found.elsewhere()) return report(problems_, *found.giver->text, std::move(d));
    if (found.giver != nullptr) add_giver(d, *found.giver, instance_);
    report_inside(problems_, instance_, std::move(d));
  }

  struct Given {
    const ParamField* field;
    FoundValue found;
  };

  void look_for_files(const Given& given, const void* params) {
    const ParamField& field = *given.field;
    if (!field.type->files) return;
    field.type->files(static_cast<const char*>(params) + field.offset, [&](const FilePath& file) {
      const std::string why = file.empty() ? "" : why_missing(file.resolved, file.written);
      if (why.empty()) return;
      const bool few = problems_.size() < most_looked_beside;
      add({.code = "missing_file",
           .pointer = pointer_to(field.name, given.found),
           .message = why,
           .expected = "a file",
           .got = file.written,
           .suggestions = few ? near_files(file.resolved, file.written) : std::vector<std::string>()},
          given.found);
    });
  }

  // What a node type says of values that are right one by one.
  void check(const void* params) {
    if (const auto fault = fault_of(params)) report_fault(*fault);
  }

  std::optional<NodeError> fault_of(const void* params) const {
    try {
      node_.type->check(params);
    } catch (const NodeError& e) {
      return e;
    }
    return std::nullopt;
  }

  // A fault of values together is named at one of them. Where that one is left to its default, the author looks for it at
  // what he wrote: at the value without which all would be well.
  void report_fault(const NodeError& e) {
    Diagnostic d{.code = e.code,
                 .pointer = node_.pointer,
                 .message = e.what(),
                 .expected = "parameters that fit together"};
    const ParamField* field = field_of(e.part);
    const Given* named = nullptr;
    for (const Given& g : given_)
      if (g.field == field) named = &g;
    std::vector<const Given*> causes = causes_of(e, field);
    if (named != nullptr || (field != nullptr && causes.empty()))
      d.expected = field->doc.substr(0, field->doc.find_last_not_of('.') + 1);
    if (named != nullptr) {
      d.pointer = pointer_to(field->name, named->found) + e.part.substr(at_param(field->name).size());
    } else if (!causes.empty()) {
      named = causes.front();
      causes.erase(causes.begin());
      d.pointer = pointer_to(named->field->name, named->found);
      d.message += fmt::format(" ('{}' is {} unless it is written)", field->name, default_of(*field));
    }
    if (named != nullptr) d.got = quoted_json(*named->found.value);
    for (const Given* cause : causes)
      if (cause->found.giver != nullptr) add_giver(d, *cause->found.giver, instance_);
    add(std::move(d), named != nullptr ? named->found : FoundValue());
  }

  // The other values that were given and without any one of which the fault would not be there.
  std::vector<const Given*> causes_of(const NodeError& fault, const ParamField* named) const {
    std::vector<const Given*> out;
    for (const Given& g : given_) {
      if (named == nullptr || g.field == named) continue;
      const auto without = fault_of(values_without(g).get());
      if (!without || without->code != fault.code || without->part != fault.part) out.push_back(&g);
    }
    return out;
  }

  std::shared_ptr<void> values_without(const Given& left_out) const {
    std::shared_ptr<void> values = node_.type->default_params();
    Diagnostics read_before;
    for (const Given& g : given_) {
      if (&g == &left_out) continue;
      ParamReader reader(read_before, "", instance_.document->folder, options_.to_linear);
      g.field->type->read(*g.found.value, static_cast<char*>(values.get()) + g.field->offset,
                          g.field->options, reader);
    }
    return values;
  }

  std::string default_of(const ParamField& field) const {
    return quoted_json(
        field.type->write(static_cast<const char*>(node_.type->default_params().get()) + field.offset));
  }

  // The parameter that a NodeError names, or that holds what it names.
  const ParamField* field_of(std::string_view part) const {
    for (const ParamField& field : node_.type->params.fields) {
      const std::string own = at_param(field.name);
      if (part.starts_with(own) && (part.size() == own.size() || part[own.size()] == '/')) return &field;
    }
    return nullptr;
  }

  const DocumentNode& node_;
  const Instance& instance_;
  const LoadOptions& options_;
  Diagnostics& problems_;
  std::vector<Given> given_;
  bool whole_ = true;  // every value was read
};

}  // namespace

FlatParams read_params(const DocumentNode& node, const Instance& instance, const LoadOptions& options,
                       Diagnostics& problems) {
  return NodeParams(node, instance, options, problems).read();
}

Buffer read_literal(const Edge& edge, const BufferType& kind, const LoadOptions& options,
                    Diagnostics& problems) {
  const GivenValue* giver = nullptr;
  const auto value = substitute(*edge.literal, *edge.instance, &giver);
  if (!value) return {};
  Diagnostics found;
  ParamReader reader(found, child_pointer(edge.literal_pointer, "value"), edge.instance->document->folder,
                     options.to_linear);
  Buffer buffer = kind.from_json(*value, reader);
  for (Diagnostic& d : found.list()) {
    if (giver != nullptr) add_giver(d, *giver, *edge.instance);
    report_inside(problems, *edge.instance, std::move(d));
  }
  return found.empty() ? buffer : Buffer();
}

}  // namespace frustum
