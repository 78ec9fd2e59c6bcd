#include "metier/virtual_controller/controller.hpp"

#include <map>
#include <memory>
#include <utility>

#include "metier/virtual_controller/cycle_timer.hpp"
#include "metier/virtual_controller/standing_time.hpp"
#include "metier/virtual_controller/tcp_server.hpp"
#include "robot.hpp"
#include "web_socket.hpp"

namespace metier::virtual_edo {
namespace {

using namespace virtual_controller;

struct Options {
    RobotOptions robot;
    std::uint16_t port = 0;
    double time_scale = 1.0;
};

constexpr double kDefaultPort = 9090;

Result<Options> readOptions(const ControllerRequest& request) {
    const auto& settings = request.settings;
    const std::string version = settings.textOr("software", "3.2.0");
    const auto software = Software::find(version);
    if (!software) {
        settings.reject("software", software.error().message);
    }
    const double axes = settings.numberOr("axes", kMostAxes, kArmAxes, kMostAxes);
    Options options{
        .robot = {.software = software.value_or(Software{}),
                  .axes = static_cast<std::size_t>(axes),
                  .ready = settings.flagOr("ready", true),
                  .collision_force = settings.numberOr("collision_force", 50.0, 1.0, 1000.0),
                  .kinematics_services = settings.flagOr("kinematics_services", false)},
        .port = static_cast<std::uint16_t>(settings.numberOr("port", kDefaultPort, 0, 65535)),
        .time_scale = settings.numberOr("time_scale", 1.0, 0.01, 100.0)};
    METIER_TRY(settings.finish());
    if (request.model == nullptr || request.model->axisCount() != kArmAxes) {
        return fail(Errc::invalid_argument, request.name + ": an e.DO is an arm of six axes");
    }
    return options;
}

/// One e.DO with its bridge and its port.
///
/// The port stays open over a restart, as the address does; all else begins anew.
class EdoController final : public Controller {
public:
    EdoController(const ControllerRequest& request, Options options)
        : world_(request.world),
          model_(*request.model),
          options_(std::move(options)),
          types_(options_.robot.software) {}

    /// Errors: as TcpServer::listen().
    Result<void> start(const ControllerRequest& request) {
        powerOn();
        METIER_ASSIGN(server_,
                      TcpServer::listen(
                          request.context, {request.address, options_.port}, request.faults,
                          {.on_connected = [this](TcpPeer& peer) { clients_[&peer]; },
                           .on_data = [this](TcpPeer& peer, auto bytes) { onData(peer, bytes); },
                           .on_closed = [this](TcpPeer& peer) { onClosed(peer); }}));
        const std::chrono::duration<double> period(kCycleSeconds / options_.time_scale);
        timer_ = std::make_unique<CycleTimer>(
            request.context, std::chrono::duration_cast<std::chrono::nanoseconds>(period),
            [this] { step(); });
        return {};
    }

    std::vector<InjectionHelp> injections() const override { return robot_->injections(); }
    Json state() const override {
        Json shown = robot_->state();
        shown["clients"] = clients_.size();
        shown["port"] = server_->port();
        standing_.show(shown, std::chrono::steady_clock::now());
        return shown;
    }
    void restart() override {
        for (auto& [peer, client] : clients_) {
            client = {};
        }
        server_->resetAll();
        powerOn();
    }

private:
    /// A WebSocket with its name at the bridge.
    struct Client {
        WebSocket socket{};
        Rosbridge::ClientId id = 0;  // 0: the handshake is not done
    };

    void onData(TcpPeer& peer, std::span<const std::byte> bytes) {
        auto& client = clients_[&peer];
        const auto received = client.socket.receive(bytes);
        peer.send(received.answer);
        if (client.id == 0 && client.socket.isOpen()) {
            client.id = bridge_->addClient(
                [&peer](const std::string& text) { peer.send(WebSocket::textFrame(text)); });
        }
        for (const auto& message : received.messages) {
            bridge_->receive(client.id, message);
        }
        if (received.close) {
            bridge_->removeClient(std::exchange(client.id, 0));
            peer.close();
        }
    }

    void onClosed(const TcpPeer& peer) {
        const auto client = clients_.find(&peer);
        if (client != clients_.end()) {
            bridge_->removeClient(client->second.id);
            clients_.erase(client);
        }
    }

    void powerOn() {
        robot_ = std::make_unique<Robot>(options_.robot, model_);
        bridge_ = std::make_unique<Rosbridge>(types_, robot_->graph(), started_);
        bridge_->setTime(now_);
        robot_->connect([this](const std::string& topic,
                               const Json& message) { bridge_->publish(topic, message); },
                        [this](std::string_view topic) { return bridge_->hasSubscribers(topic); });
    }

    void step() {
        now_ += kCycle;
        bridge_->setTime(now_);
        auto report = robot_->step(world_.effect());
        report.time = std::chrono::duration<double>(now_.time_since_epoch()).count();
        world_.report(report);
        standing_.take(robot_->jointPosition().span(), std::chrono::steady_clock::now());
    }

    WorldLink& world_;
    const motion::RobotModel& model_;
    Options options_;
    MessageTypes types_;
    SteadyTime now_{};  // the robot's own, which time_scale makes faster
    UtcTime started_ = std::chrono::system_clock::now();
    std::unique_ptr<Robot> robot_;
    std::unique_ptr<Rosbridge> bridge_;
    std::map<const TcpPeer*, Client> clients_;
    std::unique_ptr<TcpServer> server_;
    std::unique_ptr<CycleTimer> timer_;
    StandingTime standing_;
};

Result<std::unique_ptr<Controller>> startEdo(const ControllerRequest& request) {
    METIER_ASSIGN(auto options, readOptions(request));
    auto controller = std::make_unique<EdoController>(request, std::move(options));
    METIER_TRY(controller->start(request));
    return controller;
}

}  // namespace
}  // namespace metier::virtual_edo

namespace metier::virtual_controller {

ControllerType edoController();

ControllerType edoController() {
    return {.name = "edo",
            .help = "Comau e.DO with gripper: rosbridge (JSON over WebSocket), port 9090",
            .start = &virtual_edo::startEdo};
}

}  // namespace metier::virtual_controller
