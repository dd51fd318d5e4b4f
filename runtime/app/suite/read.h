// Reading a suite file: what its parts have in common. Included by the reader's own files only.
#pragma once

#include "runtime/app/suite/keys.h"
#include "runtime/app/suite/suite.h"

#include <functional>
#include <map>
#include <string>
#include <vector>

namespace frustum {

// Says what is wrong at the place where it is, and reads on.
class SuiteParser {
 public:
  SuiteParser(std::string folder, Diagnostics& problems)
      : at(problems, "", folder), folder(std::move(folder)) {}

  // The members of an object as one of the structs of suite_keys; unknown ones are named with near ones.
  template <class Keys>
  Keys keys(const Json& object) {
    Keys out;
    read_record(param_type<Keys>(), object, &out, at);
    return out;
  }

  void wrong(const std::string& expected) { at.problem("wrong_type", "expected " + expected, expected); }
  void missing(const std::string& message) { at.problem("missing_key", message); }
  void conflict(const std::string& message) { at.problem("conflicting_keys", message); }

  // Looks into JSON that was kept as text, one level deeper; nothing where it was not given.
  void inside(const char* key, const JsonText&, const std::function<void(const Json&)>& body);
  void each(const char* key, const JsonText& list, const std::function<void(const Json&)>& body);

  // Addresses and values, or addresses and lists of values.
  std::map<std::string, std::string> settings(const char* key, const JsonText&);
  std::map<std::string, std::vector<std::string>> matrix(const char* key, const JsonText&);
  std::string path(const std::string& written) const;  // from the suite's folder

  ParamReader at;
  std::string folder;
};

SuiteCheck read_check(SuiteParser&, const Json&);

// Presets and a case's own settings; what comes later stands above what came before, address by address.
struct Variation {
  std::map<std::string, std::string> set;                  // JSON texts
  std::map<std::string, std::vector<std::string>> matrix;  // lists of them
  void override_with(const Variation& above);
};

// One case for every file that matches and every combination of the matrix, appended to `out`. False where
// no file matches, or where they are more than `most`.
enum class Expanded : std::uint8_t { done, no_file, too_many };
Expanded expand(const std::string& pattern, const SuiteCase& base, const Variation&, std::size_t most,
                std::vector<SuiteCase>& out);

}  // namespace frustum
