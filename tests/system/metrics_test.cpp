// Data that a server publishes by HTTP: figures for Prometheus, and whether it is well.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <httplib.h>
#include <unistd.h>

#include <cmath>
#include <map>
#include <regex>
#include <set>
#include <sstream>

#include "metier/base/queue.hpp"
#include "metier_program.hpp"
#include "watched_skill.hpp"

namespace metier::system_tests {
namespace {

using skill::State;

constexpr int kPort = 9464;

/// An address of this machine that no other test has.
std::string ownAddress(int number) {
    const auto pid = static_cast<unsigned>(::getpid());
    return fmt::format("127.{}.{}.{}", 64 + number, (pid >> 8U) % 256, pid % 254 + 1);
}

/// A page in the text format of Prometheus, version 0.0.4, read as strictly as it is written down.
class Page {
public:
    /// Throws at the first line that is not as it must be.
    explicit Page(const std::string& text) {
        if (text.empty() || text.back() != '\n') {
            throw std::runtime_error("the page does not end with a line feed");
        }
        std::istringstream lines(text);
        for (std::string line; std::getline(lines, line);) {
            line.starts_with('#') ? readComment(line) : readSample(line);
        }
        for (const auto& [series, count] : counts_) {
            if (infinite_.at(series) != count) {
                throw std::runtime_error(series + ": _count is not the bucket of +Inf");
            }
        }
    }
    double value(const std::string& series) const {
        const auto found = values_.find(series);
        if (found == values_.end()) {
            throw std::runtime_error("there is no " + series);
        }
        return found->second;
    }
    bool has(const std::string& series) const { return values_.contains(series); }

private:
    void readComment(const std::string& line) {
        static const std::regex kHelp(R"(# HELP ([a-zA-Z_:][a-zA-Z0-9_:]*) (.+))");
        static const std::regex kType(
            R"(# TYPE ([a-zA-Z_:][a-zA-Z0-9_:]*) (counter|gauge|histogram|summary|untyped))");
        std::smatch match;
        if (std::regex_match(line, match, kHelp)) {
            help_ = match[1];
            return;
        }
        if (!std::regex_match(line, match, kType) || match[1] != help_ ||
            !families_.insert(match[1]).second) {
            throw std::runtime_error("not a comment of the format, or a family twice: " + line);
        }
        family_ = match[1];
        type_ = match[2];
        if (type_ == "counter" && !family_.ends_with("_total")) {
            throw std::runtime_error("a counter that does not end in _total: " + line);
        }
    }
    void readSample(const std::string& line) {
        static const std::regex kSample(
            R"re(([a-zA-Z_:][a-zA-Z0-9_:]*)(\{((?:[a-zA-Z_][a-zA-Z0-9_]*="(?:[^"\\\n]|\\[\\n"])*",?)*)\})? (\S+))re");
        std::smatch match;
        if (!std::regex_match(line, match, kSample)) {
            throw std::runtime_error("not a sample: " + line);
        }
        const std::string name = match[1];
        const std::string labels = match[3];
        const double value = numberOf(match[4]);
        if (!values_.emplace(name + match[2].str(), value).second) {
            throw std::runtime_error("twice: " + line);
        }
        if (type_ == "histogram") {
            readHistogram(name, labels, value);
        } else if (name != family_) {
            throw std::runtime_error("not of the family " + family_ + ": " + line);
        }
        if (type_ != "gauge" && !(value >= 0)) {
            throw std::runtime_error("under zero: " + line);
        }
    }
    void readHistogram(const std::string& name, const std::string& labels, double value) {
        static const std::regex kLe(R"re(,?le="([^"]+)")re");
        const auto series = family_ + "{" + std::regex_replace(labels, kLe, "") + "}";
        if (name == family_ + "_count") {
            counts_[series] = value;
        } else if (name == family_ + "_bucket") {
            std::smatch le;
            if (!std::regex_search(labels, le, kLe)) {
                throw std::runtime_error(series + ": a bucket without le");
            }
            const double bound = numberOf(le[1]);
            auto& [last_bound, last_count] = buckets_[series];
            if (last_bound && (bound <= *last_bound || value < last_count)) {
                throw std::runtime_error(series + ": buckets that do not grow");
            }
            last_bound = bound;
            last_count = value;
            if (std::isinf(bound)) {
                infinite_[series] = value;
            }
        } else if (name != family_ + "_sum") {
            throw std::runtime_error("not of the histogram " + family_ + ": " + name);
        }
    }
    static double numberOf(const std::string& text) {
        if (text == "+Inf") {
            return HUGE_VAL;
        }
        std::size_t read = 0;
        const double value = std::stod(text, &read);
        if (read != text.size()) {
            throw std::runtime_error("not a number: " + text);
        }
        return value;
    }

    std::string help_;
    std::string family_;
    std::string type_;
    std::set<std::string> families_;
    std::map<std::string, double> values_;
    std::map<std::string, double> counts_;
    std::map<std::string, double> infinite_;
    std::map<std::string, std::pair<std::optional<double>, double>> buckets_;
};

/// Answer of a server with `--metrics`.
class Figures {
public:
    explicit Figures(std::string address) : address_(std::move(address)) {}

    std::string option() const { return fmt::format("{}:{}", address_, kPort); }
    httplib::Result get(const std::string& path) const {
        httplib::Client client(address_, kPort);
        client.set_read_timeout(30);
        return client.Get(path);
    }
    Page page() const {
        const auto answer = get("/metrics");
        if (!answer || answer->status != 200 ||
            answer->get_header_value("Content-Type") !=
                "text/plain; version=0.0.4; charset=utf-8") {
            throw std::runtime_error("no page at " + option());
        }
        return Page(answer->body);
    }
    /// Returns once a series has that value; throws after a minute.
    void await(const std::string& series, double value) const {
        const auto deadline = inAMinute();
        while (page().value(series) != value) {
            if (std::chrono::steady_clock::now() > deadline) {
                throw std::runtime_error(series + " never came to its value");
            }
        }
    }
    /// The first answer of /healthz with that status; throws after a minute.
    std::string awaitHealth(int status) const {
        Queue<int> nothing(1);
        const auto deadline = inAMinute();
        while (std::chrono::steady_clock::now() < deadline) {
            const auto answer = get("/healthz");
            if (answer && answer->status == status) {
                return answer->body;
            }
            static_cast<void>(nothing.popUntil(std::chrono::steady_clock::now() +
                                               std::chrono::milliseconds(100)));
        }
        throw std::runtime_error(fmt::format("{} never answered {}", option(), status));
    }

private:
    std::string address_;
};

TEST(MetricsOfAnArm, CountWhatItsSkillsDo) {
    const Figures figures(ownAddress(0));
    const auto folder = std::filesystem::path(::testing::TempDir()) / "metrics_system_test";
    std::filesystem::remove_all(folder);
    std::filesystem::create_directories(folder);
    const ServerProcess server(
        "iiwa", {"--port", "0", "--metrics", figures.option(), "--state", folder.string()});
    const auto idle = figures.page();
    EXPECT_EQ(idle.value("metier_skill_state{skill=\"JointPtpMoveSkill\",state=\"Ready\"}"), 1);
    EXPECT_EQ(idle.value("metier_skill_starts_total{skill=\"JointPtpMoveSkill\"}"), 0);

    Watched arm(server.url(), "JointPtpMoveSkill");
    auto target = jointPosition(arm.client(), *arm);
    target.front() += 0.1;
    ASSERT_TRUE(arm->startWith({.parameters = {{"TargetJointPosition", target}}}));
    arm.awaitEvent(State::ready);
    target.front() += 1.0;
    ASSERT_TRUE(
        arm->startWith({.parameters = {{"TargetJointPosition", target}, {"SpeedOverride", 0.05}}}));
    arm.awaitEvent(State::running);
    EXPECT_EQ(
        figures.page().value("metier_skill_state{skill=\"JointPtpMoveSkill\",state=\"Running\"}"),
        1);
    ASSERT_TRUE(arm->halt());
    arm.awaitEvent(State::halted);
    EXPECT_FALSE(arm->suspend());

    const auto page = figures.page();
    const std::string skill = "{skill=\"JointPtpMoveSkill\"";
    EXPECT_EQ(page.value("metier_skill_starts_total" + skill + "}"), 2);
    EXPECT_EQ(page.value("metier_skill_finished_total" + skill + "}"), 1);
    EXPECT_EQ(page.value("metier_skill_halts_total" + skill + ",reason=\"ByClient\"}"), 1);
    EXPECT_EQ(page.value("metier_skill_halts_total" + skill + ",reason=\"OwnerLost\"}"), 0);
    EXPECT_EQ(page.value("metier_skill_refusals_total" + skill + ",method=\"Suspend\"}"), 1);
    EXPECT_EQ(page.value("metier_skill_duration_seconds_count" + skill + "}"), 2);
    EXPECT_GT(page.value("metier_skill_duration_seconds_sum" + skill + "}"), 0);
    EXPECT_GE(page.value("metier_publish_latency_seconds_count"), 4);
    EXPECT_GE(page.value("metier_sessions"), 1);
    EXPECT_TRUE(page.has("metier_lease_losses_total"));
    EXPECT_TRUE(page.has("metier_queue_length{queue=\"server_thread\"}"));
    EXPECT_TRUE(page.has("metier_queue_length{queue=\"audit\"}"));
    EXPECT_TRUE(page.has("metier_queue_length{queue=\"records\"}"));
    EXPECT_EQ(page.value("metier_records_dropped_total{kind=\"execution\"}"), 0);
    EXPECT_GT(page.value("process_resident_memory_bytes"), 1e6);
    EXPECT_EQ(figures.awaitHealth(200), "ok\n");
}

TEST(MetricsOfAnArm, TellOfItsCyclesAndOfALostLease) {
    const Figures figures(ownAddress(1));
    const ServerProcess server("iiwa", {"--port", "0", "--metrics", figures.option()});
    const auto page = figures.page();
    std::size_t series = 0;
    for (const auto* name : {"metier_cycles_total", "metier_missed_cycles_total",
                             "metier_cycle_jitter_seconds_count"}) {
        series += page.has(std::string(name) + "{device=\"iiwa\"}") ? 1 : 0;
    }
    EXPECT_EQ(series, 3U);
    EXPECT_FALSE(page.has("metier_records_written_total")) << "nothing is recorded there";
    {
        const auto client = connectTo(server.url());
        const auto skill = openSkill(*client, "JointPtpMoveSkill");
        const auto controller = skill.address().controller()->node;
        const auto metier = client->namespaceIndex("urn:metier:skills");
        ASSERT_TRUE(metier);
        const auto acquire = client->translate(controller, {{*metier, "AcquireControl"}});
        ASSERT_TRUE(acquire);
        ASSERT_TRUE(client->call(
            controller, *acquire,
            {opcua::Value::of(std::uint32_t{100}), opcua::Value::of(std::int32_t{1})}));
    }
    figures.await("metier_lease_losses_total", 1);
}

}  // namespace
}  // namespace metier::system_tests
