#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "gripper.hpp"
#include "metier/virtual_controller/controller.hpp"
#include "metier/virtual_controller/cycle_timer.hpp"
#include "metier/virtual_controller/tcp_server.hpp"
#include "session.hpp"

namespace metier::virtual_wsg50 {

/// Options from the settings (README.md).
struct Options {
    std::uint16_t port = 1000;
    Capability capability;
    Identity identity;
    double part_width = 0.0;  ///< [m]; 0: only what the world has
    bool fast_stop_on_disconnect = true;
};

/// A WSG 50 on its TCP port, for one client.
class WsgController final : public virtual_controller::Controller {
public:
    static Result<std::unique_ptr<WsgController>> start(
        const virtual_controller::ControllerRequest& request);

    std::vector<virtual_controller::InjectionHelp> injections() const override;
    Result<void> inject(const virtual_controller::Injection& injection) override;
    nlohmann::ordered_json state() const override;
    void restart() override;

private:
    WsgController(const virtual_controller::ControllerRequest& request, Options options);

    void switchOn();
    Result<void> listen(const virtual_controller::ControllerRequest& request);
    void connected(virtual_controller::TcpPeer& peer);
    void closed(const virtual_controller::TcpPeer& peer);
    std::optional<double> partWidth();
    void cycle();

    const Options options_;
    virtual_controller::WorldLink& world_;
    Identity identity_;
    double part_width_ = 0.0;   // [m]; 0: none of its own
    double block_width_ = 0.0;  // [m]; 0: nothing is in the way
    bool part_slipped_ = false;
    std::optional<Gripper> gripper_;
    virtual_controller::TcpPeer* client_ = nullptr;
    std::optional<Session> session_;
    std::unique_ptr<virtual_controller::TcpServer> server_;
    virtual_controller::CycleTimer timer_;
};

}  // namespace metier::virtual_wsg50
