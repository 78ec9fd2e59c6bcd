#include "metier/server/own_server.hpp"

#include <gmock/gmock.h>

#include <chrono>
#include <memory>
#include <vector>

namespace metier::server::testing {
namespace {

using ::testing::HasSubstr;

skill::SkillDescription waving() {
    return {.name = "WaveSkill", .type = "WaveSkillType"};
}

/// An own server named "hand", started with these options.
OwnServer handWith(std::vector<const char*> options) {
    options.insert(options.begin(), "hand");
    return {static_cast<int>(options.size()),
            options.data(),
            {.name = "hand", .description = "A hand that waves."}};
}

TEST(OwnServer, EndsAfterItsHelpText) {
    ::testing::internal::CaptureStdout();
    auto hand = handWith({"--help"});
    EXPECT_THAT(::testing::internal::GetCapturedStdout(), HasSubstr("A hand that waves."));
    hand.offer(waving(), {});
    EXPECT_EQ(hand.run(), 0);
}

TEST(OwnServer, RefusesACommandLineThatItDoesNotUnderstand) {
    for (const auto& wrong : std::vector<std::vector<const char*>>{
             {"--port", "70000"}, {"--colour"}, {"48491"}, {"--port"}}) {
        ::testing::internal::CaptureStderr();
        auto hand = handWith(wrong);
        EXPECT_EQ(hand.run(), 2) << wrong.front();
        EXPECT_THAT(::testing::internal::GetCapturedStderr(), HasSubstr("--help")) << wrong.front();
    }
}

TEST(OwnServer, DropsTheWorkOfAServerThatCouldNotBeMade) {
    auto hand = handWith({"--colour"});
    const auto executor = hand.executor();
    executor->post([] { ADD_FAILURE() << "posted work runs"; });
    auto timer = executor->after(std::chrono::seconds(0), [] { ADD_FAILURE() << "a timer runs"; });
    EXPECT_EQ(hand.run(), 2);
}

TEST(OwnServer, ReportsSkillsThatItCannotServe) {
    auto hand = handWith({"--insecure-lab", "--port", "0"});
    hand.offer(waving(), {});
    hand.offer(waving(), {});
    ::testing::internal::CaptureStderr();
    EXPECT_EQ(hand.run(), 1);
    EXPECT_THAT(::testing::internal::GetCapturedStderr(), HasSubstr("hand: "));
    EXPECT_EQ(hand.run(), 1) << "a server that has ended serves again";
}

TEST(OwnServer, ReportsADescriptionThatContradictsItself) {
    auto hand = handWith({"--insecure-lab", "--port", "0"});
    auto description = waving();
    description.parameters = {{.name = "Height",
                               .type = skill::ValueType::number,
                               .range = skill::Range{0.0, 1.0},
                               .default_value = 2.0}};
    hand.offer(std::move(description), {});
    ::testing::internal::CaptureStderr();
    EXPECT_EQ(hand.run(), 1);
    EXPECT_THAT(::testing::internal::GetCapturedStderr(), HasSubstr("Height"));
}

TEST(OwnServer, ReportsAnAddressOnWhichALabMustNotListen) {
    ::testing::internal::CaptureStderr();
    auto hand = handWith({"--insecure-lab", "--port", "0", "--address", "0.0.0.0"});
    EXPECT_EQ(hand.run(), 1);
    EXPECT_THAT(::testing::internal::GetCapturedStderr(), HasSubstr("0.0.0.0"));
}

}  // namespace
}  // namespace metier::server::testing
