// One moving line on a terminal: what runs, how far it is, how long it will take.
#pragma once

#include "runtime/graph/events.h"

#include <chrono>
#include <cstddef>
#include <string>

namespace frustum::cli {

class ProgressBar : public Observer {
 public:
  ProgressBar() : began_(std::chrono::steady_clock::now()), drawn_(began_), item_began_(began_) {}
  ~ProgressBar() override { clear(); }
  void planned(std::size_t items) override { items_ = items; }
  void started(std::string_view node) override;
  void progress(std::string_view node, double fraction) override;
  void done(const WorkDone& work) override;

  // The line as it would be drawn `width` characters wide; the estimate assumes that all items take
  // equally long.
  static std::string line(std::string_view node, double share, std::chrono::nanoseconds spent,
                          std::size_t width);

 private:
  // Of the time that the whole run will take. Passes over pixels take most of it, so it is the time that
  // the current item is heading for, with what came before it; items that report no progress count alike.
  double share(std::chrono::steady_clock::time_point now) const;
  void draw();
  void clear();

  std::chrono::steady_clock::time_point began_, drawn_, item_began_;
  std::size_t items_ = 0, finished_ = 0;
  double fraction_ = 0;  // of the item that reported last
  std::string node_;
  bool visible_ = false;
};

}  // namespace frustum::cli
