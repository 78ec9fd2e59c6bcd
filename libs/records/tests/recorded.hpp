#pragma once

#include <gmock/gmock.h>

#include <array>
#include <chrono>
#include <filesystem>
#include <memory>
#include <string>

#include "metier/records/recorder.hpp"
#include "metier/records/store.hpp"

namespace metier::records {

/// Deadline of all that has to come, however busy the machine.
inline SteadyTime soon() {
    return std::chrono::steady_clock::now() + std::chrono::seconds(60);
}

/// Milliseconds after the beginning of 2026-11-22.
inline UtcTime at(std::int64_t milliseconds) {
    return UtcTime(std::chrono::seconds(1'795'305'600) + std::chrono::milliseconds(milliseconds));
}

/// A folder of the running test, empty at first.
/// \param use of the folder; a test may have several
inline std::filesystem::path testFolder(const std::string& use = "records") {
    const auto* test = ::testing::UnitTest::GetInstance()->current_test_info();
    std::string name = std::string(test->test_suite_name()) + "." + test->name();
    std::replace(name.begin(), name.end(), '/', '_');
    auto folder = std::filesystem::path(::testing::TempDir()) / use / name;
    std::filesystem::remove_all(folder);
    return folder;
}

/// An execution of the arm ur5 that begins at(0).
inline ExecutionRow moveOf(const std::string& id, UtcTime started = at(0)) {
    ExecutionRow e;
    e.id = id;
    e.server_name = "ur5";
    e.skill = "JointPtpMoveSkill";
    e.controller = "Controller";
    e.device = "ur5";
    e.session = "s-7";
    e.client_name = "metier command";
    e.user = "anna";
    e.thumbprint = "ab12";
    e.parameters = R"({"MaxVelocity":[1.0]})";
    e.check = R"({"possible":true})";
    e.started = started;
    e.state = "Running";
    return e;
}

inline Outcome finished(UtcTime time) {
    return {.time = time,
            .state = "Ready",
            .reason = "Finished",
            .reason_text = {},
            .result = R"({"Duration":1.0})",
            .missed_cycles = 2};
}

inline Outcome halted(UtcTime time, const std::string& why) {
    return {.time = time,
            .state = "Halted",
            .reason = "Error",
            .reason_text = why,
            .result = {},
            .missed_cycles = 0};
}

inline PathSample sampleAt(double time, double axis) {
    const std::array actual{axis, -axis};
    return {.time = time, .actual = SampleValues(actual), .commanded = {}, .force = {}};
}

inline std::unique_ptr<Recorder> recorderOf(const std::string& url,
                                            const std::string& server = "urn:test:ur5") {
    Recorder::Options options;
    options.url = url;
    options.server = server;
    options.patience =
        std::chrono::milliseconds(100);  // for tests that wait for WriteState::failing
    return Recorder::create(std::move(options)).value();
}

/// An execution that is over before anything is written.
inline void recordOne(Recorder& recorder, const ExecutionRow& execution, const Outcome& outcome) {
    recorder.end(recorder.begin(execution), outcome);
}

}  // namespace metier::records
