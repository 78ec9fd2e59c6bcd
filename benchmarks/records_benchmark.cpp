// Finding executions among many: how long a page of 100 takes with each filter, beside the same
// page without indexes.
//
//   records_benchmark [EXECUTIONS [FOLDER-OR-URL]]
//
// 1,000,000 executions of 12 servers with 10 skills each, 8 users, every twentieth halted with a
// text that has a number in it, are recorded by a Recorder into a SQLite file (in FOLDER, else
// /tmp) or a PostgreSQL database, which stays; one that has as many already is used as it is. Then
// each filter is asked for 20 pages of 100, one after the other, each by the last number of the one
// before, with a connection of its own; the slowest and the median page are shown, and as
// "processor" the most processor time that one took, which a busy machine does not change. "scan"
// is one page of the same condition over the same rows with no index of executions allowed (SQLite
// alone).
#include <fmt/format.h>
#include <sqlite3.h>

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <ctime>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "metier/records/recorder.hpp"
#include "metier/records/store.hpp"

namespace {

using namespace metier;
using namespace std::chrono_literals;
using records::Filter;
using records::Store;
using Milliseconds = std::chrono::duration<double, std::milli>;

constexpr int kServers = 12;
constexpr int kSkills = 10;
constexpr int kUsers = 8;
constexpr int kPages = 20;
constexpr std::uint32_t kPageSize = 100;
constexpr auto kBegin = UtcTime(1'780'000'000s);

template <typename T>
T orExit(Result<T> result) {
    if (!result) {
        fmt::print(stderr, "records_benchmark: {}\n", result.error().message);
        std::exit(EXIT_FAILURE);  // NOLINT(concurrency-mt-unsafe): one thread by now
    }
    return std::move(*result);
}

double processorSeconds() {
    return static_cast<double>(std::clock()) / CLOCKS_PER_SEC;
}

records::ExecutionRow executionOf(std::int64_t i) {
    records::ExecutionRow e;
    e.id = fmt::format("{:08x}-{}", static_cast<std::uint32_t>(i * 2654435761U), i);
    e.server_name = fmt::format("robot{}", i % kServers);
    e.skill = fmt::format("Skill{}", i / kServers % kSkills);
    e.controller = "Controller";
    e.device = e.server_name;
    e.session = "ns=1;g=1";
    e.client_name = "metier command";
    e.user = fmt::format("user{}", i / 7 % kUsers);
    e.parameters = R"({"TargetJointPosition":[0.1,-1.2,1.5,-1.9,-1.5,0.0],"MaxVelocity":[1.0]})";
    e.started = kBegin + i * 2s;
    e.state = "Running";
    return e;
}

void recordOne(records::Recorder& recorder, std::int64_t i) {
    const auto execution = executionOf(i);
    const auto key = recorder.begin(execution);
    recorder.transition(key, {.time = execution.started, .from = "Ready", .to = "Running"});
    const bool halts = i % 20 == 0;
    const auto reason = halts ? fmt::format("axis {}: {:.4f} rad/s over limit 3.1 rad/s", i % 6,
                                            3.1 + static_cast<double>(i % 4'001) / 1e3)
                              : std::string();
    records::Outcome outcome;
    outcome.time = execution.started + 1s;
    outcome.state = halts ? "Halted" : "Ready";
    outcome.reason = halts ? "LimitViolated" : "Finished";
    outcome.reason_text = reason;
    recorder.transition(key, {.time = outcome.time,
                              .from = "Running",
                              .to = outcome.state,
                              .reason = outcome.reason,
                              .reason_text = reason});
    recorder.end(key, std::move(outcome));
}

void fill(const std::string& url, std::int64_t count) {
    std::vector<std::unique_ptr<records::Recorder>> recorders;
    for (int server = 0; server < kServers; ++server) {
        records::Recorder::Options options;
        options.url = url;
        options.server = fmt::format("urn:cell:metier:robot{}", server);
        options.keep = {.age = 0h, .bytes = 0};
        recorders.push_back(orExit(records::Recorder::create(std::move(options))));
    }
    const auto begin = std::chrono::steady_clock::now();
    const auto processor = processorSeconds();
    for (std::int64_t i = 0; i < count; ++i) {
        recordOne(*recorders[static_cast<std::size_t>(i % kServers)], i);
        if (i % 10'000 == 9'999 || i == count - 1) {
            for (auto& recorder : recorders) {
                recorder->flush(std::chrono::steady_clock::now() + 600s);
            }
        }
    }
    const std::chrono::duration<double> time = std::chrono::steady_clock::now() - begin;
    fmt::print("{} executions recorded in {:.0f} s: {:.0f}/s, {:.1f} us of a core each\n", count,
               time.count(), static_cast<double>(count) / time.count(),
               1e6 * (processorSeconds() - processor) / static_cast<double>(count));
}

struct Case {
    const char* name;
    Filter filter;
    std::string condition;  ///< condition of the scan
};

std::vector<Case> cases(std::int64_t count) {
    std::vector<Case> all;
    const auto add = [&](const char* name, auto set, std::string condition) {
        Filter filter;
        set(filter);
        all.push_back({name, std::move(filter), std::move(condition)});
    };
    const auto micros = [](UtcTime time) {
        return std::chrono::duration_cast<std::chrono::microseconds>(time.time_since_epoch())
            .count();
    };
    const auto middle = kBegin + count * 1s;
    add(
        "all", [](Filter&) {}, "TRUE");
    add(
        "server", [](Filter& f) { f.server = "robot3"; }, "k.server_name = 'robot3'");
    add(
        "server, skill, user, Halted",
        [](Filter& f) {
            f.server = "robot4";
            f.skill = "Skill5";
            f.user = "user6";
            f.state = "Halted";
        },
        "k.server_name = 'robot4' AND k.skill = 'Skill5' AND k.user_name = 'user6' AND "
        "k.state = 'Halted'");
    add(
        "server and skill that exclude each other",
        [](Filter& f) {
            f.server = "robot1";
            f.skill = "SkillX";
        },
        "k.server_name = 'robot1' AND k.skill = 'SkillX'");
    add(
        "a day in the middle",
        [&](Filter& f) {
            f.from = middle;
            f.until = middle + 24h;
        },
        fmt::format("e.started >= {} AND e.started < {}", micros(middle), micros(middle + 24h)));
    add(
        "Halted, first half",
        [&](Filter& f) {
            f.state = "Halted";
            f.until = middle;
        },
        fmt::format("k.state = 'Halted' AND e.started < {}", micros(middle)));
    add(
        "text of many reasons", [](Filter& f) { f.text = "over limit"; },
        "lower(n.reason_text) LIKE '%over limit%'");
    add(
        "text of few reasons, one user",
        [](Filter& f) {
            f.text = "axis 2: 4.15";
            f.user = "user2";
        },
        "lower(n.reason_text) LIKE '%axis 2: 4.15%' AND k.user_name = 'user2'");
    add(
        "text that is nowhere", [](Filter& f) { f.text = "gripper"; },
        "lower(n.reason_text) LIKE '%gripper%'");
    const auto id = executionOf(count / 3).id;
    add(
        "an id", [&](Filter& f) { f.text = id; }, fmt::format("e.id = '{}'", id));
    add(
        "children of nobody", [](Filter& f) { f.parent = "none"; }, "e.parent = 'none'");
    return all;
}

/// Processor time of this thread [ms].
double processorTime() {
    timespec time{};
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
    return 1e3 * static_cast<double>(time.tv_sec) + static_cast<double>(time.tv_nsec) / 1e6;
}

/// Times of one page after the other [ms], and the number of their executions.
struct Measured {
    std::vector<double> pages;
    double most_processor_time = 0;
    std::size_t executions = 0;
};

Measured measure(const std::string& url, const Filter& filter) {
    Measured measured;
    const auto store = orExit(Store::open(url));
    std::int64_t before = 0;
    for (int page = 0; page < kPages; ++page) {
        const auto begin = std::chrono::steady_clock::now();
        const auto processor = processorTime();
        const auto listing = orExit(store->list(filter, {.before = before, .count = kPageSize}));
        measured.most_processor_time =
            std::max(measured.most_processor_time, processorTime() - processor);
        measured.pages.push_back(Milliseconds(std::chrono::steady_clock::now() - begin).count());
        measured.executions += listing.executions.size();
        if (!listing.more) {
            break;
        }
        before = listing.executions.back().number;
    }
    std::sort(measured.pages.begin(), measured.pages.end());
    return measured;
}

/// A page without indexes of executions [ms]; 0: no SQLite file.
double scan(const std::string& file, const std::string& condition) {
    sqlite3* connection = nullptr;
    if (file.find("://") != std::string::npos ||
        sqlite3_open_v2(file.c_str(), &connection, SQLITE_OPEN_READONLY, nullptr) != SQLITE_OK) {
        return 0;
    }
    const auto sql = fmt::format(
        "SELECT e.*, k.*, n.* FROM executions e NOT INDEXED CROSS JOIN kinds k ON k.kind = e.kind "
        "CROSS JOIN notes n ON n.note = e.note WHERE {} ORDER BY e.started DESC LIMIT {}",
        condition, kPageSize);
    const auto begin = std::chrono::steady_clock::now();
    const int done = sqlite3_exec(connection, sql.c_str(), nullptr, nullptr, nullptr);
    const double time = Milliseconds(std::chrono::steady_clock::now() - begin).count();
    sqlite3_close_v2(connection);
    return done == SQLITE_OK ? time : 0;
}

std::int64_t recorded(const std::string& url) {
    const auto store = Store::open(url);
    return store ? (*store)->latestRevision().value_or(0) : 0;
}

}  // namespace

int main(int argc, char** argv) {
    const std::int64_t count = argc > 1 ? std::atoll(argv[1]) : 1'000'000;
    const std::string place = argc > 2 ? argv[2] : "/tmp";
    const auto url = place.find("://") != std::string::npos
                         ? place
                         : fmt::format("{}/metier_records_{}.db", place, count);
    if (recorded(url) < count) {
        fill(url, count);
    }
    fmt::print("{}: {:.0f} MB\n", url,
               static_cast<double>(orExit(orExit(Store::open(url))->bytes())) / 1e6);
    fmt::print("{:<42} {:>6} {:>10} {:>10} {:>10} {:>10}\n", "page of 100, filter", "found",
               "median", "slowest", "processor", "scan");
    for (const auto& one : cases(count)) {
        const auto measured = measure(url, one.filter);
        fmt::print("{:<42} {:>6} {:>7.2f} ms {:>7.2f} ms {:>7.2f} ms {:>7.0f} ms\n", one.name,
                   measured.executions, measured.pages[measured.pages.size() / 2],
                   measured.pages.back(), measured.most_processor_time, scan(url, one.condition));
    }
    return EXIT_SUCCESS;
}
