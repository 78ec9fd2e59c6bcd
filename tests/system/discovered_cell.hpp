#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "metier/link/child_process.hpp"
#include "metier/opcua/discovery.hpp"
#include "metier_program.hpp"

namespace metier::system_tests {

/// `metier discovery` in a process of its own.
class DiscoveryProcess {
public:
    /// \param forget_after [s]; \param port 0: a free one
    explicit DiscoveryProcess(int forget_after = 3'600, const std::string& port = "0");

    const std::string& url() const noexcept { return url_; }
    std::string port() const { return url_.substr(url_.rfind(':') + 1); }
    void signal(int number) { process_.signal(number); }
    void kill();

    /// Names of the servers that it knows, without itself.
    std::vector<std::string> names() const;
    /// Whether it knows, within a minute, a server of that name, or does not any more.
    bool awaitKnown(const std::string& name) const;
    bool awaitForgotten(const std::string& name) const;

private:
    link::ChildProcess process_;
    std::string url_;
};

/// discovered.toml.
std::filesystem::path discoveredCell();

/// A server of it that registers there.
ServerProcess serveDiscovered(const std::string& name, const std::string& discovery_url,
                              std::vector<std::string> more = {});

/// Asks again and again; whether it held within a minute.
bool holdsSoon(const std::function<bool()>& holds);

}  // namespace metier::system_tests
