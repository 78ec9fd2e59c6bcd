#pragma once

#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "server_watch.hpp"

namespace metier::dashboard {

/// A skill, and the link by which it is reached; keep the link while the skill is used.
struct ReachedSkill {
    std::shared_ptr<ServerLink> link;
    const LinkedSkill* skill = nullptr;
};

/// The links to all servers of the cell.
///
/// Threading: any.
class Watches {
public:
    /// All arguments must outlive this.
    Watches(Board& board, const Connector& connector,
            const std::vector<motion::RobotModel>& models);

    /// Begins to watch a server; nothing if one of its name is watched.
    void add(const CellServer& server);
    /// Ends all links; no other call after that.
    void end();

    void showLive(bool shown);
    /// Names of the servers, in the order in which they were added.
    std::vector<std::string> servers() const;
    /// nullptr: no such server, or not connected.
    std::shared_ptr<ServerLink> link(const std::string& server) const;
    /// Its address. Errors: not_found.
    Result<std::string> url(const std::string& server) const;
    /// Errors: not_found; connection_lost, if its server is not connected.
    Result<ReachedSkill> skill(const std::string& key) const;
    /// Servers whose skills those of another one use, each with the name of one that does.
    std::map<std::string, std::string> usedServers() const;

private:
    std::string serverAt(const std::string& url) const;

    Board& board_;
    const Connector& connector_;
    const std::vector<motion::RobotModel>& models_;
    mutable std::mutex mutex_;
    std::vector<CellServer> known_;
    std::vector<std::unique_ptr<ServerWatch>> watches_;
    bool live_ = false;
};

}  // namespace metier::dashboard
