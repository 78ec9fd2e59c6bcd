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

/// What a host is to run.
struct HostOptions {
    std::string name;
    std::string type;     ///< of controllerTypes()
    std::string address;  ///< for every port, as 127.0.1.1
    cell::Settings settings;
    const motion::RobotModel* model = nullptr;
    std::string world_address;          ///< empty: no world
    std::uint16_t control_port = 7400;  ///< 0: a free one
};

/// One virtual controller with its control port, through which it is asked to suffer and to show
/// itself: a line of JSON for a line of JSON (controlAnswer()).
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
    /// Ends run() once nobody is connected to the controller, or at the latest after that time:
    /// a driver that is about to end brakes its arm first. Any thread; does not wait.
    void stopOnceAlone(std::chrono::milliseconds longest);
    asio::io_context& context() noexcept { return context_; }
    Controller& controller() noexcept { return *controller_; }
    std::uint16_t controlPort() const { return control_->port(); }

    /// {"inject": NAME, "value": TEXT}, {"state": true} or {"help": true}.
    /// \return {"ok": true}, the state, the list of injections, or {"error": why}
    nlohmann::ordered_json controlAnswer(std::string_view line);

private:
    Host() = default;
    void awaitSolitude(SteadyTime deadline);
    Result<void> inject(const Injection& injection);
    std::vector<InjectionHelp> injections() const;

    asio::io_context context_;
    asio::steady_timer solitude_{context_};
    LinkFaults faults_;
    LinkFaults no_faults_;  // of the control port
    std::unique_ptr<WorldLink> world_;
    std::unique_ptr<Controller> controller_;
    std::unique_ptr<TcpServer> control_;
    PeerLines lines_;
};

}  // namespace metier::virtual_controller
