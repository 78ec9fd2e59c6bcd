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

struct Options {
    Cell cell;
    Connector connector;
    /// Nobody logs in: everybody on this machine may do what this program may. Such a page is
    /// served at a loopback address alone, and answers no request that a proxy passes on.
    bool lab = false;
    std::string address = "127.0.0.1";
    std::uint16_t port = 0;  ///< 0: a free one
    /// Name by which people reach the page, besides addresses and localhost; empty: none.
    std::string host_name{};
    std::filesystem::path web;       ///< folder with the files of the page
    std::filesystem::path meshes{};  ///< folder served below /meshes; empty: none
    /// Of what servers record, as records::Store::open() takes it; empty: nothing is shown.
    std::string records{};
    std::vector<motion::RobotModel> models{};  ///< whose shapes arms may have
    http::HttpLimits limits{};
};

/// The page of a cell: an OPC UA client of its servers, and the HTTP server that people look at.
///
/// Threading: any thread; threads of its own for each server, each connection of a browser, and the
/// stream.
class Dashboard {
public:
    /// Serves once this returns; servers are connected to in the background.
    /// Errors: invalid_argument (the address; that or a host name of a lab); already_exists (the
    /// port is taken).
    static Result<std::unique_ptr<Dashboard>> start(Options options, const Clock& clock);
    /// Ends all connections within a few seconds; control that tabs hold is given back.
    ~Dashboard();
    Dashboard(const Dashboard&) = delete;
    Dashboard& operator=(const Dashboard&) = delete;

    std::uint16_t port() const noexcept;
    /// One more server, such as discovery finds later. Nothing happens if its name is known.
    void addServer(const CellServer& server);

private:
    struct Impl;
    explicit Dashboard(std::unique_ptr<Impl> impl);
    std::unique_ptr<Impl> impl_;
};

}  // namespace metier::dashboard
