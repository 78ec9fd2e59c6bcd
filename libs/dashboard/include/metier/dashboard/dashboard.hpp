#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "metier/base/clock.hpp"
#include "metier/base/error.hpp"
#include "metier/dashboard/cell.hpp"
#include "metier/motion/robot_model.hpp"
#include "metier/opcua/client.hpp"

namespace metier::dashboard {

/// How this program connects to servers. Both functions from any thread.
struct Connector {
    /// As secure as that server wants it, as this program's own user.
    /// Errors: told on the page.
    std::function<Result<opcua::ClientOptions>(const std::string& url)> options;
    /// What a person can do about a connection that was refused; begins with "; ", or is empty.
    std::function<std::string(const opcua::Failure&)> advice;
};

/// What one peer may ask of the page's server.
struct HttpLimits {
    std::size_t connections = 256;                   ///< at the same time, streams among them
    std::size_t tabs = 128;                          ///< streams at the same time
    std::size_t head_bytes = 16'384;                 ///< request line and header fields
    std::size_t body_bytes = 262'144;                ///< of one request
    std::size_t waiting_bytes = 2'097'152;           ///< owed to one stream; then it is cut
    std::chrono::milliseconds request_time{10'000};  ///< for one request to arrive
    std::chrono::milliseconds idle_time{15'000};     ///< between two requests of a connection
    std::chrono::milliseconds send_time{5'000};      ///< without progress; then it is cut
};

struct Options {
    Cell cell;
    Connector connector;
    /// Nobody logs in: whoever reaches the page may do what this program may.
    bool lab = false;
    std::string address = "127.0.0.1";
    std::uint16_t port = 0;  ///< 0: a free one
    /// Name by which people reach the page, besides addresses and localhost; empty: none.
    std::string host_name{};
    std::filesystem::path web;                 ///< folder with the files of the page
    std::filesystem::path meshes{};            ///< folder served below /meshes; empty: none
    std::vector<motion::RobotModel> models{};  ///< whose shapes arms may have
    HttpLimits limits{};
};

/// The page of a cell: an OPC UA client of its servers, and the HTTP server that people look at.
///
/// Threading: any thread; threads of its own for each server, each connection of a browser, and the
/// stream.
class Dashboard {
public:
    /// Serves once this returns; servers are connected to in the background.
    /// Errors: invalid_argument (the address); already_exists (the port is taken).
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
