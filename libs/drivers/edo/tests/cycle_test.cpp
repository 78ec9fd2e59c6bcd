#include <gtest/gtest.h>

#include "metier/base/testing/allocation_count.hpp"
#include "session_bench.hpp"

namespace metier::edo_driver {
namespace {

/// Counts what goes out and keeps none of it.
class SilentWire final : public Wire {
public:
    void send(std::string_view text) noexcept override { characters += text.size(); }
    std::size_t characters = 0;
};

/// Texts of one cycle of a robot that stands at its set-point.
constexpr std::string_view kJoints =
    R"({"topic":"/usb_jnt_state","msg":{"joints_mask":127,"joints":[{"position":0.0},)"
    R"({"position":10.0},{"position":90.0},{"position":0.0},{"position":80.0},{"position":0.0},)"
    R"({"position":40.0}]},"op":"publish"})";
constexpr std::string_view kAlgorithm =
    R"({"topic":"/algorithm_state","msg":{"data":10},"op":"publish"})";
constexpr std::string_view kMachine =
    R"({"topic":"/machine_state","msg":{"current_state":2,"opcode":0},"op":"publish"})";

TEST(Cycle, DoesNotAllocate) {
    testing::Bench bench;
    bench.start();
    const auto source = bench.attach(1e-6, 100);
    ASSERT_TRUE(bench.runUntil([&] { return source->asked >= 10; }));
    SilentWire wire;
    const auto before = allocationCount();
    for (int i = 0; i < 150; ++i) {
        bench.now += std::chrono::milliseconds(10);
        bench.session.onText(kJoints, bench.now, wire);
        bench.session.onText(kAlgorithm, bench.now, wire);
        bench.session.onText(kMachine, bench.now, wire);
        bench.ticked = bench.session.tick(bench.now, wire);
    }
    // The call that gives control back at the end is not part of a cycle.
    EXPECT_LE(allocationCount() - before, 2U);
    EXPECT_EQ(source->asked, 100) << "to its end and beyond";
    EXPECT_GT(wire.characters, 100U * 200U);
}

TEST(Cycle, DoesNotAllocateWhileItBrakes) {
    testing::Bench bench;
    bench.start();
    const auto source = bench.attach(0.002, 1000);
    ASSERT_TRUE(bench.runUntil([&] { return source->asked >= 50; }));
    SilentWire wire;
    bench.core.stop();
    const auto before = allocationCount();
    for (int i = 0; i < 5; ++i) {
        bench.now += std::chrono::milliseconds(10);
        bench.session.onText(kJoints, bench.now, wire);
        bench.ticked = bench.session.tick(bench.now, wire);
    }
    EXPECT_EQ(allocationCount() - before, 0U);
    EXPECT_EQ(source->asked, 50);
}

}  // namespace
}  // namespace metier::edo_driver
