#pragma once

#include <asio/io_context.hpp>
#include <asio/steady_timer.hpp>
#include <chrono>
#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <string>

#include "metier/base/clock.hpp"
#include "metier/virtual_controller/controller.hpp"
#include "metier/virtual_controller/peer_lines.hpp"
#include "metier/virtual_controller/tcp_server.hpp"

namespace metier::virtual_controller {

/// Options of a host.
struct HostOptions {
    std::string name;
    std::string type;     ///< a name of controllerTypes()
    std::string address;  ///< address of every port, such as 127.0.1.1
    cell::Settings settings;
    const motion::RobotModel* model = nullptr;
    std::string world_address;          ///< empty: no world
    std::uint16_t control_port = 7400;  ///< 0: a free one
};

/// One virtual controller with its control port, which takes injections and shows the state: each
/// line of JSON is answered by a line of JSON, see controlAnswer().
///
/// Threading: one thread makes, runs and destroys it; stop() from any.
class Host {
public:
    /// Errors: invalid_argument (unknown type with the known ones, settings), already_exists
    /// (port).
    static Result<std::unique_ptr<Host>> start(HostOptions options,
                                               const std::vector<ControllerType>& types);
    ~Host();

    /// Runs the controller until stop().
    void run() { context_.run(); }
    void stop() { context_.stop(); }
    /// Ends run() once no peer is connected to the controller, at the latest after `longest`: a
    /// driver that is about to end brakes its arm first. Any thread; does not wait.
    void stopOnceAlone(std::chrono::milliseconds longest);
    asio::io_context& context() noexcept { return context_; }
    Controller& controller() noexcept { return *controller_; }
    /// Port of the control port, also if a free one was chosen.
    std::uint16_t controlPort() const { return control_->port(); }

    /// Answers a request: {"inject": NAME, "value": TEXT}, {"state": true} or {"help": true}.
    /// \return {"ok": true}, the state, the list of injections, or {"error": why}
    nlohmann::ordered_json controlAnswer(std::string_view line);

private:
    Host() = default;
    void awaitSolitude(SteadyTime deadline);
    std::vector<InjectionHelp> injections();

    asio::io_context context_;
    asio::steady_timer solitude_{context_};
    LinkFaults faults_;
    LinkFaults no_faults_;  // faults of the control port: none
    std::unique_ptr<WorldLink> world_;
    std::unique_ptr<Controller> controller_;
    std::unique_ptr<TcpServer> control_;
    PeerLines lines_;
};

}  // namespace metier::virtual_controller
