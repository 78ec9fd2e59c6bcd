// A session that hears whatever a robot may say, as text or as known messages with any numbers,
// while the time goes on and sources move the arm.
#include <spdlog/spdlog.h>

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <memory>
#include <string>
#include <string_view>

#include "../tests/session_bench.hpp"
#include "input.hpp"

namespace {

using namespace metier;
using namespace metier::edo_driver;
using fuzz::Input;

/// Messages in which % stands for a number and @ for the id of the last call.
constexpr std::array<std::string_view, 9> kMessages{
    R"({"topic":"/usb_jnt_state","msg":{"joints_mask":127,"joints":[{"position":%},{"position":%},)"
    R"({"position":%},{"position":0},{"position":80},{"position":0},{"position":%}]},"op":"publish"})",
    R"({"topic":"/usb_jnt_state","msg":{"joints":[{"position":null},{"velocity":%}]},"op":"publish"})",
    R"({"topic":"/machine_state","msg":{"current_state":%,"opcode":%},"op":"publish"})",
    R"({"topic":"/algorithm_state","msg":{"data":%},"op":"publish"})",
    R"({"topic":"/machine_movement_ack","msg":{"type":%,"data":-%},"op":"publish"})",
    R"({"topic":"/machine_movement_ack","msg":{"type":-%,"data":%},"op":"publish"})",
    R"({"op":"service_response","id":"@","result":true,"values":{"result":%}})",
    R"({"op":"service_response","id":"@","result":false,"values":"%"})",
    R"({"op":"status","level":"error","msg":"%"})",
};

/// Keeps the id of the last call; every text that leaves must be well-formed so far that a
/// set-point holds no "nan" or "inf".
class Robot final : public Wire {
public:
    void send(std::string_view text) noexcept override {
        constexpr std::string_view kId = R"("id":")";
        if (text.find("nan") != std::string_view::npos ||
            text.find("inf") != std::string_view::npos) {
            std::abort();
        }
        if (const auto at = text.find(kId); at != std::string_view::npos) {
            const auto rest = text.substr(at + kId.size());
            last_id = rest.substr(0, rest.find('"'));
        }
    }

    std::string last_id;
};

std::string softwareText(const char* version, const std::string& id) {
    return R"({"op":"service_response","id":")" + id +
           R"(","result":true,"values":{"version":{"nodes":[{"id":255,"version":")" + version +
           R"("}]},"tool_id":1}})";
}

std::string messageFrom(Input& input, std::string_view pattern, const std::string& id) {
    std::string message;
    for (const char character : pattern) {
        if (character == '%') {
            message += std::to_string(input.next());
        } else if (character == '@') {
            message += id;
        } else {
            message += character;
        }
    }
    return message;
}

std::string textFrom(Input& input) {
    std::string text;
    for (auto left = input.next(); left > 0 && !input.isEmpty(); --left) {
        text += static_cast<char>(input.next());
    }
    return text;
}

/// One session over some messages.
class Dialogue {
public:
    explicit Dialogue(const char* version) {
        session_.linkUp(now_, robot_);
        session_.onText(softwareText(version, robot_.last_id), now_, robot_);
    }

    void hear(Input& input) {
        const auto choice = input.next();
        const auto kind = choice % (kMessages.size() + 3);
        if (kind < kMessages.size()) {
            session_.onText(messageFrom(input, kMessages.at(kind), robot_.last_id), now_, robot_);
        } else if (kind == kMessages.size()) {
            session_.onText(textFrom(input), now_, robot_);
        } else if (kind == kMessages.size() + 1) {
            attach(input.next());
        } else {
            now_ += std::chrono::milliseconds(input.next());
        }
        tick();
    }

    void end() {
        core_.stop();
        session_.close();
        tick();
        session_.linkDown("over");
        core_.dispatch();
    }

private:
    void attach(std::uint8_t speed) {
        static_cast<void>(
            core_.attach(std::make_shared<edo_driver::testing::Stepper>(speed * 1e-5, speed)));
    }

    void tick() {
        now_ += std::chrono::milliseconds(10);
        static_cast<void>(session_.tick(now_, robot_));
        core_.dispatch();
        session_.gripperSlot().dispatch();
        for (const double position : core_.state().commanded_position) {
            if (!std::isfinite(position)) {
                std::abort();
            }
        }
    }

    static const EdoOptions& options() {
        static const auto kOptions = edo_driver::testing::benchOptions();
        return kOptions;
    }

    SteadyTime now_{std::chrono::seconds(1000)};
    device::ArmCore core_{{options().name, options().axis_names, EdoOptions::kCycle}};
    Robot robot_;
    edo_driver::Session session_{options(), core_};
};

}  // namespace

/// The first byte chooses the release of the robot's software.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    constexpr int kMostMessages = 40;
    spdlog::set_level(spdlog::level::off);
    Input input(data, size);
    Dialogue dialogue(input.next() % 2 == 0 ? edo_driver::testing::kClassic
                                            : edo_driver::testing::kExternal);
    for (int count = 0; count < kMostMessages && !input.isEmpty(); ++count) {
        dialogue.hear(input);
    }
    dialogue.end();
    return 0;
}
