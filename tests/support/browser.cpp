#include "tests/support/browser.h"

#include <fcntl.h>
#include <poll.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <cstdlib>
#include <stdexcept>

namespace frustum::test {
namespace {

using nlohmann::json;

constexpr int timeout_ms = 90'000;  // a cold start on a busy machine takes some 10 s

std::string decode_base64(const std::string& text) {
  std::string out;
  unsigned bits = 0, held = 0;
  for (const char c : text) {
    const unsigned digit = c >= 'A' && c <= 'Z'   ? static_cast<unsigned>(c - 'A')
                           : c >= 'a' && c <= 'z' ? static_cast<unsigned>(c - 'a') + 26
                           : c >= '0' && c <= '9' ? static_cast<unsigned>(c - '0') + 52
                           : c == '+'             ? 62u
                                                  : 63u;
    if (c == '=') break;
    bits = bits << 6 | digit;
    held += 6;
    if (held < 8) continue;
    held -= 8;
    out += static_cast<char>(bits >> held & 255);
  }
  return out;
}

}  // namespace

Browser::Browser() {
  int commands[2], events[2];
  if (::pipe2(commands, O_CLOEXEC) != 0 || ::pipe2(events, O_CLOEXEC) != 0)
    throw std::runtime_error("no pipes");
  const char* named = std::getenv("CHROMIUM");
  const std::string program = named != nullptr ? named : "chromium",
                    profile = "--user-data-dir=" + profile_.path();
  pid_ = ::fork();
  if (pid_ == 0) {
    // The protocol is spoken over descriptors 3 and 4. They are first moved out of the way of each other.
    const int in = ::fcntl(commands[0], F_DUPFD, 10), out = ::fcntl(events[1], F_DUPFD, 10);
    ::dup2(in, 3);
    ::dup2(out, 4);
    const int nowhere = ::open("/dev/null", O_RDWR);
    for (const int fd : {0, 1, 2}) ::dup2(nowhere, fd);
    ::execlp(program.c_str(), program.c_str(), "--headless=new", "--no-sandbox", "--disable-gpu",
             "--no-first-run", "--disable-dev-shm-usage", "--disable-background-networking",
             "--disable-component-update", "--hide-scrollbars", "--remote-debugging-pipe", profile.c_str(),
             "about:blank", static_cast<char*>(nullptr));
    ::_exit(127);
  }
  ::close(commands[0]);
  ::close(events[1]);
  to_ = commands[1], from_ = events[0];
  std::signal(SIGPIPE, SIG_IGN);
  const json target = call("Target.createTarget", {{"url", "about:blank"}});
  session_ =
      call("Target.attachToTarget", {{"targetId", target["targetId"]}, {"flatten", true}})["sessionId"];
  for (const char* domain : {"Page.enable", "Runtime.enable", "Log.enable", "Network.enable"})
    call(domain, json::object());
}

Browser::~Browser() {
  if (pid_ > 0) {
    ::kill(pid_, SIGTERM);
    ::waitpid(pid_, nullptr, 0);
  }
  ::close(to_);
  ::close(from_);
}

json Browser::read_message() {
  for (;;) {
    if (const auto end = unread_.find('\0'); end != std::string::npos) {
      const json message = json::parse(unread_.substr(0, end));
      unread_.erase(0, end + 1);
      return message;
    }
    pollfd wait{from_, POLLIN, 0};
    if (::poll(&wait, 1, timeout_ms) <= 0) throw std::runtime_error("the browser does not answer");
    char block[1 << 16];
    const ssize_t n = ::read(from_, block, sizeof block);
    if (n <= 0)
      throw std::runtime_error("the browser did not start, or ended: is the package chromium installed?");
    unread_.append(block, static_cast<std::size_t>(n));
  }
}

json Browser::call(const std::string& method, const json& params) {
  json message = {{"id", ++next_}, {"method", method}, {"params", params}};
  if (!session_.empty()) message["sessionId"] = session_;
  const std::string text = message.dump() + '\0';
  for (std::size_t sent = 0; sent < text.size();) {
    const ssize_t n = ::write(to_, text.data() + sent, text.size() - sent);
    if (n <= 0)
      throw std::runtime_error("the browser did not start, or ended: is the package chromium installed?");
    sent += static_cast<std::size_t>(n);
  }
  for (;;) {
    const json answer = read_message();
    if (answer.value("id", 0) != next_) {
      notice(answer);
      continue;
    }
    if (answer.contains("error")) throw std::runtime_error(method + ": " + answer["error"].dump());
    return answer["result"];
  }
}

void Browser::notice(const json& event) {
  const std::string method = event.value("method", "");
  const json& params = event.contains("params") ? event["params"] : json::object();
  if (method == "Page.loadEventFired") loaded_ = true;
  if (method == "Runtime.exceptionThrown") complaints_.push_back(params["exceptionDetails"].dump());
  if (method == "Runtime.consoleAPICalled" && (params["type"] == "error" || params["type"] == "warning"))
    complaints_.push_back(params["args"].dump());
  if (method == "Log.entryAdded" && params["entry"]["level"] == "error")
    complaints_.push_back(params["entry"].dump());
  if (method == "Network.requestWillBeSent")
    if (const std::string url = params["request"]["url"];
        !url.starts_with("file:") && !url.starts_with("data:"))
      complaints_.push_back("a request to " + url);
}

void Browser::size(int width_px, int height_px, bool dark) {
  call("Emulation.setDeviceMetricsOverride",
       {{"width", width_px}, {"height", height_px}, {"deviceScaleFactor", 1}, {"mobile", width_px < 600}});
  call("Emulation.setEmulatedMedia",
       {{"features", json::array({{{"name", "prefers-color-scheme"}, {"value", dark ? "dark" : "light"}}})}});
}

void Browser::open(const std::string& url) {
  complaints_.clear();
  loaded_ = false;
  call("Page.navigate", {{"url", url}});
  while (!loaded_) notice(read_message());
}

json Browser::evaluate(const std::string& expression) {
  const json r =
      call("Runtime.evaluate", {{"expression", expression}, {"awaitPromise", true}, {"returnByValue", true}});
  if (r.contains("exceptionDetails")) throw std::runtime_error(r["exceptionDetails"].dump());
  return r["result"].value("value", json());
}

std::string Browser::screenshot() {
  return decode_base64(call("Page.captureScreenshot", {{"format", "png"}})["data"]);
}

}  // namespace frustum::test
