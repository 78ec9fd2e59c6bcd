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
    /// Name of the controller in the cell file.
    std::string name;
    /// Name of one of controllerTypes().
    std::string type;
    /// Address of every port: "127.0.1.1".
    std::string address;
    /// Settings of the controller.
    cell::Settings settings;
    /// Model of the arm, must outlive the host; nullptr for other devices.
    const motion::RobotModel* model = nullptr;
    /// Address of the world's process; empty: no world.
    std::string world_address;
    /// TCP port for injections; 0: a free one.
    std::uint16_t control_port = 7400;
};

/// One virtual controller with its control port, which takes injections and shows the state: each
/// line of JSON is answered by a line of JSON, see controlAnswer().
///
///     auto host = Host::start({.name = "ur5", .type = "ur", .address = "127.0.1.1"},
///                             controllerTypes());
///     (*host)->run();  // until stop()
///
/// Threading: one thread makes, runs and destroys it; stop() from any.
///
/// Requests on the control port, one line each, which `metier virtual inject` and tests send:
///
///     {"inject": "emergency-stop", "value": ""}   ->  {"ok": true}
///     {"inject": "delay", "value": "50"}          ->  {"ok": true}, all later bytes 50 ms late
///     {"state": true}                             ->  what Controller::state() gives
///     {"help": true}                              ->  {NAME: one line of help, ...}
class Host {
public:
    /// Makes the controller and opens the control port; run() serves.
    /// Errors: invalid_argument (unknown type with the known ones, settings), already_exists
    ///         (port); those of the controller.
    static Result<std::unique_ptr<Host>> start(HostOptions options,
                                               const std::vector<ControllerType>& types);
    ~Host();

    /// Runs the controller until stop(), on the calling thread.
    /// Exceptions of handlers leave it; it cannot be run a second time after stop().
    void run() { context_.run(); }
    /// Ends run() soon. Any thread; does not wait.
    void stop() { context_.stop(); }
    /// Ends run() once no peer is connected to the controller, at the latest after `longest`: a
    /// driver that is about to end brakes its arm first. Any thread; does not wait.
    void stopOnceAlone(std::chrono::milliseconds longest);
    /// Context that run() runs; for tests that add work of their own.
    asio::io_context& context() noexcept { return context_; }
    /// The controller; valid as long as this.
    Controller& controller() noexcept { return *controller_; }
    /// Port of the control port, also if a free one was chosen.
    std::uint16_t controlPort() const { return control_->port(); }

    /// Answers a request: {"inject": NAME, "value": TEXT}, {"state": true} or {"help": true}.
    /// \return {"ok": true}, the state, the list of injections, or {"error": why}
    nlohmann::ordered_json controlAnswer(std::string_view line);

private:
    Host() = default;
    /// Looks every 10 ms whether a peer is still connected; stops the context then or at the
    /// deadline.
    void awaitSolitude(SteadyTime deadline);
    /// Injections of the controller, then the faults that every controller has.
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
