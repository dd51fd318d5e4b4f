#include "runtime/cli/progress.h"

#include "runtime/core/text.h"

#include <fmt/format.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>

namespace frustum::cli {
namespace {

// A run that ends sooner shows nothing; redrawing more often only flickers.
constexpr std::chrono::milliseconds silence{300}, interval{100};

std::size_t terminal_width() {
  winsize size{};
  return ::ioctl(STDERR_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 0 ? size.ws_col : 80;
}

}  // namespace

std::string ProgressBar::line(std::string_view node, double share, std::chrono::nanoseconds spent,
                              std::size_t width) {
  share = std::clamp(share, 0.0, 1.0);
  constexpr std::size_t bar = 24;
  const auto full = static_cast<std::size_t>(share * bar);
  std::string left = "";
  if (share > 0.02) {
    const double seconds = std::chrono::duration<double>(spent).count() * (1 - share) / share;
    left = seconds < 1 ? "less than 1 s left"
                       : human_time(std::chrono::seconds(static_cast<std::int64_t>(seconds + 0.5))) + " left";
  }
  std::string out = fmt::format("[{}{}] {:3.0f} %  {}  {}", std::string(full, '#'),
                                std::string(bar - full, '.'), share * 100, node, left);
  if (out.size() + 1 > width) out.resize(width > 0 ? width - 1 : 0);
  return out;
}

void ProgressBar::started(std::string_view node) {
  node_ = node;
  fraction_ = 0;
  item_began_ = std::chrono::steady_clock::now();
  draw();
}

void ProgressBar::progress(std::string_view node, double fraction) {
  node_ = node;
  fraction_ = fraction;
  draw();
}

void ProgressBar::done(const WorkDone&) {
  ++finished_;
  fraction_ = 0;
  draw();
}

double ProgressBar::share(std::chrono::steady_clock::time_point now) const {
  using seconds = std::chrono::duration<double>;
  if (fraction_ > 0) {
    const double before = seconds(item_began_ - began_).count(), spent = seconds(now - began_).count();
    const double total = before + (spent - before) / fraction_;
    return total > 0 ? spent / total : 0;
  }
  return items_ != 0 ? static_cast<double>(std::min(finished_, items_)) / static_cast<double>(items_) : 0;
}

void ProgressBar::draw() {
  const auto now = std::chrono::steady_clock::now();
  if (now - began_ < silence || now - drawn_ < interval) return;
  drawn_ = now;
  visible_ = true;
  const std::string text = "\r\033[K" + line(node_, share(now), now - began_, terminal_width());
  std::fwrite(text.data(), 1, text.size(), stderr);
}

void ProgressBar::clear() {
  if (visible_) std::fputs("\r\033[K", stderr);
  visible_ = false;
}

}  // namespace frustum::cli
