#include "metier/virtual_controller/controller.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <sstream>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "metier/virtual_controller/cycle_timer.hpp"
#include "metier/virtual_controller/tcp_server.hpp"
#include "sensor.hpp"
#include "udp_port.hpp"
#include "web.hpp"

namespace metier::virtual_netft {
namespace {

using namespace virtual_controller;

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

constexpr std::size_t kLongestWebRequest = 8192;

Unit readUnit(const cell::Settings& settings, std::string_view name, std::span<const Unit> units) {
    const auto wanted = settings.textOr(name, std::string(units.front().name));
    const auto found = std::ranges::find(units, wanted, &Unit::name);
    if (found != units.end()) {
        return *found;
    }
    settings.reject(name, fmt::format("\"{}\" is no unit that the sensor has", wanted));
    return units.front();
}

/// The records have a whole part of the samples' rate: the next one that is not below `rate`.
int samplesPerRecord(double rate) {
    return std::max(1, static_cast<int>(kSampleRate / rate));
}

std::chrono::nanoseconds period(int samples_per_record) {
    return std::chrono::nanoseconds(std::llround(1e9 * samples_per_record / kSampleRate));
}

Options readOptions(const cell::Settings& settings) {
    Options options;
    auto& calibration = options.calibration;
    options.port = static_cast<std::uint16_t>(settings.numberOr("port", 49152, 0, 65535));
    options.http_port = static_cast<std::uint16_t>(settings.numberOr("http_port", 0, 0, 65535));
    options.rate = settings.numberOr("rate", options.rate, 1.0, kSampleRate);
    options.buffer_size = static_cast<int>(settings.numberOr("buffer_size", 5, 1, 40));
    options.product = settings.textOr("product", "Net F/T");
    calibration.force_unit = readUnit(settings, "force_unit", kForceUnits);
    calibration.torque_unit = readUnit(settings, "torque_unit", kTorqueUnits);
    calibration.counts_per_force = settings.numberOr("counts_per_force", 1e6, 1.0, 1e9);
    calibration.counts_per_torque = settings.numberOr("counts_per_torque", 1e6, 1.0, 1e9);
    calibration.force_noise = settings.numberOr("force_noise", 0.0, 0.0, 100.0);
    calibration.torque_noise = settings.numberOr("torque_noise", 0.0, 0.0, 100.0);
    const auto range = settings.numbersOr(
        "range", {calibration.range.begin(), calibration.range.end()}, calibration.range.size());
    if (std::ranges::any_of(range, [](double limit) { return !(limit > 0.0); })) {
        settings.reject("range", "each limit must be over 0 N or Nm");
    }
    std::copy_n(range.begin(), std::min(range.size(), calibration.range.size()),
                calibration.range.begin());
    return options;
}

/// "fx fy fz tx ty tz"; an empty text is no load.
Result<motion::Wrench> parseWrench(const std::string& text) {
    std::istringstream in(text);
    std::array<double, 6> values{};
    std::size_t count = 0;
    for (double value = 0.0; count < values.size() && in >> value; ++count) {
        values[count] = value;
    }
    if ((count != 0 && count != values.size()) || !(in >> std::ws).eof()) {
        return fail(Errc::invalid_argument,
                    fmt::format("\"{}\" is not three forces [N] and three torques [Nm]", text));
    }
    return motion::Wrench{{values[0], values[1], values[2]}, {values[3], values[4], values[5]}};
}

Result<std::uint32_t> parseNumber(std::string_view text, int base) {
    if (base == 16 && text.starts_with("0x")) {
        text.remove_prefix(2);
    }
    std::uint32_t number = 0;
    const auto* end = text.data() + text.size();
    const auto [stopped, error] = std::from_chars(text.data(), end, number, base);
    if (error != std::errc{} || stopped != end) {
        return fail(Errc::invalid_argument,
                    fmt::format("\"{}\" is no number of base {}", text, base));
    }
    return number;
}

/// A Net F/T: sends records over UDP to the client that asked last, and serves its web pages.
class NetFtController final : public Controller {
public:
    NetFtController(const ControllerRequest& request, Options options);
    /// Errors: those of UdpPort::bind() and TcpServer::listen().
    Result<void> open(const ControllerRequest& request);

    std::vector<InjectionHelp> injections() const override { return injections_; }
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

    std::vector<InjectionHelp> makeInjections();
    Result<void> openWeb(const ControllerRequest& request);
    void handle(const UdpPort::Endpoint& from, const Request& request);
    void serveWeb(TcpPeer& peer, std::span<const std::byte> bytes);
    void apply(const Change& change);
    int rate() const noexcept { return kSampleRate / samples_per_record_; }
    void cycle();
    void stream(const Sensor::Reading& reading);

    const Options options_;
    const std::string address_;
    const std::vector<InjectionHelp> injections_ = makeInjections();
    int samples_per_record_;  // the rate of the records
    WebPages pages_;          // with the settings that a web client can change
    WorldLink& world_;
    std::optional<Sensor> sensor_;
    motion::Wrench extra_load_;
    std::uint32_t ft_sequence_ = 0;  // the sensor's own samples
    std::uint32_t records_to_lose_ = 0;
    std::optional<Stream> stream_;
    std::unique_ptr<UdpPort> udp_;
    std::unique_ptr<TcpServer> web_;
    std::map<const TcpPeer*, std::string> web_requests_;
    CycleTimer timer_;
};

NetFtController::NetFtController(const ControllerRequest& request, Options options)
    : options_(std::move(options)),
      address_(request.address),
      samples_per_record_(samplesPerRecord(options_.rate)),
      pages_{.product = options_.product,
             .address = address_,
             .calibration = options_.calibration,
             .buffer_size = options_.buffer_size},
      world_(request.world),
      sensor_(options_.calibration),
      timer_(request.context, period(samples_per_record_), [this] { cycle(); }) {}

Result<void> NetFtController::open(const ControllerRequest& request) {
    METIER_ASSIGN(const auto address, parseAddress(request.address));
    METIER_ASSIGN(udp_, UdpPort::bind(request.context, {address, options_.port}, request.faults,
                                      [this](const UdpPort::Endpoint& from,
                                             std::span<const std::byte> datagram) {
                                          const auto parsed = parseRequest(datagram);
                                          if (parsed && pages_.rdt_enabled) {
                                              handle(from, *parsed);
                                          }
                                      }));
    return options_.http_port == 0 ? Result<void>() : openWeb(request);
}

// ---- web pages ---------------------------------------------------------------------------------

Result<void> NetFtController::openWeb(const ControllerRequest& request) {
    return TcpServer::listen(
               request.context, {request.address, options_.http_port}, request.faults,
               {.on_connected = {},
                .on_data = [this](TcpPeer& peer,
                                  std::span<const std::byte> bytes) { serveWeb(peer, bytes); },
                .on_closed = [this](TcpPeer& peer) { web_requests_.erase(&peer); }})
        .map([this](auto web) { web_ = std::move(web); });
}

void NetFtController::serveWeb(TcpPeer& peer, std::span<const std::byte> bytes) {
    auto& request = web_requests_[&peer];
    if (request.size() > kLongestWebRequest) {
        return;  // already answered
    }
    for (const std::byte byte : bytes) {
        request += static_cast<char>(byte);
    }
    if (request.find("\r\n\r\n") != std::string::npos || request.size() > kLongestWebRequest) {
        pages_.gauge_bias = sensor_->gaugeBias();
        pages_.rate = rate();
        const auto answer = answerWeb(request, pages_);
        std::ranges::for_each(answer.changes, [this](const Change& change) { apply(change); });
        peer.send(answer.text);
        peer.close();
        request.resize(kLongestWebRequest + 1);
    }
}

void NetFtController::apply(const Change& change) {
    switch (change.setting) {
        case Setting::rate:
            samples_per_record_ = samplesPerRecord(change.value);
            timer_.setPeriod(period(samples_per_record_));
            break;
        case Setting::buffer_size:
            pages_.buffer_size = change.value;
            break;
        case Setting::rdt_enabled:
            pages_.rdt_enabled = change.value != 0;
            if (!pages_.rdt_enabled) {
                stream_.reset();
            }
            break;
        case Setting::filter:
            pages_.filter = change.value;
            break;
        case Setting::gauge_bias:
            sensor_->setGaugeBias(change.gauge, change.value);
            break;
    }
}

// ---- records -----------------------------------------------------------------------------------

void NetFtController::handle(const UdpPort::Endpoint& from, const Request& request) {
    switch (request.command) {
        case Command::start_real_time:
        case Command::start_buffered:
        case Command::start_multi_unit: {
            const bool buffered = request.command == Command::start_buffered;
            const auto size = static_cast<std::uint32_t>(buffered ? pages_.buffer_size : 1);
            stream_ = Stream{from, size, request.sample_count};
            break;
        }
        case Command::stop:
            stream_.reset();
            break;
        case Command::reset_latch:
            sensor_->resetLatch();
            break;
        case Command::set_bias:
            sensor_->setBias();
            break;
    }
}

void NetFtController::cycle() {
    ft_sequence_ += static_cast<std::uint32_t>(samples_per_record_);
    world_.report({});  // asks for the newest effect
    motion::Wrench load = world_.effect().wrench;
    load.force += extra_load_.force;
    load.torque += extra_load_.torque;
    pages_.reading = sensor_->read(load);
    if (stream_) {
        stream(pages_.reading);
    }
}

void NetFtController::stream(const Sensor::Reading& reading) {
    auto& to = *stream_;
    ++to.sent;
    const bool end = to.left != 0 && to.sent == to.left;
    if (records_to_lose_ > 0) {
        --records_to_lose_;
    } else {
        append(to.datagram, {to.sent, ft_sequence_, reading.status, reading.counts});
    }
    if (end || to.sent % to.records_per_datagram == 0) {
        udp_->send(to.to, std::exchange(to.datagram, {}));
    }
    if (end) {
        stream_.reset();
    }
}

// ---- what people and accidents do --------------------------------------------------------------

void NetFtController::restart() {
    sensor_.emplace(options_.calibration);
    stream_.reset();
    extra_load_ = {};
    records_to_lose_ = 0;
    ft_sequence_ = 0;
    if (web_) {
        web_->resetAll();
    }
}

std::vector<InjectionHelp> NetFtController::makeInjections() {
    const auto status_is = [this](std::uint32_t word) {
        return always([this, word] { sensor_->setStatus(word); });
    };
    return {
        {"status", "the status word, as 80020000 (hexadecimal)",
         [this](const std::string& value) {
             return parseNumber(value, 16).map([this](auto word) { sensor_->setStatus(word); });
         }},
        {"wrench", "a load besides the world's: fx fy fz tx ty tz [N], [Nm]; empty: none",
         [this](const std::string& value) {
             return parseWrench(value).map([this](const auto& load) { extra_load_ = load; });
         }},
        {"lose", "so many of the next records get lost",
         [this](const std::string& value) {
             return parseNumber(value, 10).map([this](auto count) { records_to_lose_ = count; });
         }},
        {"ok", "the status word is 0 again", status_is(status::kHealthy)},
        {"saturation", "status word 80020000: a gauge is saturated", status_is(status::kSaturated)},
        {"warning", "status word 80010000 until a client resets the latch",
         status_is(status::kMonitorLatched)},
        {"temperature-fault", "status word 80000004: outside its temperature",
         status_is(status::kTemperature)},
    };
}

nlohmann::ordered_json NetFtController::state() const {
    const auto client = [this] {
        const auto& to = stream_->to;
        return fmt::format("{}:{}", to.address().to_string(), to.port());
    };
    return {
        {"port", udp_->port()},
        {"http_port", web_ ? web_->port() : 0},
        {"rate", rate()},
        {"client", stream_ ? client() : ""},
        {"records", stream_ ? stream_->sent : 0},
        {"status", fmt::format("{:08x}", pages_.reading.status)},
        {"counts", pages_.reading.counts},
    };
}

Result<std::unique_ptr<Controller>> start(const ControllerRequest& request) {
    auto options = readOptions(request.settings);
    METIER_TRY(request.settings.finish());
    auto controller = std::make_unique<NetFtController>(request, std::move(options));
    METIER_TRY(controller->open(request));
    return controller;
}

}  // namespace
}  // namespace metier::virtual_netft

namespace metier::virtual_controller {

ControllerType netftController();
ControllerType netftController() {
    return {"netft", "ATI Net F/T force-torque sensor: RDT over UDP", virtual_netft::start};
}

}  // namespace metier::virtual_controller
