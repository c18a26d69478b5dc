#include "connection_file.h"

#include "pacinian/wire/flat_json.h"
#include "system.h"

namespace pacinian::client {

namespace {

constexpr char variable[] = "PACINIAN_CONNECTION";
constexpr char file[] = "/connection.json";
constexpr char fix[] = "is `pacinian serve` running, or still starting?";

bool exists(const std::string& path) {
  return static_cast<bool>(open_file(path));
}

bool decode(const std::string& content, ConnectionFile& out, std::string& problem) {
  wire::FlatJson json;
  if (!json.parse(content, problem)) return false;
  const std::string* format = json.text("format");
  if (format && *format != "pacinian connection") return problem = "has another format", false;
  if (json.integer("version").value_or(1) != 1)
    return problem = "has another version: update the older of game and server", false;
  const auto pid = json.integer("pid");
  if (!pid) return problem = "lacks `pid`", false;
  out = ConnectionFile{};
  out.pid = *pid;
  const struct {
    const char* name;
    std::string& to;
    bool needed;
  } texts[] = {{"control", out.control, true},          {"command", out.command, true},
               {"state", out.state, true},              {"token", out.token, false},
               {"stop", out.stop, false},
               {"server_key", out.server_key, false},   {"public_key", out.public_key, false},
               {"secret_key", out.secret_key, false}};
  for (const auto& text : texts) {
    const std::string* found = json.text(text.name);
    if (found)
      text.to = *found;
    else if (text.needed)
      return problem = std::string("lacks `") + text.name + "`", false;
  }
  return true;
}

}  // namespace

bool is_text(const std::string& path) { return !path.empty() && path.front() == '{'; }

bool ConnectionFile::read(const std::string& path, std::string& problem) {
  std::string content, why;
  if (is_text(path)) {
    if (decode(path, *this, why)) return true;
    return problem = "the text of the connection is no connection file: " + why, false;
  }
  const std::string at = where(path);
  switch (read_secret(at, wire::FlatJson::longest, content, why)) {
    case Secret::absent:
      return problem = at + ": no connection file; " + fix, false;
    case Secret::unreadable:
      return problem = at + ": cannot be read: " + why, false;
    case Secret::shared:
      return problem = at + ": others can read or change it, so its secrets are none: `chmod 600 " + at +
                       "`, then start the server again",
             false;
    case Secret::foreign:
      return problem = at + ": belongs to another user, whose server it may be", false;
    case Secret::good:
      break;
  }
  if (!decode(content, *this, why)) return problem = at + ": is no connection file: " + why, false;
  if (pid && !runs(pid))
    return problem = at + ": the server that wrote it (process " + std::to_string(pid) +
                     ") has gone; " + fix,
           false;
  return true;
}

std::string where(const std::string& path) {
  if (!path.empty()) return path;
  const std::string given = read_variable(variable);
  if (!given.empty()) return given;
  const std::vector<std::string> folders = runtime_folders();
  for (const std::string& folder : folders)
    if (exists(folder + file)) return folder + file;
  return folders.front() + file;
}

}  // namespace pacinian::client
