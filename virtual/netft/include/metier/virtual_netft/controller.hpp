#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "metier/virtual_controller/controller.hpp"
#include "metier/virtual_controller/cycle_timer.hpp"
#include "metier/virtual_controller/tcp_server.hpp"
#include "metier/virtual_netft/sensor.hpp"
#include "metier/virtual_netft/udp_port.hpp"

namespace metier::virtual_netft {

/// What the settings say (README.md).
struct Options {
    std::uint16_t port = 49152;
    std::uint16_t http_port = 0;  ///< 0: no web pages
    double rate = 1000.0;         ///< [1/s]
    std::size_t buffer_size = 5;  ///< records in one datagram of the buffered mode
    std::string product;
    Calibration calibration;
};

/// A Net F/T: records over UDP to whoever asked last, and its web pages.
class NetFtController final : public virtual_controller::Controller {
public:
    static Result<std::unique_ptr<NetFtController>> start(
        const virtual_controller::ControllerRequest& request);

    std::vector<virtual_controller::InjectionHelp> injections() const override;
    Result<void> inject(const virtual_controller::Injection& injection) override;
    nlohmann::ordered_json state() const override;
    void restart() override;

private:
    struct Stream {
        UdpPort::Endpoint to;
        std::size_t records_per_datagram = 1;
        std::uint32_t left = 0;  // records; 0: without end
        std::uint32_t sent = 0;
        std::vector<std::byte> datagram{};
    };

    NetFtController(const virtual_controller::ControllerRequest& request, Options options);
    Result<void> open(const virtual_controller::ControllerRequest& request);
    Result<void> openWeb(const virtual_controller::ControllerRequest& request);
    void handle(const UdpPort::Endpoint& from, const Request& request);
    void serveWeb(virtual_controller::TcpPeer& peer, std::span<const std::byte> bytes);
    void cycle();
    void stream(const Sensor::Reading& reading);

    const Options options_;
    virtual_controller::WorldLink& world_;
    std::optional<Sensor> sensor_;
    geometry::Wrench extra_load_;
    std::uint64_t cycles_ = 0;
    std::uint64_t records_to_lose_ = 0;
    Sensor::Reading last_;
    std::optional<Stream> stream_;
    std::unique_ptr<UdpPort> udp_;
    std::unique_ptr<virtual_controller::TcpServer> web_;
    std::map<const virtual_controller::TcpPeer*, std::string> web_requests_;
    virtual_controller::CycleTimer timer_;
};

}  // namespace metier::virtual_netft
