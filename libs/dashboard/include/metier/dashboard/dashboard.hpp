#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "metier/base/clock.hpp"
#include "metier/base/error.hpp"
#include "metier/dashboard/cell.hpp"
#include "metier/dashboard/connector.hpp"
#include "metier/http/http_limits.hpp"
#include "metier/motion/robot_model.hpp"

namespace metier::dashboard {

/// Settings of the page.
struct Options {
    /// Cell that is shown.
    Cell cell;
    /// Identity of its connections to the servers.
    Connector connector;
    /// Whether there is no login: everybody on this machine may do what this program may. Such a
    /// page is served only at a loopback address, and answers no request that came through a proxy.
    bool lab = false;
    /// IP address to listen on.
    std::string address = "127.0.0.1";
    /// TCP port; 0: a free one.
    std::uint16_t port = 0;
    /// Host name by which people reach the page, besides addresses and localhost; empty: none.
    std::string host_name{};
    /// Folder with the files of the page.
    std::filesystem::path web;
    /// Folder served below /meshes; empty: none.
    std::filesystem::path meshes{};
    /// URL of the servers' records, as records::Store::open() takes it; empty: none are shown.
    std::string records{};
    /// Robot models whose shapes arms may have.
    std::vector<motion::RobotModel> models{};
    /// Limits for browsers.
    http::HttpLimits limits{};
};

/// The page of a cell: an OPC UA client of its servers, and an HTTP server for browsers.
///
/// Threading: any thread may call it. It has threads for each server, each connection of a browser,
/// and the stream.
///
///     auto page = Dashboard::start({.cell = cellFrom(config), .lab = true, .web = web}, clock);
///     print("http://127.0.0.1:{}", (*page)->port());
class Dashboard {
public:
    /// Starts serving; connects to the servers in the background.
    /// \param clock must outlive the page
    /// Errors: invalid_argument (the address, or a host name or an address that is not allowed
    ///         without login); already_exists (the port is taken).
    static Result<std::unique_ptr<Dashboard>> start(Options options, const Clock& clock);
    /// Ends all connections within a few seconds; gives back the control that browser tabs hold.
    ~Dashboard();
    Dashboard(const Dashboard&) = delete;
    Dashboard& operator=(const Dashboard&) = delete;

    /// Port on which it listens, also if a free one was chosen.
    std::uint16_t port() const noexcept;
    /// Adds a server, for example one that discovery finds later. Does nothing if its name is
    /// known.
    void addServer(const CellServer& server);

private:
    struct Impl;
    explicit Dashboard(std::unique_ptr<Impl> impl);
    std::unique_ptr<Impl> impl_;
};

}  // namespace metier::dashboard
