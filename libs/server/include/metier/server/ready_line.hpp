#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace metier::server {

/// Line that a server prints to standard output once clients may connect; without its line end.
/// Threads of all functions here: any; pure.
/// \param url "opc.tcp://host:port"
inline std::string readyLine(std::string_view url) {
    return "ready " + std::string(url);
}

/// Line that a virtual controller prints to standard output once drivers may connect; without its
/// line end.
/// \param address IP address of its ports
inline std::string readyVirtualLine(std::string_view address) {
    return "ready virtual " + std::string(address);
}

/// Address in a ready line of either kind; nothing for any other line.
///
///     addressOfReadyLine("ready opc.tcp://127.0.0.1:4841");  // opc.tcp://127.0.0.1:4841
///     addressOfReadyLine("ready virtual 127.0.1.1");         // 127.0.1.1
/// \param line without its line end
inline std::optional<std::string> addressOfReadyLine(std::string_view line) {
    constexpr std::string_view kServer = "ready opc.tcp://";
    constexpr std::string_view kVirtual = "ready virtual ";
    if (line.starts_with(kServer)) {
        return std::string(line.substr(std::string_view("ready ").size()));
    }
    if (line.starts_with(kVirtual)) {
        return std::string(line.substr(kVirtual.size()));
    }
    return std::nullopt;
}

}  // namespace metier::server
