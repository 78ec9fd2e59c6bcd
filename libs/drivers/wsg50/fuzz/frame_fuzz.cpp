// Gives a conversation any bytes, cut anywhere, as if a gripper had sent them. Every second input
// is packed into frames with a right checksum first, so that what is behind it is reached, too.
#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "conversation.hpp"
#include "crc.hpp"
#include "reads.hpp"

namespace {

using namespace metier;
using namespace metier::wsg50_driver;

class Listener final : public ConversationListener {
public:
    void send(Command command) override { sent += command.bytes().size(); }
    void onLimits(const Limits& /*limits*/, double /*force_limit*/) override {}
    void onState(const device::GripperState& /*state*/) override {}
    void onSafety(device::Safety /*safety*/) override {}
    void onMotionEnd(Result<device::GripperOutcome> /*outcome*/) override {}
    void onResetEnd(Result<void> /*outcome*/) override {}

    std::size_t sent = 0;
};

void give(std::span<const std::byte> bytes) {
    Listener listener;
    SteadyTime now;
    Conversation conversation({.acknowledge = true, .home = true}, now, listener);
    FrameReader reader;
    metier::fuzz::inReads(bytes, [&](auto read) {
        const auto space = reader.space();
        const auto count = std::min(space.size(), read.size());
        std::copy_n(read.begin(), count, space.begin());
        reader.received(count);
        while (const auto frame = reader.next()) {
            static_cast<void>(conversation.take(*frame, now));
        }
        now += std::chrono::milliseconds(1);
        static_cast<void>(conversation.tick(now));
        if (conversation.ready()) {
            conversation.begin({MotionKind::grasp, 0.03, 0.05, 20.0}, now);
        }
        if (conversation.started()) {
            conversation.reset(now);
        }
    });
}

/// Cuts the input into payloads; the input itself gives their length and id. Its first byte stays.
std::vector<std::byte> framed(std::span<const std::byte> input) {
    std::vector<std::byte> frames(input.begin(), input.begin() + (input.empty() ? 0 : 1));
    input = input.subspan(frames.size());
    while (input.size() >= 2) {
        const auto length = std::min(std::to_integer<std::size_t>(input[1]) % 40, input.size() - 2);
        std::vector<std::byte> frame(3, std::byte{0xAA});
        frame.push_back(input[0]);
        frame.push_back(static_cast<std::byte>(length));
        frame.push_back(std::byte{0});
        const auto payload = input.subspan(2, length);
        frame.insert(frame.end(), payload.begin(), payload.end());
        const auto check = crc(frame);
        frame.push_back(static_cast<std::byte>(check & 0xFFU));
        frame.push_back(static_cast<std::byte>(check >> 8U));
        frames.insert(frames.end(), frame.begin(), frame.end());
        input = input.subspan(2 + length);
    }
    return frames;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    const auto input = std::as_bytes(std::span(data, size));
    give(input);
    give(framed(input));
    return 0;
}
