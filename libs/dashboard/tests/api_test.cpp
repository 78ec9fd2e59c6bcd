// The paths of the API of a page whose server is there.
#include <gmock/gmock.h>

#include <chrono>
#include <filesystem>
#include <future>
#include <memory>
#include <mutex>
#include <nlohmann/json.hpp>
#include <string>

#include "closed_bench.hpp"
#include "metier/dashboard/dashboard.hpp"
#include "metier/http/testing/raw_browser.hpp"

namespace metier::dashboard {
namespace {

using namespace std::chrono_literals;
using http::testing::RawBrowser;
using nlohmann::json;
using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::MatchesRegex;
using ::testing::StartsWith;

const httplib::Headers kIntent{{"X-Metier", "1"}};

class ServedPage : public ::testing::Test {
protected:
    /// Serves the page of one server and waits until it is connected.
    void serve(Options options, const std::string& url, const opcua::ClientOptions& client = {}) {
        options.cell.servers = {{.name = "arm", .url = url}};
        options.connector = {[client](const std::string&) { return client; },
                             [](const opcua::Failure&) { return std::string(); },
                             [this](const opcua::ClientOptions&, const std::string&) {
                                 std::call_once(once_, [this] { connected_.set_value(); });
                             }};
        dashboard_ = Dashboard::start(std::move(options), clock_).value();
        browser_ = std::make_unique<httplib::Client>("127.0.0.1", dashboard_->port());
        browser_->set_read_timeout(30);
        ASSERT_EQ(connected_.get_future().wait_for(30s), std::future_status::ready);
    }
    void TearDown() override { dashboard_.reset(); }

    /// Posts until the page knows what its server offers: the connection is reported before that.
    httplib::Result postOnceConnected(const std::string& path, const json& body) const {
        const auto end = std::chrono::steady_clock::now() + 30s;
        auto answer = post(path, body);
        while (answer->body.find("connected") != std::string::npos &&
               std::chrono::steady_clock::now() < end) {
            answer = post(path, body);
        }
        return answer;
    }
    httplib::Result post(const std::string& path, const json& body,
                         const httplib::Headers& more = {}) const {
        auto headers = kIntent;
        headers.insert(more.begin(), more.end());
        return browser_->Post(path, headers, body.dump(), "application/json");
    }
    static json errorOf(const httplib::Result& answer) {
        return json::parse(answer->body).at("error");
    }

    ManualClock clock_;  // of log-ins
    std::once_flag once_;
    std::promise<void> connected_;
    std::unique_ptr<Dashboard> dashboard_;
    std::unique_ptr<httplib::Client> browser_;
};

class PageOfALab : public ServedPage {
protected:
    PageOfALab() {
        arm_.serve();
        Options options;
        options.lab = true;
        options.limits.tabs = 2;
        serve(std::move(options), arm_.url());
        awaitShownConnected();
    }
    /// Waits until the page shows that its server is connected.
    void awaitShownConnected() const {
        const auto end = std::chrono::steady_clock::now() + 30s;
        const auto isShown = [this] {
            const auto cell = json::parse(browser_->Get("/api/cell")->body);
            return cell.at("servers").at(0).at("connected") == true;
        };
        bool shown = isShown();
        while (!shown && std::chrono::steady_clock::now() < end) {
            shown = isShown();
        }
        EXPECT_TRUE(shown);
    }
    /// A stream of which all up to its snapshot has come.
    std::unique_ptr<RawBrowser> openTab() const {
        auto tab = std::make_unique<RawBrowser>(dashboard_->port());
        tab->send("GET /api/stream HTTP/1.1\r\nHost: 127.0.0.1\r\n\r\n");
        EXPECT_THAT(tab->receive("event: snapshot"), HasSubstr("event: snapshot"));
        return tab;
    }

    ArmByHand arm_;
};

TEST_F(PageOfALab, HasCommandsWithTheirRefusals) {
    const std::string skill = "arm/BenchController/MoveSkill";
    for (const std::string path : {"start", "suspend", "resume", "reset"}) {
        const auto at = "/api/skills/" + path;
        EXPECT_EQ(errorOf(post(at, json::object())).at("message"), "key is missing") << path;
        EXPECT_EQ(errorOf(post(at, {{"key", skill}})).at("message"), "tab is missing") << path;
        EXPECT_EQ(post(at, {{"key", "arm/None"}, {"tab", "a"}})->status, 404) << path;
        EXPECT_EQ(post(at, {{"key", skill}, {"tab", "a"}})->status, 404) << path << ": no such tab";
    }
    EXPECT_EQ(post("/api/skills/check", json::object())->status, 400);
    EXPECT_EQ(post("/api/skills/check", {{"key", "arm/None"}})->status, 404);
    EXPECT_EQ(post("/api/skills/check", {{"key", skill}, {"parameters", {{"None", 1}}}})->status,
              404);
    EXPECT_EQ(
        json::parse(post("/api/skills/check",
                         {{"key", skill}, {"parameters", {{"TargetJointPosition", {500, 0}}}}})
                        ->body)
            .at("possible"),
        false);
    EXPECT_EQ(json::parse(post("/api/skills/halt", {{"key", skill}})->body).at("halted"),
              json::array({skill}));
    EXPECT_EQ(post("/api/control", {{"tab", "a"}, {"action", "take"}})->status, 404);
}

TEST_F(PageOfALab, HasPathsForTheRightMethodsAlone) {
    for (const std::string path :
         {"/api/halt", "/api/control", "/api/skills/start", "/api/login"}) {
        EXPECT_EQ(browser_->Get(path)->status, 404) << path;
        EXPECT_EQ(browser_->Delete(path)->status, 404) << path;
        EXPECT_EQ(browser_->Put(path, kIntent, "{}", "application/json")->status, 404) << path;
    }
    for (const std::string path : {"/api/cell", "/api/records", "/api/me", "/api/stream",
                                   "/api/skills", "/api/skills/destroy", "/api/haltx"}) {
        const auto answer = post(path, json::object());
        EXPECT_EQ(answer->status, 404) << path;
        EXPECT_EQ(errorOf(answer).at("code"), "http") << path;
    }
    EXPECT_EQ(post("/api/halt", json::object())->status, 200);
}

TEST_F(PageOfALab, HasRecordsByWholeNumbers) {
    for (const std::string number : {"0", "7", "999999999999999999"}) {
        const auto answer = browser_->Get("/api/records/" + number);
        EXPECT_EQ(answer->status, 404) << number;
        EXPECT_EQ(errorOf(answer).at("code"), "not_found") << number;
    }
    for (const std::string number : {"-1", "9999999999999999999", "1.5", "x", "", "1/2"}) {
        const auto answer = browser_->Get("/api/records/" + number);
        EXPECT_EQ(answer->status, 404) << number;
        EXPECT_EQ(errorOf(answer).at("code"), "http") << number << ": no such path";
    }
}

TEST_F(PageOfALab, AnswersWhereItsFilesAreMissing) {
    const auto page = browser_->Get("/");
    EXPECT_EQ(page->status, 503);
    EXPECT_THAT(page->body, HasSubstr("The API is at /api"));
    EXPECT_EQ(browser_->Get("/api/meshes")->status, 404);
    EXPECT_EQ(browser_->Get("/meshes/ur5.urdf")->status, 404);
    EXPECT_EQ(json::parse(browser_->Get("/api/cell")->body).at("meshes"), false);
}

TEST_F(PageOfALab, ProtectsEveryAnswer) {
    for (const std::string path : {"/", "/api/cell", "/api/nothing", "/api/records/x"}) {
        const auto answer = browser_->Get(path);
        EXPECT_EQ(answer->get_header_value("X-Frame-Options"), "DENY") << path;
        EXPECT_THAT(answer->get_header_value("Content-Security-Policy"),
                    HasSubstr("frame-ancestors 'none'"))
            << path;
    }
    EXPECT_EQ(
        browser_->Get("/api/cell", {{"Host", "evil.example"}})->get_header_value("X-Frame-Options"),
        "DENY");
}

TEST_F(PageOfALab, OpensSoManyTabsAndAnotherOnceOneIsClosed) {
    auto first = openTab();
    const auto second = openTab();
    const auto refused = browser_->Get("/api/stream");
    EXPECT_EQ(refused->status, 503);
    EXPECT_EQ(errorOf(refused).at("code"), "resource_unavailable");
    EXPECT_THAT(errorOf(refused).at("message").get<std::string>(), HasSubstr("2 tabs are open"));
    first.reset();
    std::string answer;
    do {  // that it is closed is seen some time later
        RawBrowser third(dashboard_->port());
        third.send("GET /api/stream HTTP/1.1\r\nHost: 127.0.0.1\r\n\r\n");
        answer = third.receive("\r\n\r\n");
    } while (answer.starts_with("HTTP/1.1 503"));
    EXPECT_THAT(answer, StartsWith("HTTP/1.1 200"));
}

TEST_F(PageOfALab, ShowsAServerThatIsFoundLater) {
    dashboard_->addServer({.name = "later", .url = "opc.tcp://127.0.0.1:1"});
    dashboard_->addServer({.name = "later", .url = "opc.tcp://127.0.0.1:2"});
    const auto servers = json::parse(browser_->Get("/api/cell")->body).at("servers");
    ASSERT_EQ(servers.size(), 2U);
    EXPECT_EQ(servers.at(0).at("connected"), true);
    EXPECT_EQ(servers.at(1).at("url"), "opc.tcp://127.0.0.1:1");
    EXPECT_EQ(servers.at(1).at("connected"), false);
}

TEST_F(PageOfALab, EndsWhileTabsAreOpen) {
    const auto tab = openTab();
    dashboard_.reset();
    EXPECT_TRUE(tab->awaitEnd());
}

/// A page that logs people in, of a server that does not.
class PageOfAnOpenServer : public ServedPage {
protected:
    PageOfAnOpenServer() {
        arm_.serve();
        serve({}, arm_.url());
    }

    ArmByHand arm_;
};

TEST_F(PageOfAnOpenServer, WantsALogInAllTheSame) {
    for (const std::string path : {"/api/cell", "/api/records", "/api/stream"}) {
        EXPECT_EQ(browser_->Get(path)->status, 401) << path;
    }
    for (const std::string path : {"/api/halt", "/api/control", "/api/skills/start"}) {
        EXPECT_EQ(post(path, json::object())->status, 401) << path;
    }
    const auto me = json::parse(browser_->Get("/api/me")->body);
    EXPECT_EQ(me.at("login_required"), true);
    EXPECT_EQ(me.at("role"), "");
    const auto login = postOnceConnected("/api/login", {{"user", "anna"}, {"password", "x"}});
    EXPECT_EQ(login->status, 502);
    EXPECT_THAT(login->body, HasSubstr("without security")) << "an open server lets everybody in";
}

class PageOfAClosedServer : public ServedPage {
protected:
    PageOfAClosedServer() {
        Options options;
        options.host_name = "cell.example";
        serve(std::move(options), closed_.url(), closed_.options());
        EXPECT_EQ(
            postOnceConnected("/api/login", {{"user", "otto"}, {"password", "secret"}})->status,
            200);
    }
    httplib::Result logIn(const std::string& user, const std::string& password) const {
        return post("/api/login", {{"user", user}, {"password", password}});
    }
    static std::string cookieOf(const httplib::Result& answer) {
        const auto cookie = answer->get_header_value("Set-Cookie");
        return cookie.substr(0, cookie.find(';'));
    }

    ClosedArm closed_;
};

TEST_F(PageOfAClosedServer, GivesACookieThatNoProgramAndNoOtherPageGets) {
    const auto answer = logIn("anna", "secret");
    ASSERT_EQ(answer->status, 200) << answer->body;
    EXPECT_EQ(
        json::parse(answer->body),
        json::parse(R"({"user":"anna","role":"operator","lab":false,"login_required":true})"));
    EXPECT_THAT(answer->get_header_value("Set-Cookie"),
                MatchesRegex("metier_" + std::to_string(dashboard_->port()) +
                             "=[0-9a-f]{32}; Path=/; HttpOnly; SameSite=Strict"));
}

TEST_F(PageOfAClosedServer, KnowsWhoAsksUntilTheyLogOut) {
    const auto cookie = cookieOf(logIn("otto", "secret"));
    const httplib::Headers mine{{"Cookie", "other=1; " + cookie}};
    EXPECT_EQ(json::parse(browser_->Get("/api/me", mine)->body).at("role"), "observer");
    EXPECT_EQ(browser_->Get("/api/cell", mine)->status, 200);
    EXPECT_EQ(post("/api/halt", json::object(), mine)->status, 200);
    const auto out = post("/api/logout", json::object(), mine);
    EXPECT_THAT(out->get_header_value("Set-Cookie"),
                AllOf(HasSubstr("=;"), HasSubstr("Max-Age=0")));
    EXPECT_EQ(json::parse(out->body).at("user"), "");
    EXPECT_EQ(browser_->Get("/api/cell", mine)->status, 401);
    EXPECT_EQ(post("/api/logout", json::object(), mine)->status, 200) << "once more";
}

TEST_F(PageOfAClosedServer, TakesNoCookieOfAnotherPort) {
    auto cookie = cookieOf(logIn("anna", "secret"));
    const auto token = cookie.substr(cookie.find('='));
    for (const std::string name : {"metier", "metier_1", "METIER_1"}) {
        EXPECT_EQ(browser_->Get("/api/cell", {{"Cookie", name + token}})->status, 401) << name;
    }
}

TEST_F(PageOfAClosedServer, RefusesALogInWithItsReason) {
    const auto before = closed_.attempts();
    EXPECT_EQ(post("/api/login", {{"user", 7}, {"password", "x"}})->status, 400);
    EXPECT_EQ(post("/api/login", {{"user", "anna"}, {"password", std::string(2'000, 'x')}})->status,
              400);
    EXPECT_EQ(
        browser_->Post("/api/login", R"({"user":"anna","password":"secret"})", "application/json")
            ->status,
        403)
        << "another page's form";
    EXPECT_EQ(closed_.attempts(), before);
    for (int i = 0; i < 3; ++i) {
        const auto wrong = logIn("anna", "wrong");
        EXPECT_EQ(wrong->status, 401);
        EXPECT_FALSE(wrong->has_header("Set-Cookie"));
    }
    const auto barred = logIn("anna", "secret");
    EXPECT_EQ(barred->status, 429);
    EXPECT_THAT(errorOf(barred).at("message").get<std::string>(), HasSubstr("wait"));
    EXPECT_EQ(logIn("otto", "secret")->status, 200);
}

TEST_F(PageOfAClosedServer, IsReachedByItsHostName) {
    EXPECT_EQ(browser_->Get("/api/me", {{"Host", "cell.example"}})->status, 200);
    EXPECT_EQ(browser_
                  ->Get("/api/me", {{"Host", "cell.example:443"},
                                    {"Origin", "https://cell.example:443"},
                                    {"X-Forwarded-For", "192.0.2.7"}})
                  ->status,
              200)
        << "through a proxy";
    EXPECT_EQ(browser_->Get("/api/me", {{"Host", "cell.example.evil"}})->status, 403);
}

}  // namespace
}  // namespace metier::dashboard
