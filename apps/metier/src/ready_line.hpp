#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace metier::app {

/// The one line a server prints to standard output, once clients may connect.
inline std::string readyLine(std::string_view url) {
    return "ready " + std::string(url);
}

/// The address in a ready line; nothing if it is none.
inline std::optional<std::string> urlOfReadyLine(std::string_view line) {
    constexpr std::string_view kPrefix = "ready opc.tcp://";
    if (!line.starts_with(kPrefix)) {
        return std::nullopt;
    }
    return std::string(line.substr(std::string_view("ready ").size()));
}

}  // namespace metier::app
