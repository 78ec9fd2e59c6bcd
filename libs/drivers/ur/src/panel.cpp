#include "panel.hpp"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <array>
#include <chrono>
#include <span>
#include <string>
#include <utility>

namespace metier::ur_driver {

using namespace std::chrono_literals;

namespace {

constexpr auto kUploadTimeout = 2s;
constexpr auto kRemoteCheckTimeout = 500ms;
constexpr auto kScriptLinkLife = 2s;
constexpr auto kSlice = 5ms;  // time after which a new job or the end is noticed

}  // namespace

Panel::Panel(Parts parts, DashboardReset::Peer peer, const UrSettings& settings)
    : parts_(std::move(parts)),
      peer_(std::move(peer)),
      settings_(settings),
      dashboard_reset_(peer_, settings, parts_.newest, parts_.reporter),
      thread_([this](const std::stop_token& stop) { run(stop); }) {}

void Panel::run(const std::stop_token& stop) {
    while (!stop.stop_requested()) {
        const auto now = std::chrono::steady_clock::now();
        if (auto job = parts_.jobs.popUntil(script_link_ ? now : now + kSlice)) {
            handle(*job);
        }
        if (parts_.resets.taken()) {
            parts_.resets.answer(dashboard_reset_.run(stop));
        }
        drain();
    }
}

void Panel::handle(const PanelJob& job) {
    switch (job.kind) {
        case PanelJob::Kind::upload:
            if (const auto uploaded = upload(job.token); !uploaded) {
                parts_.reporter.latch(
                    "the script could not be uploaded: " + uploaded.error().message,
                    std::chrono::steady_clock::now());
                parts_.refused(job.token);
            }
            break;
        case PanelJob::Kind::stop_program:
            if (const auto stopped = dashboard_reset_.stopProgram(); !stopped) {
                spdlog::warn("{}", stopped.error().message);
            }
            break;
    }
}

Result<void> Panel::upload(std::int32_t token) {
    METIER_TRY(checkRemoteControl());
    script_link_.reset();
    const auto now = std::chrono::steady_clock::now();
    METIER_ASSIGN(auto link, link::TcpLink::connect(peer_.host, settings_.secondary_port,
                                                    now + kUploadTimeout));
    const std::string script = servojScript(settings_, token);
    METIER_TRY(link.send(std::as_bytes(std::span(script)), now + kUploadTimeout));
    script_link_ = std::move(link);
    close_script_link_ = now + kScriptLinkLife;
    return {};
}

Result<void> Panel::checkRemoteControl() const {
    const auto deadline = std::chrono::steady_clock::now() + kRemoteCheckTimeout;
    auto client = dashboard::Client::connect(peer_.host, settings_.dashboard_port, deadline);
    if (!client) {
        return {};  // the script itself shows whether it may run
    }
    const auto reply = client->ask("is in remote control", deadline);
    if (reply) {
        const auto remote = dashboard::parseFlag(*reply);  // CB3 does not know the question
        if (remote && !*remote) {
            return fail(Errc::device_fault,
                        "the controller is in local control: switch it to remote control");
        }
    }
    return {};
}

void Panel::drain() {
    if (!script_link_) {
        return;
    }
    std::array<std::byte, 4096> ignored{};
    const auto now = std::chrono::steady_clock::now();
    const auto count = script_link_->receive(ignored, now + kSlice);
    if ((!count && count.error().code != Errc::timeout) || now > close_script_link_) {
        script_link_.reset();
    }
}

}  // namespace metier::ur_driver
