#include "metier/opcua/status_code.hpp"

#include <gtest/gtest.h>
#include <open62541/statuscodes.h>

namespace metier::opcua {
namespace {

TEST(StatusCode, TellsGoodFromBad) {
    EXPECT_TRUE(status::kGood.isGood());
    EXPECT_FALSE(status::kGood.isBad());
    EXPECT_TRUE(status::kBadOutOfRange.isBad());
    EXPECT_FALSE(StatusCode(0x40000000).isGood());
    EXPECT_FALSE(StatusCode(0x40000000).isBad());
}

TEST(StatusCode, HasTheNameOfTheStandard) {
    EXPECT_EQ(status::kBadOutOfRange.name(), "BadOutOfRange");
    EXPECT_EQ(status::kGood.name(), "Good");
    EXPECT_EQ(status::kBadLocked.name(), "BadLocked");
}

TEST(StatusCode, PrintsAnUnknownCodeInHexadecimal) {
    EXPECT_EQ(StatusCode(0x8FFF0000).name(), "0x8FFF0000");
}

TEST(StatusCode, EachNamedConstantIsTheStandardsCode) {
    EXPECT_EQ(status::kBadUnexpectedError.name(), "BadUnexpectedError");
    EXPECT_EQ(status::kBadResourceUnavailable.value(), UA_STATUSCODE_BADRESOURCEUNAVAILABLE);
    EXPECT_EQ(status::kBadTypeMismatch.value(), UA_STATUSCODE_BADTYPEMISMATCH);
    EXPECT_EQ(status::kBadInvalidState.value(), UA_STATUSCODE_BADINVALIDSTATE);
    EXPECT_EQ(status::kBadStateNotActive.value(), UA_STATUSCODE_BADSTATENOTACTIVE);
    EXPECT_EQ(status::kBadNoCommunication.value(), UA_STATUSCODE_BADNOCOMMUNICATION);
    EXPECT_EQ(status::kBadWaitingForInitialData.value(), UA_STATUSCODE_BADWAITINGFORINITIALDATA);
    EXPECT_EQ(status::kBadUserAccessDenied.value(), UA_STATUSCODE_BADUSERACCESSDENIED);
    EXPECT_EQ(status::kBadNotExecutable.value(), UA_STATUSCODE_BADNOTEXECUTABLE);
    EXPECT_EQ(status::kBadConnectionClosed.value(), UA_STATUSCODE_BADCONNECTIONCLOSED);
    EXPECT_EQ(status::kBadNodeIdExists.value(), UA_STATUSCODE_BADNODEIDEXISTS);
}

TEST(ErrorTable, EachErrorReachesAPeerAsItsOwnStatus) {
    EXPECT_EQ(statusFrom(Errc::out_of_range), status::kBadOutOfRange);
    EXPECT_EQ(statusFrom(Errc::type_mismatch), status::kBadTypeMismatch);
    EXPECT_EQ(statusFrom(Errc::invalid_state), status::kBadInvalidState);
    EXPECT_EQ(statusFrom(Errc::locked), status::kBadLocked);
    EXPECT_EQ(statusFrom(Errc::resource_unavailable), status::kBadResourceUnavailable);
    EXPECT_EQ(statusFrom(Errc::access_denied), status::kBadUserAccessDenied);
    EXPECT_EQ(statusFrom(Errc::internal), status::kBadInternalError);
}

TEST(ErrorTable, LeadsBackToTheSameErrorExceptForLimits) {
    for (int i = 0; i <= static_cast<int>(Errc::internal); ++i) {
        const auto code = static_cast<Errc>(i);
        const bool shared = code == Errc::unreachable || code == Errc::limit_violated;
        EXPECT_EQ(errcFrom(statusFrom(code)), shared ? Errc::out_of_range : code);
    }
}

TEST(ErrorTable, KnowsWhatAStackAnswersByItself) {
    EXPECT_EQ(errcFrom(status::kBadNodeIdUnknown), Errc::not_found);
    EXPECT_EQ(errcFrom(status::kBadConnectionClosed), Errc::connection_lost);
    EXPECT_EQ(errcFrom(StatusCode(0x8FFF0000)), Errc::internal);
}

TEST(ErrorTable, AnErrorSaysWhatWasDoneAndHowItEnded) {
    const Error error = errorFrom(status::kBadLocked, "call Start");
    EXPECT_EQ(error.code, Errc::locked);
    EXPECT_EQ(error.message, "call Start: BadLocked");
}

}  // namespace
}  // namespace metier::opcua
