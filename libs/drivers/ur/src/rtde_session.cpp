#include "rtde_session.hpp"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <utility>

namespace metier::ur_driver {

using rtde::PackageType;

namespace {

constexpr double kHighestFrequencyCb3 = 125.0;  // [Hz]
constexpr double kHighestFrequency = 500.0;     // [Hz], since major version 5
constexpr std::uint32_t kFirstRtdeOfESeries = 5;

}  // namespace

RtdeSession::RtdeSession(link::TcpLink link, std::int32_t register_base)
    : link_(std::move(link)), buffer_(2 * rtde::kMaxPackageSize + 2), outputs_(register_base) {}

Result<RtdeSession> RtdeSession::open(const RtdeRequest& request, SteadyTime deadline) {
    METIER_ASSIGN(auto link, link::TcpLink::connect(request.host, request.port, deadline));
    RtdeSession session(std::move(link), request.register_base);
    if (auto agreed = session.negotiate(request, deadline); !agreed) {
        return fail(session.atPeer(agreed.error()));
    }
    return session;
}

Result<void> RtdeSession::negotiate(const RtdeRequest& request, SteadyTime deadline) {
    METIER_ASSIGN(const bool accepted,
                  ask(rtde::requestProtocolVersion(), deadline).and_then(rtde::parseAccepted));
    if (!accepted) {
        return fail(Errc::not_supported, "the controller does not speak version 2 of RTDE");
    }
    METIER_ASSIGN(const auto version,
                  ask(rtde::request(PackageType::get_controller_version), deadline)
                      .and_then(rtde::parseControllerVersion));
    const double highest =
        version.major < kFirstRtdeOfESeries ? kHighestFrequencyCb3 : kHighestFrequency;
    if (request.frequency > highest) {
        return fail(Errc::not_supported,
                    fmt::format("software {}.{} gives at most {} Hz, asked for are {} Hz: set "
                                "frequency",
                                version.major, version.minor, highest, request.frequency));
    }
    METIER_TRY(setUpOutputs(request.frequency, deadline));
    METIER_TRY(setUpInputs(request.register_base, deadline));
    METIER_TRY(write({}, deadline));
    METIER_ASSIGN(const bool started,
                  ask(rtde::request(PackageType::start), deadline).and_then(rtde::parseAccepted));
    if (!started) {
        return fail(Errc::not_supported, "the controller does not start RTDE");
    }
    return {};
}

Result<void> RtdeSession::setUpOutputs(double frequency, SteadyTime deadline) {
    for (;;) {
        METIER_ASSIGN(const bool in_force,
                      ask(rtde::setupOutputs(frequency, outputs_.names()), deadline)
                          .and_then(rtde::parseRecipeReply)
                          .and_then([this](const auto& reply) { return outputs_.take(reply); }));
        if (in_force) {
            return {};
        }
    }
}

Result<void> RtdeSession::setUpInputs(std::int32_t register_base, SteadyTime deadline) {
    METIER_ASSIGN(const auto reply,
                  ask(rtde::setupInputs(rtde::setpointNames(register_base)), deadline)
                      .and_then(rtde::parseRecipeReply));
    input_recipe_ = reply.id;
    return rtde::checkSetpointReply(reply, register_base);
}

Result<rtde::Bytes> RtdeSession::ask(const rtde::Bytes& request, SteadyTime deadline) {
    METIER_TRY(link_.send(request, deadline));
    const auto wanted = static_cast<PackageType>(request[2]);
    METIER_ASSIGN(const auto package, nextPackage(deadline));
    if (package.type != wanted) {
        return fail(Errc::invalid_argument,
                    fmt::format("RTDE answered '{:c}' with package {}", static_cast<char>(wanted),
                                static_cast<int>(package.type)));
    }
    return rtde::Bytes(package.payload.begin(), package.payload.end());
}

Result<rtde::Package> RtdeSession::nextPackage(SteadyTime deadline) {
    for (;;) {
        buffer_.consume(std::exchange(to_consume_, 0));
        METIER_ASSIGN(const auto package, rtde::firstPackage(buffer_));
        if (package.has_value()) {
            to_consume_ = rtde::kHeaderSize + package->payload.size();
            if (package->type != PackageType::text_message) {
                return *package;
            }
            tell(*package);
            if (std::chrono::steady_clock::now() >= deadline) {
                return fail(Errc::timeout, "RTDE sends nothing but text messages");
            }
            continue;
        }
        METIER_ASSIGN(const auto count, link_.receive(buffer_.space(), deadline));
        buffer_.filled(count);
    }
}

void RtdeSession::tell(const rtde::Package& message) const {
    const auto text = rtde::parseTextMessage(message.payload);
    if (!text) {
        spdlog::warn("{}: {}", link_.peer(), text.error().message);
    } else if (text->level <= rtde::TextMessage::Level::warning) {
        spdlog::warn("{}: {}: {}", link_.peer(), text->source, text->message);
    }
}

Result<ControllerState> RtdeSession::next(SteadyTime deadline) {
    for (;;) {
        const auto package = nextPackage(deadline);
        if (!package) {
            return fail(atPeer(package.error()));
        }
        if (package->type == PackageType::data) {
            auto state = outputs_.decode(package->payload);
            if (!state) {
                return fail(atPeer(state.error()));
            }
            return state;
        }
        if (std::chrono::steady_clock::now() >= deadline) {
            return fail(Errc::timeout, link_.peer() + ": RTDE sends no data");
        }
    }
}

Result<void> RtdeSession::write(const rtde::Setpoint& setpoint, SteadyTime deadline) {
    return link_.send(rtde::setpointPackage(input_recipe_, setpoint), deadline);
}

void RtdeSession::end(SteadyTime deadline) {
    if (write({}, deadline)) {
        (void)link_.send(rtde::request(PackageType::pause), deadline);
    }
}

Error RtdeSession::atPeer(Error error) const {
    if (error.message.find(link_.peer()) == std::string::npos) {
        error.message = link_.peer() + ": " + error.message;
    }
    return error;
}

}  // namespace metier::ur_driver
