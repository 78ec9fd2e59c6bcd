// The world as a process of its own: every virtual controller of a cell talks to it.
#include <fmt/format.h>

#include <cstdint>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>

#include "metier/motion/frame.hpp"
#include "metier/virtual_controller/controller.hpp"
#include "metier/virtual_controller/peer_lines.hpp"
#include "metier/virtual_controller/remote_world.hpp"
#include "metier/virtual_controller/tcp_server.hpp"
#include "metier/virtual_controller/world_messages.hpp"
#include "world.hpp"

namespace metier::virtual_world {
namespace {

using namespace virtual_controller;

class WorldServer final : public Controller {
public:
    explicit WorldServer(WorldOptions options) : options_(options), world_(std::move(options)) {}

    Result<void> listen(const ControllerRequest& request, std::uint16_t port) {
        return TcpServer::listen(request.context, {request.address, port}, request.faults,
                                 {.on_connected = {},
                                  .on_data =
                                      [this](TcpPeer& peer, auto bytes) {
                                          lines_.add(peer, bytes, [&](std::string_view line) {
                                              answer(peer, line);
                                          });
                                      },
                                  .on_closed = [this](TcpPeer& peer) { lines_.forget(peer); }})
            .map([this](auto opened) { server_ = std::move(opened); });
    }

    std::vector<InjectionHelp> injections() const override { return injections_; }
    nlohmann::ordered_json state() const override {
        auto parts = nlohmann::ordered_json::object();
        for (const auto& [name, part] : world_.parts()) {
            const auto frame = motion::toFrame(part.world_from_part);
            parts[name] = {{"pose", {frame.x, frame.y, frame.z, frame.a, frame.b, frame.c}},
                           {"size", {part.size.x(), part.size.y(), part.size.z()}},
                           {"held_by", part.held_by}};
        }
        return {{"parts", parts}, {"port", server_->port()}};
    }

    void restart() override {
        world_ = World(options_);
        server_->resetAll();
    }

private:
    void answer(TcpPeer& peer, std::string_view line) {
        if (const auto report = reportOf(line)) {
            peer.send(toLine(world_.report(report->name, report->report)));
        } else {
            peer.reset();
        }
    }
    Result<void> place(const std::string& text) {
        const auto comma = text.find(',');
        double x = 0.0;
        double y = 0.0;
        double z = 0.0;
        int end = 0;
        if (comma == std::string::npos ||
            std::sscanf(text.c_str() + comma, ",%lf,%lf,%lf%n", &x, &y, &z, &end) != 3 ||
            comma + static_cast<std::size_t>(end) != text.size() ||
            !Eigen::Vector3d(x, y, z).allFinite()) {
            return fail(Errc::invalid_argument,
                        fmt::format("place needs NAME,X,Y,Z; not \"{}\"", text));
        }
        return world_.place(text.substr(0, comma), {x, y, z});
    }

    const std::vector<InjectionHelp> injections_{
        {"drop", "Parts held by the gripper CONTROLLER fall; without a name: all parts",
         [this](const std::string& gripper) -> Result<void> {
             world_.drop(gripper);
             return {};
         }},
        {"remove", "Takes the part NAME away",
         [this](const std::string& part) { return world_.remove(part); }},
        {"place", "Puts a part somewhere: NAME,X,Y,Z in m",
         [this](const std::string& text) { return place(text); }}};
    WorldOptions options_;
    World world_;
    std::unique_ptr<TcpServer> server_;
    PeerLines lines_;
};

Result<std::unique_ptr<Controller>> startWorld(const ControllerRequest& request) {
    auto options = readOptions(request.settings);
    const auto port =
        static_cast<std::uint16_t>(request.settings.numberOr("port", RemoteWorld::kPort, 0, 65535));
    METIER_TRY(request.settings.finish());
    auto server = std::make_unique<WorldServer>(std::move(options));
    METIER_TRY(server->listen(request, port));
    return server;
}

}  // namespace
}  // namespace metier::virtual_world

namespace metier::virtual_controller {

ControllerType worldController();
ControllerType worldController() {
    return {"world", "The cell around the others: parts, table, walls", virtual_world::startWorld};
}

}  // namespace metier::virtual_controller
