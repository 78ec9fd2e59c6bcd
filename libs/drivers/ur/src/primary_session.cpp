#include "primary_session.hpp"

#include <chrono>
#include <utility>

#include "metier/link/back_off.hpp"

namespace metier::ur_driver {

namespace {

constexpr std::chrono::seconds kPrimaryConnectTimeout{1};
// The stream has ten packages per second: a connection that is silent for so long is dead.
constexpr std::chrono::seconds kSilence{2};
// Time after which a waiting monitor notices that it must end.
constexpr std::chrono::milliseconds kReceiveSlice{100};

}  // namespace

PrimarySession::PrimarySession(link::TcpLink link)
    : link_(std::move(link)), buffer_(2 * primary::kMaxPackageSize + 2) {}

Result<PrimarySession> PrimarySession::connect(const std::string& host, std::uint16_t port,
                                               SteadyTime deadline) {
    METIER_ASSIGN(auto link, link::TcpLink::connect(host, port, deadline));
    return PrimarySession(std::move(link));
}

Result<primary::Package> PrimarySession::next(SteadyTime deadline) {
    for (;;) {
        const auto size = primary::firstPackageSize(buffer_);
        if (!size) {
            return fail(size.error().code, link_.peer() + ": " + size.error().message);
        }
        if (*size) {
            auto package = primary::parse(buffer_.received().first(**size));
            buffer_.consume(**size);
            if (!package) {
                return fail(package.error().code, link_.peer() + ": " + package.error().message);
            }
            return package;
        }
        METIER_ASSIGN(const auto count, link_.receive(buffer_.space(), deadline));
        buffer_.filled(count);
    }
}

void ControllerDescription::take(const primary::Package& package) {
    if (package.version) {
        version = package.version;
    }
    if (package.kinematics) {
        kinematics = package.kinematics;
    }
    if (package.configuration) {
        configuration = package.configuration;
    }
}

Result<ControllerDescription> readDescription(const std::string& host, std::uint16_t port,
                                              SteadyTime deadline) {
    METIER_ASSIGN(auto session, PrimarySession::connect(host, port, deadline));
    ControllerDescription description;
    while (!description.complete() && std::chrono::steady_clock::now() < deadline) {
        const auto package = session.next(deadline);
        if (!package && !description.version && !description.kinematics) {
            return fail(package.error());
        }
        if (!package) {
            break;
        }
        description.take(*package);
    }
    return description;
}

PrimaryMonitor::PrimaryMonitor(std::string host, std::uint16_t port, Handler handler)
    : host_(std::move(host)),
      port_(port),
      handler_(std::move(handler)),
      thread_([this](const std::stop_token& stop) { run(stop); }) {}

void PrimaryMonitor::run(const std::stop_token& stop) {
    link::BackOff back_off;
    while (!stop.stop_requested()) {
        auto session = PrimarySession::connect(
            host_, port_, std::chrono::steady_clock::now() + kPrimaryConnectTimeout);
        if (session) {
            back_off.reset();
            listen(*session, stop);
        }
        back_off.wait(stop);
    }
}

void PrimaryMonitor::listen(PrimarySession& session, const std::stop_token& stop) {
    auto last = std::chrono::steady_clock::now();
    while (!stop.stop_requested()) {
        const auto package = session.next(std::chrono::steady_clock::now() + kReceiveSlice);
        const auto now = std::chrono::steady_clock::now();
        if (package) {
            last = now;
            handler_(*package);
        } else if (package.error().code != Errc::timeout || now > last + kSilence) {
            return;
        }
    }
}

}  // namespace metier::ur_driver
