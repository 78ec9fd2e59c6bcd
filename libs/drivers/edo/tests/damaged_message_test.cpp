// The quick reader of the robot's messages against the one that reads all of JSON.
#include <gtest/gtest.h>

#include <string>

#include "decoder.hpp"

namespace metier::edo_driver {
namespace {

const JointLayout kWithGripper{6, true};

std::string textOf(const JointStates& states) {
    std::string text = "joints";
    for (std::size_t i = 0; i < states.count; ++i) {
        const auto& joint = states.joints[i];
        text +=
            fmt::format(" {} {} {} {}", joint.position, joint.velocity, joint.current, joint.flags);
    }
    return text;
}

/// The content as a text; "refused" if there is none.
std::string textOf(const Result<Incoming>& message) {
    if (!message) {
        return "refused";
    }
    if (const auto* states = std::get_if<JointStates>(&*message)) {
        return textOf(*states);
    }
    if (const auto* machine = std::get_if<MachineState>(&*message)) {
        return fmt::format("machine {} {}", machine->state, machine->opcode);
    }
    if (const auto* algorithm = std::get_if<AlgorithmState>(&*message)) {
        return fmt::format("algorithm {}", algorithm->value);
    }
    return fmt::format("other {}", message->index());
}

class DamagedMessage : public ::testing::TestWithParam<std::string_view> {};

TEST_P(DamagedMessage, IsReadOrRefusedByTheQuickReaderAsByTheFullOne) {
    const auto compare = [](const std::string& text) {
        EXPECT_EQ(textOf(decode(text, kWithGripper)), textOf(decodeInFull(text, kWithGripper)))
            << text;
    };
    const std::string whole(GetParam());
    compare(whole);
    for (std::size_t at = 0; at < whole.size() && !HasFailure(); ++at) {
        compare(std::string(whole).erase(at, 1));
        compare(whole.substr(0, at));
        for (const char other : std::string_view("{}[]:,\"\\0e.- x\n\x7f")) {
            auto text = whole;
            text[at] = other;
            compare(text);
            compare(std::string(whole).insert(at, 1, other));
        }
    }
}

INSTANTIATE_TEST_SUITE_P(
    OfEachTopic, DamagedMessage,
    ::testing::Values(
        R"({"topic":"/usb_jnt_state","msg":{"joints_mask":3,"joints":[{"position":-1.5e1,)"
        R"("velocity":null,"current":0.25,"commandFlag":32,"R_jnt":0.0}, {}]},"op":"publish"})",
        R"({"op":"publish", "topic":"/machine_state","msg":{"opcode":64,"x":[true,false,null],)"
        R"("current_state":255}})",
        R"({"op":"publish","topic":"/algorithm_state","msg":{"layout":{"a":"b"},"data":-128}})"));

}  // namespace
}  // namespace metier::edo_driver
