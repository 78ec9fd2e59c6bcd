// A controller at the other end of a real connection: it agrees on RTDE as it should, as far as the
// input says, then sends any packages, and hangs up. Every number that comes through is finite.
#include <spdlog/spdlog.h>
#include <sys/socket.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <map>
#include <span>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

#include "metier/link/tcp_link.hpp"
#include "rtde_session.hpp"

namespace {

using namespace metier;
using namespace metier::ur_driver;

constexpr std::int32_t kRegisterBase = 24;
constexpr std::size_t kDataSize = 400;

using Bytes = std::vector<std::byte>;

void add(Bytes& stream, char type, std::string_view payload) {
    const auto size = payload.size() + rtde::kHeaderSize;
    for (const auto octet : {size >> 8U, size & 0xFFU}) {
        stream.push_back(static_cast<std::byte>(octet));
    }
    stream.push_back(static_cast<std::byte>(type));
    for (const char character : payload) {
        stream.push_back(static_cast<std::byte>(character));
    }
}

/// Types of the variables of the recipe.
std::string outputTypes() {
    static const std::map<std::string, std::string, std::less<>> others{
        {"timestamp", "DOUBLE"},
        {"speed_scaling", "DOUBLE"},
        {"target_speed_fraction", "DOUBLE"},
        {"robot_mode", "INT32"},
        {"safety_mode", "INT32"},
        {"safety_status", "INT32"},
        {"runtime_state", "UINT32"},
        {"script_control_line", "UINT32"}};
    std::string types(1, '\1');
    for (const auto& name : rtde::OutputRecipe(kRegisterBase).names()) {
        const auto other = others.find(name);
        const bool is_register = name.find("register") != std::string::npos;
        types += other != others.end() ? other->second : is_register ? "INT32" : "VECTOR6D";
        types += ',';
    }
    types.pop_back();
    return types;
}

std::string inputTypes() {
    return "\1INT32,INT32,DOUBLE,DOUBLE,DOUBLE,DOUBLE,DOUBLE,DOUBLE";
}

/// The answers of a controller that agrees.
Bytes agreement() {
    Bytes stream;
    add(stream, 'V', "\1");
    add(stream, 'v', std::string("\0\0\0\3\0\0\0\xf\0\0\0\0\0\0\0\0", 16));
    add(stream, 'O', outputTypes());
    add(stream, 'I', inputTypes());
    add(stream, 'S', "\1");
    return stream;
}

/// Then: a type and a length each, whose data repeat the rest of the input.
void addPackages(Bytes& stream, std::span<const std::uint8_t> input) {
    constexpr std::string_view some_types = "UUUUUMVSI?";
    while (input.size() >= 3) {
        std::string payload(input[1] % 4 == 0 ? input[2] : kDataSize, '\0');
        for (std::size_t i = 0; i < payload.size(); i += 1U + input[1] % 64U) {
            payload[i] = static_cast<char>(input[i % input.size()]);
        }
        if (!payload.empty()) {
            payload[0] = '\1';
        }
        add(stream, some_types[input[0] % some_types.size()], payload);
        input = input.subspan(3);
    }
}

void check(const ControllerState& state) {
    const auto isFinite = [](double value) { return std::isfinite(value); };
    if (!std::all_of(state.actual_q.begin(), state.actual_q.end(), isFinite) ||
        !std::all_of(state.target_q.begin(), state.target_q.end(), isFinite) ||
        !std::isfinite(state.speed_scaling)) {
        std::abort();
    }
}

/// \param agrees whether the controller does as it should until data flow
void converse(std::uint16_t port, bool agrees) {
    const auto deadline = std::chrono::steady_clock::now() + std::chrono::seconds(5);
    auto session = RtdeSession::open({"127.0.0.1", port, 125.0, kRegisterBase}, deadline);
    if (!session) {
        return agrees || session.error().message.empty() ? std::abort() : void();
    }
    while (const auto state = session->next(deadline)) {
        check(*state);
        if (!session->write({}, deadline)) {
            break;
        }
    }
    session->end(deadline);
    if (std::chrono::steady_clock::now() >= deadline) {
        std::abort();
    }
}

}  // namespace

/// The first three bytes change the agreement: how many bytes of it, from where, and how.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    spdlog::set_level(spdlog::level::off);
    static auto listener = link::TcpListener::listen("127.0.0.1", 0).value();
    static const auto whole_agreement = agreement();
    if (size < 4) {
        return 0;
    }
    auto stream = whole_agreement;
    for (std::size_t i = 0; i < data[0] % 4U; ++i) {
        stream[(data[1] * 5U + i) % stream.size()] ^= static_cast<std::byte>(data[2]);
    }
    const bool stream_is_right = stream == whole_agreement;
    addPackages(stream, {data + 3, size - 3});
    const std::jthread controller([&] {
        const auto deadline = std::chrono::steady_clock::now() + std::chrono::seconds(5);
        auto link = listener.accept(deadline);
        if (!link || !link->send(stream, deadline)) {
            return;
        }
        // It says no more, and reads until the driver hangs up: nothing it sent is lost.
        ::shutdown(link->descriptor(), SHUT_WR);
        Bytes heard(1'000);
        while (link->receive(heard, deadline)) {
        }
    });
    converse(listener.port(), stream_is_right);
    return 0;
}
