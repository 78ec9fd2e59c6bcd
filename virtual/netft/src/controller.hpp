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
#include "sensor.hpp"
#include "udp_port.hpp"
#include "web.hpp"

namespace metier::virtual_netft {

/// Options from the settings (README.md).
struct Options {
    std::uint16_t port = 49152;
    std::uint16_t http_port = 0;  ///< 0: no web pages
    double rate = 1000.0;         ///< initial rate [1/s]
    int buffer_size = 5;          ///< initial number of records in one datagram of the buffered
                                  ///< mode
    std::string product;
    Calibration calibration;
};

/// A Net F/T: sends records over UDP to the client that asked last, and serves its web pages.
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
        std::uint32_t records_per_datagram = 1;
        std::uint32_t left = 0;  // records; 0: without end
        std::uint32_t sent = 0;
        std::vector<std::byte> datagram{};
    };

    NetFtController(const virtual_controller::ControllerRequest& request, Options options);
    Result<void> open(const virtual_controller::ControllerRequest& request);
    Result<void> openWeb(const virtual_controller::ControllerRequest& request);
    void handle(const UdpPort::Endpoint& from, const Request& request);
    void serveWeb(virtual_controller::TcpPeer& peer, std::span<const std::byte> bytes);
    WebPages pages() const;
    void apply(const Change& change);
    int rate() const noexcept { return kSampleRate / samples_per_record_; }
    void cycle();
    void stream(const Sensor::Reading& reading);

    const Options options_;
    const std::string address_;
    int samples_per_record_;  // the rate of the records
    int buffer_size_;
    bool rdt_enabled_ = true;
    int filter_ = 0;
    virtual_controller::WorldLink& world_;
    std::optional<Sensor> sensor_;
    motion::Wrench extra_load_;
    std::uint32_t ft_sequence_ = 0;  // the sensor's own samples
    std::uint64_t records_to_lose_ = 0;
    Sensor::Reading last_;
    std::optional<Stream> stream_;
    std::unique_ptr<UdpPort> udp_;
    std::unique_ptr<virtual_controller::TcpServer> web_;
    std::map<const virtual_controller::TcpPeer*, std::string> web_requests_;
    virtual_controller::CycleTimer timer_;
};

}  // namespace metier::virtual_netft
