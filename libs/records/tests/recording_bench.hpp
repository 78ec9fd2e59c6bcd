#pragma once

#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <filesystem>
#include <memory>
#include <string>

#include "metier/device/arm.hpp"
#include "metier/device/shared_value.hpp"
#include "metier/records/recorder.hpp"
#include "metier/records/store.hpp"

namespace metier::records::testing {

/// An arm that is where the test puts it.
class PlacedArm final : public device::Arm {
public:
    PlacedArm() { place({0.0, 0.0}, {0.0, 0.0}); }

    /// Joint positions [rad].
    void place(std::array<double, 2> measured, std::array<double, 2> commanded,
               std::uint64_t missed = 0) {
        device::ArmState state;
        state.position = device::JointArray(measured);
        state.velocity = device::JointArray(2);
        state.commanded_position = device::JointArray(commanded);
        state.safety = device::SafetyState::normal;
        state.cycle = ++cycle_;
        state.missed_cycles = missed;
        state.stamp = SteadyTime(std::chrono::milliseconds(8 * cycle_));
        state_.write(state);
    }

    const device::ArmInfo& info() const noexcept override { return info_; }
    device::ArmState state() const noexcept override {
        ++reads_;
        reads_.notify_all();
        return state_.read();
    }
    /// Returns once the state was read that often again.
    void awaitReads(int count) const {
        const int end = reads_ + count;
        for (int seen = reads_; seen < end; seen = reads_) {
            reads_.wait(seen);
        }
    }
    device::Safety safety() const override { return {}; }
    Result<void> attach(std::shared_ptr<device::SetPointSource> /*source*/) override {
        return fail(Errc::not_supported, "it is placed");
    }
    void stop() noexcept override {}
    Result<void> resetFault() override { return {}; }
    device::Registration onSafetyChange(SafetyCallback /*callback*/) override { return {}; }

private:
    device::ArmInfo info_{"placed", {"one", "two"}, std::chrono::milliseconds(8)};
    std::uint64_t cycle_ = 0;
    device::SharedValue<device::ArmState> state_;
    mutable std::atomic<int> reads_{0};
};

/// A recorder with a file of its own, and the store in it.
class RecordedFile {
public:
    RecordedFile() = default;
    ~RecordedFile() {
        recorder_.reset();
        std::filesystem::remove(file_);
    }
    RecordedFile(const RecordedFile&) = delete;
    RecordedFile& operator=(const RecordedFile&) = delete;

    Recorder& recorder() { return *recorder_; }
    /// With all that was recorded up to now.
    std::unique_ptr<Store> store() {
        EXPECT_TRUE(recorder_->flush(std::chrono::steady_clock::now() + std::chrono::seconds(60)));
        auto store = Store::open(file_);
        EXPECT_TRUE(store) << store.error().message;
        return store ? std::move(*store) : nullptr;
    }

private:
    static std::string freshFile() {
        const auto* test = ::testing::UnitTest::GetInstance()->current_test_info();
        auto file = std::filesystem::path(::testing::TempDir()) /
                    (std::string(test->test_suite_name()) + test->name() + ".db");
        for (const auto* more : {"", "-wal", "-shm"}) {
            std::filesystem::remove(file.string() + more);
        }
        return file;
    }

    const std::string file_ = freshFile();
    std::unique_ptr<Recorder> recorder_ =
        std::move(*Recorder::create({.url = file_,
                                     .server = "urn:test",
                                     // The Programs live in 1970.
                                     .keep = {.age = {}, .bytes = 0}}));
};

}  // namespace metier::records::testing
