#include "tests/support/pixel_nodes.h"

#include <nlohmann/json.hpp>

#include <stdexcept>

namespace frustum::test {

GraphMaker& GraphMaker::add(const std::string& id, const std::string& type,
                            std::vector<std::pair<std::string, std::string>> links,
                            const std::string& params) {
  GraphNode n;
  n.id = id;
  n.type = registry().find(type);
  if (n.type == nullptr) throw std::invalid_argument(type);
  n.inputs.resize(n.type->inputs.size());
  for (const auto& [input, from] : links)
    n.inputs.at(n.type->find_input(input).value()).push_back(port(from));
  auto values = n.type->default_params();
  Diagnostics problems;
  ParamReader reader(problems, "", "");
  read_record(n.type->params, Json::parse(params), values.get(), reader);
  if (problems.has_errors()) throw std::invalid_argument(to_text(problems));
  n.params = values;
  n.place.pointer = "/nodes/" + id;
  graph.nodes.push_back(std::move(n));
  return *this;
}

GraphMaker& GraphMaker::output(const std::string& name, const std::string& from, const std::string& file) {
  GraphOutput o;
  o.name = name;
  o.file = file;
  o.layers = {{"", port(from)}};
  graph.outputs.push_back(std::move(o));
  return *this;
}

}  // namespace frustum::test
