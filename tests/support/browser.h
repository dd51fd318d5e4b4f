// A web page as a person meets it: Chromium without a window, driven over a pipe (Chrome DevTools Protocol).
#pragma once

#include "tests/support/temp_file.h"

#include <nlohmann/json.hpp>

#include <string>
#include <vector>

namespace frustum::test {

class Browser {
 public:
  // Starts $CHROMIUM, else chromium; throws std::runtime_error where it cannot, so that a test fails and does not pass unseen.
  Browser();
  ~Browser();
  Browser(const Browser&) = delete;
  Browser& operator=(const Browser&) = delete;

  void size(int width_px, int height_px, bool dark = false);
  void open(const std::string& url);  // returns when the page has loaded
  // The value of a JavaScript expression, awaited where it is a promise; throws what it throws.
  nlohmann::json evaluate(const std::string& expression);
  std::string screenshot();  // PNG bytes of what the window shows
  // Console errors, uncaught exceptions, refused and failed requests since the page was opened.
  const std::vector<std::string>& complaints() const { return complaints_; }

 private:
  nlohmann::json call(const std::string& method, const nlohmann::json& params);
  nlohmann::json read_message();
  void notice(const nlohmann::json& event);

  TempFolder profile_;
  int to_ = -1, from_ = -1, pid_ = -1, next_ = 0;
  std::string session_, unread_;
  bool loaded_ = false;
  std::vector<std::string> complaints_;
};

}  // namespace frustum::test
