// Both readers of the robot's messages: whatever comes, and that the quick one agrees with the
// other.
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string>

#include "decoder.hpp"
#include "metier/edo_driver/generation.hpp"

namespace {

using namespace metier::edo_driver;

constexpr std::string_view kMessage =
    R"({"topic":"/usb_jnt_state","msg":{"joints_mask":127,"joints":[{"position":-1.5e1,)"
    R"("velocity":0.25,"current":null,"commandFlag":32},{}]},"op":"publish"})";

bool same(double a, double b) {
    return a == b || (std::isnan(a) && std::isnan(b));
}

bool same(const JointStates& a, const JointStates& b) {
    bool equal = a.count == b.count;
    for (std::size_t i = 0; equal && i < a.count; ++i) {
        equal = same(a.joints[i].position, b.joints[i].position) &&
                same(a.joints[i].velocity, b.joints[i].velocity) &&
                same(a.joints[i].current, b.joints[i].current) &&
                a.joints[i].flags == b.joints[i].flags;
    }
    return equal;
}

void check(std::string_view text) {
    const JointLayout layout{6, true};
    const auto quick = decode(text, layout);
    const auto full = decodeInFull(text, layout);
    bool agree =
        quick.has_value() == full.has_value() && (!quick || quick->index() == full->index());
    if (agree && quick && std::holds_alternative<JointStates>(*quick)) {
        agree = same(std::get<JointStates>(*quick), std::get<JointStates>(*full));
    }
    if (agree && quick && std::holds_alternative<MachineState>(*quick)) {
        agree = std::get<MachineState>(*quick) == std::get<MachineState>(*full);
    }
    if (!agree) {
        std::abort();
    }
}

}  // namespace

/// A text, or a character that none begins with and changes of a message that is right.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    const std::string_view text(reinterpret_cast<const char*>(data), size);
    if (size == 0 || data[0] < 0x80) {
        check(text);
        static_cast<void>(generationOf(text));
        return 0;
    }
    std::string changed(kMessage);
    for (std::size_t i = 1; i + 1 < size && i < 9; i += 2) {
        changed[data[i] % changed.size()] = static_cast<char>(data[i + 1] % 0x60 + 0x20);
    }
    check(changed);
    return 0;
}
