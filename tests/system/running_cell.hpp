#pragma once

#include <poll.h>

#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "metier/link/child_process.hpp"

namespace metier::system_tests {

/// `metier up` of a cell file with free ports and addresses; every process of it ends with this.
class RunningCell {
public:
    /// \param more options of `metier up`
    /// Throws unless everything is ready within a minute.
    explicit RunningCell(const std::filesystem::path& file,
                         const std::vector<std::string>& more = {});
    ~RunningCell();
    RunningCell(const RunningCell&) = delete;
    RunningCell& operator=(const RunningCell&) = delete;

    /// Servers by name.
    const std::map<std::string, std::string>& urls() const { return urls_; }
    const std::string& url(const std::string& server) const { return urls_.at(server); }
    const std::string& virtualAddress(const std::string& controller) const {
        return virtual_addresses_.at(controller);
    }
    /// File for the option `--endpoints` of other commands.
    const std::filesystem::path& endpoints() const { return endpoints_; }
    /// Number of processes below `metier up`.
    std::size_t size() const { return urls_.size() + virtual_addresses_.size(); }
    link::ChildProcess& process() { return process_; }

    /// Does as `metier virtual inject`. Throws if it is refused.
    void inject(const std::string& controller, const std::string& fault,
                const std::string& value = "") const;
    /// Output of `metier virtual state`.
    nlohmann::json state(const std::string& controller) const;

    /// Handles of the processes, readable once they have ended; the caller closes them.
    std::vector<pollfd> children() const;
    std::vector<pid_t> childPids() const;

private:
    std::filesystem::path endpoints_;
    link::ChildProcess process_;
    std::map<std::string, std::string> urls_;
    std::map<std::string, std::string> virtual_addresses_;
};

}  // namespace metier::system_tests
