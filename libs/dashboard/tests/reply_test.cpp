// What the API makes of errors and bodies.
#include "reply.hpp"

#include <gmock/gmock.h>

#include <string>

namespace metier::dashboard {
namespace {

using nlohmann::json;
using ::testing::HasSubstr;

TEST(ReplyTest, HasTheStatusOfHttpThatFitsAnError) {
    for (const auto& [code, status] : {std::pair{Errc::invalid_argument, 400},
                                       {Errc::type_mismatch, 400},
                                       {Errc::access_denied, 403},
                                       {Errc::not_found, 404},
                                       {Errc::already_exists, 409},
                                       {Errc::invalid_state, 409},
                                       {Errc::locked, 409},
                                       {Errc::resource_unavailable, 409},
                                       {Errc::out_of_range, 422},
                                       {Errc::unreachable, 422},
                                       {Errc::limit_violated, 422},
                                       {Errc::not_supported, 501},
                                       {Errc::connection_lost, 502},
                                       {Errc::timeout, 504},
                                       {Errc::device_fault, 500},
                                       {Errc::internal, 500}}) {
        const auto reply = errorReply({code, "why"});
        EXPECT_EQ(reply.status, status) << toString(code);
        EXPECT_EQ(reply.body.at("error").at("code"), toString(code));
        EXPECT_EQ(reply.body.at("error").at("message"), "why");
    }
}

TEST(ReplyTest, IsKeptByNoCacheAndAlwaysUtf8) {
    httplib::Response response;
    write({409, {{"name", "a\xff"}}}, response);
    EXPECT_EQ(response.status, 409);
    EXPECT_EQ(response.get_header_value("Cache-Control"), "no-store");
    EXPECT_EQ(response.get_header_value("Content-Type"), "application/json");
    EXPECT_EQ(response.body, "{\"name\":\"a\xef\xbf\xbd\"}");
}

TEST(BodyTest, IsAtMostSoDeep) {
    const auto deep = [](std::size_t levels) {
        return R"({"a":)" + std::string(levels - 1, '[') + std::string(levels - 1, ']') + "}";
    };
    EXPECT_TRUE(parseBody(deep(32)));
    const auto refused = parseBody(deep(34));
    ASSERT_FALSE(refused);
    EXPECT_EQ(refused.error().code, Errc::invalid_argument);
    EXPECT_THAT(refused.error().message, HasSubstr("32 levels"));
    EXPECT_FALSE(parseBody(R"({"a":1} {"b":2})")) << "more than one";
    EXPECT_FALSE(parseBody("{\"a\":\"\xff\"}")) << "no UTF-8";
}

TEST(BodyTest, HasTextsOfABoundedLength) {
    const json body{{"short", "a"},
                    {"long", std::string(1'000, 'a')},
                    {"longer", std::string(1'001, 'a')},
                    {"number", 7},
                    {"nothing", nullptr},
                    {"empty", ""}};
    EXPECT_EQ(textIn(body, "short").value(), "a");
    EXPECT_EQ(textIn(body, "long").value().size(), 1'000U);
    for (const auto* name : {"longer", "number"}) {
        EXPECT_EQ(textOrNone(body, name).error().code, Errc::invalid_argument) << name;
        EXPECT_THAT(textIn(body, name).error().message, HasSubstr(name));
    }
    for (const auto* name : {"nothing", "empty", "absent"}) {
        EXPECT_EQ(textOrNone(body, name).value(), "") << name;
        EXPECT_EQ(textIn(body, name).error().message, std::string(name) + " is missing");
    }
}

}  // namespace
}  // namespace metier::dashboard
