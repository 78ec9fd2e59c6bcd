#include "common/log_bridge.hpp"

#include <gmock/gmock.h>
#include <open62541/plugin/log.h>
#include <spdlog/sinks/ostream_sink.h>

#include <sstream>
#include <string>
#include <utility>

namespace metier::opcua {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

class StackLog : public ::testing::Test {
protected:
    StackLog() {
        logger_->set_pattern("%l: %v");
        logger_->set_level(spdlog::level::trace);
    }
    std::string taken() { return std::exchange(text_, std::ostringstream()).str(); }
    UA_Logger* log() { return bridge_.handle(); }

    std::ostringstream text_;
    std::shared_ptr<spdlog::logger> logger_ = std::make_shared<spdlog::logger>(
        "stack", std::make_shared<spdlog::sinks::ostream_sink_mt>(text_));
    LogBridge bridge_{logger_};
};

TEST_F(StackLog, IsOfLowerLevelsThanTheStackGivesIt) {
    UA_LOG_FATAL(log(), UA_LOGCATEGORY_SERVER, "a");
    EXPECT_EQ(taken(), "error: a\n");
    UA_LOG_ERROR(log(), UA_LOGCATEGORY_SERVER, "a");
    EXPECT_EQ(taken(), "error: a\n");
    UA_LOG_WARNING(log(), UA_LOGCATEGORY_SERVER, "a");
    EXPECT_EQ(taken(), "warning: a\n");
    UA_LOG_INFO(log(), UA_LOGCATEGORY_SERVER, "a");
    EXPECT_EQ(taken(), "debug: a\n") << "about single sessions and channels";
}

TEST_F(StackLog, DoesNotWarnOfAMissingLinkThatIsIntended) {
    UA_LOG_WARNING(log(), UA_LOGCATEGORY_SERVER,
                   "Creating the subscription diagnostics object failed with %s", "BadX");
    EXPECT_THAT(taken(), HasSubstr("debug: "));
}

TEST_F(StackLog, IsNeitherFormatNorCommandOfATerminal) {
    UA_LOG_WARNING(log(), UA_LOGCATEGORY_SERVER, "peer %s\there", "{} %s %n\x1b[2J\nerror: x");
    EXPECT_EQ(taken(),
              "warning: peer {} %s %n\xEF\xBF\xBD[2J\xEF\xBF\xBD"
              "error: x here\n");
}

TEST_F(StackLog, IsCutWhereItIsTooLong) {
    const std::string longest(1'022, 'x');
    UA_LOG_WARNING(log(), UA_LOGCATEGORY_SERVER, "%s", (longest + "\xC3\xA4 more").c_str());
    EXPECT_EQ(taken(), "warning: " + longest + "\xEF\xBF\xBD\n") << "in the midst of a letter";
}

TEST_F(StackLog, IsSilentBelowTheLevelOfItsLogger) {
    logger_->set_level(spdlog::level::err);
    UA_LOG_WARNING(log(), UA_LOGCATEGORY_SERVER, "a");
    EXPECT_EQ(taken(), "");
}

}  // namespace
}  // namespace metier::opcua
