#include "netft_sensor.hpp"

#include <fmt/format.h>

#include <array>
#include <utility>

#include "http_get.hpp"
#include "metier/link/back_off.hpp"

namespace metier::netft_driver {
namespace {

using namespace std::chrono_literals;
using device::Safety;
using device::SafetyState;
using device::WrenchSample;

constexpr auto kPageTimeout = 1s;
constexpr auto kConnectTimeout = 1s;
constexpr auto kFirstRecordTimeout = 100ms;
constexpr int kStartAttempts = 10;
// The buffered mode, which is not asked for, puts up to 40 records into a datagram.
constexpr std::size_t kLargestDatagram = 40 * kRecordSize;

SteadyTime now() {
    return std::chrono::steady_clock::now();
}

}  // namespace

NetftSensor::NetftSensor(NetftOptions options)
    : options_(std::move(options)),
      silence_(silenceAt(kUsualRate)),
      safety_({SafetyState::disconnected, named("not connected yet"), false}),
      notifier_([this] { safety_.dispatch(); }),
      thread_([this](const std::stop_token& stop) { run(stop); }) {}

NetftSensor::~NetftSensor() {
    thread_.request_stop();
    thread_.join();
    lost({Errc::connection_lost, "the driver was shut down"});
}

std::string NetftSensor::named(std::string_view text) const {
    return fmt::format("{}: {}", options_.name, text);
}

WrenchSample NetftSensor::sample() const noexcept {
    auto sample = sample_.read();
    if (now() - sample.stamp > silence_.load()) {
        sample.health = SafetyState::disconnected;
    }
    return sample;
}

Result<void> NetftSensor::tare() {
    const auto safety = safety_.safety();
    if (safety.state != SafetyState::normal) {
        return fail(
            safety.state == SafetyState::disconnected ? Errc::connection_lost : Errc::device_fault,
            safety.text);
    }
    std::future<Result<void>> answer;
    {
        const std::lock_guard lock(tare_mutex_);
        answer = tare_answers_.emplace_back().get_future();
    }
    tare_asked_.store(true);
    if (answer.wait_for(options_.tare_wait) == std::future_status::ready) {
        return answer.get();
    }
    return fail(Errc::timeout,
                named(fmt::format("no end of tare within {:g} s",
                                  std::chrono::duration<double>(options_.tare_wait).count())));
}

void NetftSensor::run(const std::stop_token& stop) {
    link::BackOff back_off;
    while (!stop.stop_requested()) {
        connected_ = false;
        const auto ended = connection(stop);
        if (ended) {
            return;
        }
        lost(ended.error());
        if (connected_) {
            back_off.reset();
        }
        back_off.wait(stop);
    }
}

Result<void> NetftSensor::connection(const std::stop_token& stop) {
    METIER_ASSIGN(const auto scale, calibration());
    METIER_ASSIGN(auto link,
                  link::UdpLink::connect(options_.host, options_.port, now() + kConnectTimeout));
    RecordStream stream(scale);
    auto ended = begin(stop, link, stream).and_then([&] { return follow(stop, link, stream); });
    static_cast<void>(link.send(rdtRequest(RdtCommand::stop)));
    return ended;
}

Result<Calibration> NetftSensor::calibration() {
    if (options_.calibration) {
        setSilence(std::nullopt);
        return *options_.calibration;
    }
    METIER_ASSIGN(const auto text, readPage());
    METIER_ASSIGN(const auto rate, parseRate(text));
    setSilence(rate);
    return parseCalibration(text, options_.units);
}

Result<std::string> NetftSensor::readPage() const {
    const auto deadline = now() + kPageTimeout;
    auto page = httpGet(options_.host, options_.http_port, "/netftapi2.xml", deadline);
    if (!page && page.error().code == Errc::not_found) {
        page = httpGet(options_.host, options_.http_port, "/netftcalapi.xml", deadline);
    }
    return page;
}

void NetftSensor::setSilence(std::optional<double> reported_rate) noexcept {
    const double rate = options_.rate ? *options_.rate : reported_rate.value_or(kUsualRate);
    silence_.store(options_.silence ? *options_.silence : silenceAt(rate));
}

Result<void> NetftSensor::begin(const std::stop_token& stop, link::UdpLink& link,
                                RecordStream& stream) {
    std::array<std::byte, kLargestDatagram> buffer{};
    for (int attempt = 0; attempt < kStartAttempts && !stop.stop_requested(); ++attempt) {
        METIER_TRY(link.send(rdtRequest(RdtCommand::real_time)));
        const auto count = link.receive(buffer, now() + kFirstRecordTimeout);
        if (!count && count.error().code != Errc::timeout) {
            return fail(count.error());
        }
        const auto sample =
            count ? stream.take(std::span(buffer).first(*count), now()) : std::nullopt;
        if (sample) {
            connected_ = true;
            status_ = ~stream.status();  // differs from the status, so that the status is reported
            take(*sample, stream);
            return {};
        }
    }
    return fail(Errc::timeout,
                fmt::format("{}: no record after {} requests", link.peer(), kStartAttempts));
}

Result<void> NetftSensor::follow(const std::stop_token& stop, link::UdpLink& link,
                                 RecordStream& stream) {
    std::array<std::byte, kLargestDatagram> buffer{};
    const auto silence = silence_.load();
    auto last = now();
    while (!stop.stop_requested()) {
        const auto count = link.receive(buffer, last + silence);
        if (!count && count.error().code != Errc::timeout) {
            return fail(count.error());
        }
        const auto sample =
            count ? stream.take(std::span(buffer).first(*count), now()) : std::nullopt;
        if (sample) {
            last = sample->stamp;
            take(*sample, stream);
            METIER_TRY(workOnTare(link, *sample));
        } else if (now() >= last + silence) {
            return fail(Errc::timeout,
                        fmt::format("{}: no record for {} ms", link.peer(), silence.count()));
        }
    }
    return {};
}

void NetftSensor::take(const WrenchSample& sample, const RecordStream& stream) {
    sample_.write(sample);
    if (stream.status() == status_) {
        return;
    }
    status_ = stream.status();
    safety_.set(sample.health == SafetyState::normal
                    ? Safety{}
                    : Safety{SafetyState::fault, named(describeStatus(status_)), false});
    notifier_.signal();
}

/// Errors: the request cannot be sent.
Result<void> NetftSensor::workOnTare(link::UdpLink& link, const WrenchSample& sample) {
    if (tare_asked_.exchange(false) && !tare_) {
        tare_.emplace(sample.stamp);
    }
    if (!tare_) {
        return {};
    }
    if (tare_->toSend(sample.stamp)) {
        return link.send(rdtRequest(RdtCommand::bias));
    }
    if (const auto outcome = tare_->take(sample, sample.stamp)) {
        endTare(*outcome ? *outcome : fail(outcome->error().code, named(outcome->error().message)));
    }
    return {};
}

void NetftSensor::endTare(const Result<void>& outcome) {
    tare_.reset();
    std::vector<std::promise<Result<void>>> answered;
    {
        const std::lock_guard lock(tare_mutex_);
        answered.swap(tare_answers_);
    }
    for (auto& answer : answered) {
        answer.set_value(outcome);
    }
}

void NetftSensor::lost(const Error& why) {
    const auto text = named(why.message);
    auto sample = sample_.read();
    sample.health = SafetyState::disconnected;
    sample_.write(sample);
    safety_.set({SafetyState::disconnected, text, false});
    tare_asked_.store(false);
    endTare(fail(Errc::connection_lost, text));
    notifier_.signal();
}

}  // namespace metier::netft_driver
