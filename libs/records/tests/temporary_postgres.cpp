#include "temporary_postgres.hpp"

#include <unistd.h>

#include <chrono>
#include <csignal>
#include <cstdlib>
#include <iostream>
#include <stdexcept>
#include <vector>

/// libpqxx 6.4 loses 2 kB whenever a connection breaks while a statement is prepared.
extern "C" const char* __lsan_default_suppressions();   // NOLINT(*-reserved-identifier,*-dcl51-cpp)
extern "C" const char* __lsan_default_suppressions() {  // NOLINT(*-reserved-identifier,*-dcl51-cpp)
    return "leak:pqxx::connection_base::register_prepared";
}

namespace metier::records {
namespace {

namespace fs = std::filesystem;
using namespace std::chrono_literals;

constexpr uid_t kNobody = 65534;

SteadyTime soon() {
    return std::chrono::steady_clock::now() + 60s;
}

/// Folder in which Debian has the programs of the newest version; empty: there are none.
fs::path installedPrograms() {
    fs::path newest;
    std::error_code none;
    for (const auto& version : fs::directory_iterator("/usr/lib/postgresql", none)) {
        if (fs::exists(version.path() / "bin" / "initdb")) {
            newest = std::max(newest, version.path() / "bin");
        }
    }
    return newest;
}

fs::path makeFolder() {
    std::string folder = "/tmp/metier_postgres_XXXXXX";
    if (::mkdtemp(folder.data()) == nullptr ||
        (::getuid() == 0 && ::chown(folder.c_str(), kNobody, kNobody) != 0)) {
        throw std::runtime_error("no folder for PostgreSQL in /tmp");
    }
    return folder;
}

/// PostgreSQL refuses to run as root.
std::vector<std::string> unprivileged(const std::vector<std::string>& command) {
    std::vector<std::string> all;
    if (::getuid() == 0) {
        const auto id = std::to_string(kNobody);
        all = {"setpriv", "--reuid=" + id, "--regid=" + id, "--clear-groups", "--pdeathsig=KILL"};
    }
    all.insert(all.end(), command.begin(), command.end());
    return all;
}

}  // namespace

TemporaryPostgres* TemporaryPostgres::instance() {
    static const auto kInstance = []() -> std::unique_ptr<TemporaryPostgres> {
        const auto programs = installedPrograms();
        if (programs.empty()) {
            std::cerr << "NOT TESTED: PostgreSQL is not installed (apt install postgresql)\n";
            return nullptr;
        }
        return std::unique_ptr<TemporaryPostgres>(new TemporaryPostgres(programs));
    }();
    return kInstance.get();
}

TemporaryPostgres::TemporaryPostgres(fs::path programs)
    : programs_(std::move(programs)), folder_(makeFolder()) {
    run({programs_ / "initdb", "-D", folder_ / "data", "-U", "metier", "-A", "trust", "-E", "UTF8",
         "--no-locale", "--no-sync"});
    start();
}

TemporaryPostgres::~TemporaryPostgres() {
    if (server_ != nullptr) {
        server_->signal(SIGINT);
        server_->waitUntil(soon());
    }
    std::error_code ignored;
    fs::remove_all(folder_, ignored);
}

void TemporaryPostgres::run(const std::vector<std::string>& command) const {
    auto child = link::ChildProcess::start(unprivileged(command), link::ErrorOutput::with_output);
    std::string output;
    while (child) {
        const auto line = child->readLine(soon());
        if (!line) {
            break;
        }
        output += *line + '\n';
    }
    if (!child || child->waitUntil(soon()) != 0) {
        throw std::runtime_error(command.front() + " failed: " + output);
    }
}

void TemporaryPostgres::start() {
    auto server =
        link::ChildProcess::start(unprivileged({programs_ / "postgres", "-D", folder_ / "data",
                                                "-k", folder_, "-c", "listen_addresses=", "-F"}),
                                  link::ErrorOutput::with_output);
    std::string output;
    while (server) {
        const auto line = server->readLine(soon());
        if (!line) {
            break;
        }
        output += *line + '\n';
        if (line->find("ready to accept connections") != std::string::npos) {
            server_ = std::make_unique<link::ChildProcess>(std::move(*server));
            return;
        }
    }
    throw std::runtime_error("postgres does not start: " + output);
}

void TemporaryPostgres::kill() {
    server_->signal(SIGQUIT);  // no shutdown: data that was not committed is lost
    server_->waitUntil(soon());
    server_.reset();
}

std::string TemporaryPostgres::freshDatabase() {
    const auto name = "test" + std::to_string(++databases_);
    run({programs_ / "createdb", "-h", folder_, "-U", "metier", name});
    return "postgresql://metier@/" + name + "?host=" + folder_.string();
}

}  // namespace metier::records
