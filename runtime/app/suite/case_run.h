// The checks of one case against goldens and other buffers, and what they leave behind: outcomes, pictures,
// proposed goldens.
#pragma once

#include "runtime/app/suite/judge.h"
#include "runtime/app/suite/likeness.h"

#include <functional>
#include <map>
#include <string>
#include <vector>

namespace frustum {

class CaseRun {
 public:
  CaseRun(const SuiteCase& c, const GoldenBook& book, const JudgeOptions& options, CaseResult& result)
      : case_(c), book_(book), options_(options), result_(result) {}

  // Counts one check and takes over its outcomes; a NodeError in it is a failure with its message.
  void take(const std::string& port, const std::string& what,
            const std::function<std::vector<Judged>()>& judge);

  void check_finite(const std::string& name, const Buffer&);
  void check_alike(const SuiteCheck&, const Buffer& mine, const Buffer& other, const std::string& what);
  void check_related(const SuiteCheck&, const Buffer& own, const Buffer& changed, const Relation&,
                     const std::string& what);
  void check_golden(const SuiteCheck&, PortRef port, const Buffer&);

  // After a golden that did not hold: of all the ports of which this case has goldens, the first in running
  // order that is not what was accepted.
  void name_first_divergence(const Graph&, const std::map<PortRef, Buffer>& buffers);

 private:
  std::vector<Judged> judge_alike(const SuiteCheck&, const Buffer& mine, const Buffer& other,
                                  const std::string& what);
  std::vector<Judged> judge_golden(const SuiteCheck&, const Buffer&);
  void propose(const std::string& key, const SuiteCheck&, const Buffer&);
  std::string change_of(const Golden& old, const Buffer&) const;
  void keep_pictures(const SuiteCheck&, const Buffer& mine, const Raster* reference,
                     const std::string& against, bool held);
  std::string trace_key(const std::string& port) const { return case_.id + " @" + port; }
  std::string key_of(const SuiteCheck& check) const { return case_.id + " " + check.port; }

  const SuiteCase& case_;
  const GoldenBook& book_;
  const JudgeOptions& options_;
  CaseResult& result_;
  std::map<PortRef, std::string> golden_ports_;  // of this case's checks, and their keys
  bool golden_failed_ = false, trace_ = false;
};

}  // namespace frustum
