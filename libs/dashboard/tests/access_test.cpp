// Which requests are looked at: whose page they come from, and whether from this machine.
#include "access.hpp"

#include <gmock/gmock.h>

#include <string>

namespace metier::dashboard {
namespace {

using ::testing::HasSubstr;

httplib::Request requestTo(const std::string& host, const std::string& origin = "") {
    httplib::Request request;
    request.remote_addr = "127.0.0.1";
    request.headers.emplace("Host", host);
    if (!origin.empty()) {
        request.headers.emplace("Origin", origin);
    }
    return request;
}

TEST(Loopback, IsWhatNoOtherMachineReaches) {
    for (const auto* address : {"127.0.0.1", "127.255.255.254", "::1", "localhost",
                                "::ffff:127.0.0.1", "0:0:0:0:0:0:0:1"}) {
        EXPECT_TRUE(isLoopback(address)) << address;
    }
    for (const auto* address : {"0.0.0.0", "::", "128.0.0.1", "126.255.255.255", "::ffff:192.0.2.1",
                                "::2", "1::1", "127.1", "127.0.0.1.example", "localhost.example",
                                "LOCALHOST", "", " 127.0.0.1", "::127.0.0.1"}) {
        EXPECT_FALSE(isLoopback(address)) << address;
    }
}

TEST(Origin, IsThisPageOrNone) {
    for (const auto* host : {"127.0.0.1:8080", "localhost:8080", "[::1]:8080", "192.0.2.7"}) {
        EXPECT_TRUE(checkOrigin(requestTo(host), ""));
        EXPECT_TRUE(checkOrigin(requestTo(host, std::string("http://") + host), ""));
        EXPECT_TRUE(checkOrigin(requestTo(host, std::string("https://") + host), ""));
        EXPECT_FALSE(checkOrigin(requestTo(host, "http://evil.example"), ""));
        EXPECT_FALSE(checkOrigin(requestTo(host, std::string("http://") + host + "0"), ""));
        EXPECT_FALSE(checkOrigin(requestTo(host, "null"), "")) << "a page without an origin";
        EXPECT_FALSE(checkOrigin(requestTo(host, host), ""));
    }
    EXPECT_FALSE(checkOrigin(requestTo("127.0.0.1:8080", "http://127.0.0.1:8081"), ""))
        << "another page of this machine";
}

TEST(Origin, IsNotReachedByANameThatNobodyGaveThePage) {
    for (const auto* host : {"evil.example", "evil.example:8080", "127.0.0.1.evil.example",
                             "localhost.evil.example", "[::1", "[evil]", ":8080", "", "[]:8080"}) {
        const auto refused = checkOrigin(requestTo(host), "");
        ASSERT_FALSE(refused) << host;
        EXPECT_EQ(refused.error().code, Errc::access_denied);
    }
    EXPECT_TRUE(checkOrigin(requestTo("cell.example:8080"), "cell.example"));
    EXPECT_FALSE(checkOrigin(requestTo("cell.example.evil:8080"), "cell.example"));
    EXPECT_FALSE(checkOrigin(requestTo("cell", ""), "cell.example"));
}

TEST(Origin, IsNotCertainWithTwoHostsOrNone) {
    auto request = requestTo("127.0.0.1");
    request.headers.emplace("Host", "evil.example");
    EXPECT_FALSE(checkOrigin(request, ""));
    EXPECT_FALSE(checkOrigin({}, ""));
}

TEST(Locality, NeedsAPeerAndAHostOfThisMachineAndNoProxy) {
    EXPECT_TRUE(checkLocal(requestTo("127.0.0.1:8080")));
    EXPECT_TRUE(checkLocal(requestTo("[::1]:8080")));
    EXPECT_FALSE(checkLocal(requestTo("192.0.2.1:8080")));
    auto far = requestTo("127.0.0.1:8080");
    far.remote_addr = "192.0.2.7";
    const auto refused = checkLocal(far);
    ASSERT_FALSE(refused);
    EXPECT_EQ(refused.error().code, Errc::access_denied);
    EXPECT_THAT(refused.error().message, HasSubstr("without a proxy"));
    for (const auto* header : {"Forwarded", "X-Forwarded-For", "X-Forwarded-Host",
                               "X-Forwarded-Proto", "X-Real-IP", "Via", "x-forwarded-for"}) {
        auto passed_on = requestTo("127.0.0.1:8080");
        passed_on.headers.emplace(header, "");
        EXPECT_FALSE(checkLocal(passed_on)) << header;
    }
}

TEST(Intent, IsTheHeaderAndABodyOfJson) {
    const auto with = [](const std::string& header, const std::string& type) {
        httplib::Request request;
        request.headers = {{"X-Metier", header}, {"Content-Type", type}};
        return checkIntent(request);
    };
    EXPECT_TRUE(with("1", "application/json"));
    EXPECT_TRUE(with("1", "application/json; charset=utf-8"));
    for (const auto* header : {"", "0", "11", "true"}) {
        EXPECT_EQ(with(header, "application/json").error().code, Errc::access_denied) << header;
    }
    // These a page of another site can make a browser send.
    for (const auto* type : {"", "text/plain", "application/x-www-form-urlencoded",
                             "multipart/form-data", "text/plain; application/json"}) {
        EXPECT_EQ(with("1", type).error().code, Errc::invalid_argument) << type;
    }
    EXPECT_FALSE(checkIntent({}));
}

TEST(Cookies, WithANameThatBeginsTheSameAreOthers) {
    httplib::Request request;
    request.headers = {{"Cookie", "metier_80800=other;  metier_8080=mine=1;metier_8080=late"}};
    EXPECT_EQ(cookie(request, "metier_8080"), "mine=1");
    EXPECT_EQ(cookie(request, "metier"), "");
    request.headers = {{"Cookie", ";; ;metier"}};
    EXPECT_EQ(cookie(request, "metier"), "") << "no value";
}

TEST(ProtectiveHeaders, LetNobodyShowThePageNorRunProgramsInIt) {
    const auto headers = protectiveHeaders();
    const auto policy = headers.find("Content-Security-Policy")->second;
    for (const auto* rule : {"default-src 'none'", "script-src 'self'", "connect-src 'self'",
                             "frame-ancestors 'none'", "base-uri 'none'", "form-action 'self'"}) {
        EXPECT_THAT(policy, HasSubstr(rule));
    }
    EXPECT_THAT(policy, ::testing::Not(HasSubstr("unsafe")));
    EXPECT_EQ(headers.find("X-Frame-Options")->second, "DENY");
}

}  // namespace
}  // namespace metier::dashboard
